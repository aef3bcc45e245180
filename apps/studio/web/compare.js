// A and B: by wipe, flip, difference, or side by side. A is the picture of now or one that was seen; B is one that was
// seen, or the picture of now in another style or quality.
import {CallError, isAbort} from './api.js';
import {byId, clamp, make} from './dom.js';
import {draw, frameBeside} from './frame.js';

/** @typedef {'off' | 'wipe' | 'side' | 'difference'} Mode */
/** @typedef {import('./api.js').Changes} Changes */

const kQualities = ['final', 'preview', 'draft'];
const kBudgets = [20, 50, 100];
const kAgainMs = 200;

/** @typedef {{drawn: string, painting: string, failed: string, abort: AbortController}} Side
 *   names of pictures, as "seen:3": on its canvas, on its way, and could not be painted */

/** @returns {Side} */
const newSide = () => ({drawn: '', painting: '', failed: '', abort: new AbortController()});

export class Compare {
  /**
   * @param {import('./store.js').Store} store @param {import('./view.js').View} view
   * @param {import('./history.js').History} history @param {(error: unknown) => void} onError
   */
  constructor(store, view, history, onError) {
    this.store = store;
    this.view = view;
    this.history = history;
    this.onError = onError;
    /** @type {Mode} */
    this.mode = 'off';
    /** @type {number | null} the id of a seen picture; null: now */
    this.a = null;
    this.b = '';  // "seen:3", "style:ink", "quality:draft", "budget:50"; '': chosenB says
    this.sideA = newSide();
    this.sideB = newSide();
    this.at = 50;
    this.flipped = false;
    this.show = 'picture';
    this.canvasA = byId('picture-a', HTMLCanvasElement);
    this.canvasB = byId('picture-b', HTMLCanvasElement);
    this.wipe = byId('wipe', HTMLElement);
    this.select = byId('compare', HTMLSelectElement);
    this.beside = byId('beside', HTMLSelectElement);
    /** @type {() => void} */
    this.onChange = () => {};
    for (const [value, text] of [
             ['off', 'No comparison'], ['wipe', 'Wipe'], ['side', 'Side by side'], ['difference', 'Difference']]) {
      this.select.append(make('option', {value, textContent: text}));
    }
    this.select.addEventListener('change', () => this.setMode(/** @type {Mode} */ (this.select.value)));
    this.beside.addEventListener('change', () => this.setB(this.beside.value));
    history.onMark = (side, entry) => this.mark(side, entry.id);
    history.onChange = () => this.offer();
    view.listeners.push(() => this.placeWipe());
    this.wipe.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      this.wipe.focus({preventScroll: true});
      this.wipe.setPointerCapture(event.pointerId);
    });
    this.wipe.addEventListener('pointermove', (event) => {
      if (this.wipe.hasPointerCapture(event.pointerId))
        this.setWipe(view.placeAt(event.clientX, event.clientY).x / view.width * 100);
    });
    this.wipe.addEventListener('keydown', (event) => this.key(event));
    store.listen(() => this.offer());
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const step = event.shiftKey ? 10 : 1;
    const to = {ArrowLeft: this.at - step, ArrowDown: this.at - step, ArrowRight: this.at + step,
                ArrowUp: this.at + step, PageDown: this.at - 10, PageUp: this.at + 10, Home: 0, End: 100}[event.key];
    if (to === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    this.setWipe(to);
  }

  /** @param {number} percent of the picture's width that is A */
  setWipe(percent) {
    this.at = clamp(percent, 0, 100);
    this.placeWipe();
    this.onChange();
  }

  /** @param {Mode} mode */
  setMode(mode) {
    this.mode = mode;
    this.sideA.failed = this.sideB.failed = '';
    this.apply();
    this.refresh();
    this.onChange();
  }

  /** @param {Mode} mode the same again ends it */
  toggle(mode) { this.setMode(this.mode === mode ? 'off' : mode); }

  /** @param {string} b */
  setB(b) {
    this.b = b;
    this.apply();
    this.refresh();
    this.onChange();
  }

  /** @param {'a' | 'b'} side @param {number} id */
  mark(side, id) {
    if (side === 'a') this.a = this.a === id ? null : id;
    else this.b = this.b === `seen:${id}` ? '' : `seen:${id}`;
    if (this.mode === 'off') this.mode = 'wipe';
    this.apply();
    this.refresh();
    this.onChange();
  }

  /** The B that is meant: the choice, or what was seen before the picture of now, or its draft. */
  get chosenB() {
    if (this.b) return this.b;
    const others = this.history.entries.filter((entry) => !entry.item.classList.contains('now') && entry.id !== this.a);
    const last = others[others.length - 1];
    return last ? `seen:${last.id}` : 'quality:draft';
  }

  /** Fills the list of what B may be. */
  offer() {
    if (!this.store.known) return;
    /** @type {[string, [string, string][]][]} */
    const groups = [
      ['Seen', this.history.entries.map((entry) => [`seen:${entry.id}`, `${entry.id}: ${entry.name}`])],
      ['Now, in another style', this.store.state.styles.map(({id, name}) => [`style:${id}`, name])],
      ['Now, in another quality', kQualities.map((name) => [`quality:${name}`, name])],
      ['Now, within a budget', kBudgets.map((ms) => [`budget:${ms}`, `${ms} ms`])],
    ];
    const signature = JSON.stringify(groups);
    if (this.beside.dataset.options !== signature) {
      this.beside.replaceChildren(...groups.filter(([, list]) => list.length).map(([label, list]) =>
          make('optgroup', {label}, ...list.map(([value, text]) => make('option', {value, textContent: text})))));
      this.beside.dataset.options = signature;
    }
    if (this.b.startsWith('seen:') && !this.history.find(Number(this.b.slice(5)))) this.b = '';
    if (this.a !== null && !this.history.find(this.a)) this.a = null;
    this.apply();
    this.refresh();  // B may be another one now
  }

  /**
   * A new final is on the screen: a B of now is old.
   * @param {string} show
   */
  now(show) {
    this.show = show;
    this.sideA.failed = this.sideB.failed = '';
    if (!this.chosenB.startsWith('seen:')) {
      this.sideB.abort.abort();
      this.sideB = newSide();
    }
    this.refresh();
  }

  get isOn() { return this.mode !== 'off' || this.flipped; }

  /** Whether the server paints for it. */
  get isPainting() { return this.sideA.painting !== '' || this.sideB.painting !== ''; }

  /** Fetches and draws what is not there yet: A, then B. */
  async refresh() {
    if (!this.isOn) return;
    await this.bring(this.sideA, this.canvasA, this.a === null ? '' : `seen:${this.a}`);
    // Two at a time would cancel each other at the server; who waits for A comes here again.
    if (!this.sideA.painting) await this.bring(this.sideB, this.canvasB, this.chosenB);
  }

  /** @param {Side} side @param {HTMLCanvasElement} canvas @param {string} what '': nothing */
  async bring(side, canvas, what) {
    if (side.painting === what && what) return;
    side.abort.abort();
    side.painting = '';
    if (!what || side.drawn === what || side.failed === what) return;
    const {signal} = side.abort = new AbortController();
    side.painting = what;
    try {
      const source = await this.pictureOf(what, signal);
      if (signal.aborted) return;
      if (source) draw(canvas, source);
      side.drawn = what;
      this.apply();
    } catch (error) {
      if (signal.aborted || isAbort(error)) return;
      if (error instanceof CallError && error.status === 409) {
        setTimeout(() => this.refresh(), kAgainMs);
      } else {
        side.failed = what;
        this.onError(error);
      }
    } finally {
      if (!signal.aborted) side.painting = '';
    }
  }

  /** @param {string} what @param {AbortSignal} signal */
  async pictureOf(what, signal) {
    if (!what.startsWith('seen:')) return (await frameBeside(this.changesOf(what), this.show, signal)).source;
    const entry = this.history.find(Number(what.slice(5)));
    return entry ? createImageBitmap(await entry.picture(signal)) : null;
  }

  /** @param {string} b @returns {Changes} */
  changesOf(b) {
    const [kind, value] = b.split(/:(.*)/);
    if (kind === 'style') return {style: value};
    return kind === 'quality' ? {quality: value} : {budget_ms: Number(value)};
  }

  /** Shows what the mode says. */
  apply() {
    const {mode, view} = this, b = this.chosenB, hasB = this.isOn && b !== '' && this.sideB.drawn === b;
    const isSide = mode === 'side' && !this.flipped;
    this.select.value = mode;
    byId('beside-choice', HTMLElement).hidden = mode === 'off';
    if (b && this.beside.value !== b) this.beside.value = b;
    this.canvasA.hidden = this.a === null || this.sideA.drawn !== `seen:${this.a}` || !this.isOn;
    const sheet = view.sheets[isSide ? 1 : 0];
    if (this.canvasB.parentElement !== sheet) sheet.insertBefore(this.canvasB, isSide ? null : view.overlay);
    this.canvasB.hidden = !hasB;
    const isDifference = mode === 'difference' && hasB && !this.flipped;
    this.canvasB.dataset.mode = isDifference ? 'difference' : mode;
    view.sheets[0].dataset.mode = isDifference ? 'difference' : '';
    const changesPanes = view.panes[1].hidden === isSide;
    view.panes[1].hidden = !isSide;
    document.documentElement.dataset.compare = this.flipped ? 'flip' : mode;
    this.tags(hasB, b, isSide);
    this.history.showMarks(
        mode === 'off' ? null : this.a, mode !== 'off' && b.startsWith('seen:') ? Number(b.slice(5)) : null);
    if (changesPanes) view.layout();
    this.placeWipe();
  }

  /** @param {boolean} hasB @param {string} b @param {boolean} isSide */
  tags(hasB, b, isSide) {
    const a = this.a === null ? 'A · now' : `A · ${this.a}: ${this.history.find(this.a)?.name}`;
    const seen = b.startsWith('seen:') ? this.history.find(Number(b.slice(5))) : null;
    const nameB = `B · ${seen ? `${seen.id}: ${seen.name}` : `now, ${b.replace(':', ' ')}`}`;
    const tagA = byId('tag-a', HTMLElement), tagB = byId('tag-b', HTMLElement);
    tagA.hidden = !this.isOn || this.flipped;
    tagB.hidden = !hasB || isSide;
    tagA.textContent = a;
    tagB.textContent = nameB;
    const tagSide = this.view.panes[1].querySelector('.tag');
    if (tagSide) tagSide.textContent = hasB ? nameB : 'B …';
  }

  placeWipe() {
    const isWipe = this.mode === 'wipe' && !this.flipped && !this.canvasB.hidden;
    this.wipe.hidden = !isWipe;
    this.canvasB.style.clipPath = isWipe ? `inset(0 0 0 ${this.at}%)` : '';
    if (!isWipe) return;
    const pane = this.view.panes[0].getBoundingClientRect(), sheet = this.view.sheets[0].getBoundingClientRect();
    this.wipe.style.left = `${clamp(sheet.left - pane.left + sheet.width * this.at / 100, 0, pane.width)}px`;
    this.wipe.setAttribute('aria-valuenow', String(Math.round(this.at)));
    this.wipe.setAttribute('aria-valuetext', `${Math.round(this.at)} % A`);
  }

  /**
   * While the key is held, B is shown instead of A.
   * @param {boolean} flipped
   */
  flip(flipped) {
    if (this.flipped === flipped) return;
    this.flipped = flipped;
    this.apply();
    void this.refresh();
  }

  /** For the address. */
  kept() {
    return this.mode === 'off' ?
        undefined :
        {mode: this.mode, b: this.b, at: Math.round(this.at)};
  }

  /** @param {{mode?: Mode, b?: string, at?: number} | undefined} kept */
  restore(kept) {
    if (!kept?.mode) return;
    this.b = kept.b ?? '';
    this.at = kept.at ?? 50;
    this.setMode(kept.mode);
  }
}
