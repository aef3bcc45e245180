// The exemplar beside the picture: which one, where a pixel's paint comes from, and what a place of it feeds.
import {call, getJson, isAbort, withQuery} from './api.js';
import {byId, clamp, context, fillSelect, make} from './dom.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Exemplar} Exemplar */

export class ExemplarPanel {
  /** @param {import('./store.js').Store} store @param {(error: unknown) => void} onError */
  constructor(store, onError) {
    this.store = store;
    this.onError = onError;
    this.box = byId('exemplar', HTMLElement);
    this.base = byId('exemplar-base', HTMLCanvasElement);
    this.marks = byId('exemplar-marks', HTMLCanvasElement);
    this.select = byId('exemplar-select', HTMLSelectElement);
    this.chosen = '0/0';  // style index / exemplar index
    this.shown = '';
    this.checked = '';
    this.pictured = Promise.resolve();  // once the picture of the chosen one is there
    this.locked = false;  // while it is painted on, hovering the picture shows no other
    /** @type {(place: {style: number, exemplar: number, x: number, y: number} | null) => void} */
    this.onPlace = () => {};
    /** @type {() => void} */
    this.onShown = () => {};
    this.cross = [0.5, 0.5];
    this.select.addEventListener('change', () => this.choose(this.select.value));
    this.box.addEventListener('pointermove', (event) => this.hover(event));
    this.box.addEventListener('pointerleave', () => this.onPlace(null));
    this.box.addEventListener('keydown', (event) => this.key(event));
    this.box.addEventListener('blur', () => this.clearMark());
    store.listen((state) => this.update(state));
  }

  /** @returns {Exemplar | undefined} */
  get current() {
    return this.store.state.exemplars.find((exemplar) => `${exemplar.style}/${exemplar.index}` === this.chosen);
  }

  /** @param {string} chosen */
  choose(chosen) {
    if (this.chosen === chosen) return;
    this.chosen = chosen;
    this.update(this.store.state);
  }

  /** @param {State} state */
  update(state) {
    const isMixed = state.exemplars.some((exemplar) => exemplar.style !== 0);
    const options = state.exemplars.map((exemplar) => ({
      value: `${exemplar.style}/${exemplar.index}`,
      text: (isMixed ? `${exemplar.style_id} · ` : '') + exemplar.file +
          (exemplar.luminance === null ? '' : ` · ${exemplar.luminance}`),
    }));
    if (!options.some((option) => option.value === this.chosen)) this.chosen = options[0]?.value ?? '0/0';
    fillSelect(this.select, options, this.chosen);
    byId('exemplar-choice', HTMLElement).hidden = options.length < 2;
    const now = this.current;
    this.box.hidden = !now;
    const isRead = Object.keys(state.file_keys).length > 0;
    byId('exemplar-none', HTMLElement).hidden = !!now;
    byId('exemplar-none', HTMLElement).textContent =
        isRead ? 'This style has no painting.' : 'This style cannot be read.';
    byId('paint', HTMLButtonElement).disabled = !now;
    const key = now ? `${now.style_id} ${now.file} ${this.chosen}` : '';
    if (key !== this.shown) {
      this.shown = key;
      this.pictured = this.load();
    }
  }

  /** Reads the picture and what the check says of it. The browser asks whether they changed. */
  async load() {
    const exemplar = this.current, here = this.shown;
    if (!exemplar) {
      byId('warnings', HTMLElement).hidden = true;
      this.onShown();
      return;
    }
    const query = {style: exemplar.style, exemplar: exemplar.index};
    try {
      const response = await call('GET', withQuery('/api/exemplar', query));
      const bitmap = await createImageBitmap(await response.blob());
      if (this.current?.file !== exemplar.file || this.current.style_id !== exemplar.style_id) return;
      this.base.width = this.marks.width = bitmap.width;
      this.base.height = this.marks.height = bitmap.height;
      context(this.base).drawImage(bitmap, 0, 0);
      this.box.style.aspectRatio = `${bitmap.width} / ${bitmap.height}`;
      this.onShown();
    } catch (error) {
      if (here === this.shown) this.base.width = this.marks.width = this.base.height = this.marks.height = 1;
      if (!isAbort(error)) this.onError(error);
    }
    void this.check(exemplar.style, here);
  }

  /**
   * @param {number} style
   * @param {string} here what is shown when it is asked for
   */
  async check(style, here) {
    const list = byId('warnings', HTMLElement);
    try {
      /** @type {{warnings: {image: string, what: string, fix: string}[]}} */
      const {warnings} = await getJson('/api/check', {style});
      if (here !== this.shown) return;
      const isOneOfMany = this.store.state.exemplars.filter((exemplar) => exemplar.style === style).length > 1;
      list.replaceChildren(...warnings.map(({image, what, fix}) => make(
          'li', {}, isOneOfMany ? `${image}: ${what}` : what, make('span', {textContent: fix}))));
      list.hidden = warnings.length === 0;
    } catch {
      list.hidden = true;  // a style that cannot be read has its sentence in the banner
    }
  }

  /** Files changed on the disk. */
  renew() { return this.load(); }

  /**
   * Marks a source.
   * @param {number} style
   * @param {number} exemplar
   * @param {[number, number]} source
   * @param {AbortSignal} signal
   */
  async mark(style, exemplar, source, signal) {
    const chosen = `${style}/${exemplar}`;
    if (chosen !== this.chosen) {
      if (this.locked) return;
      this.choose(chosen);
      await this.pictured;
      if (signal.aborted) return;
    }
    if (chosen !== this.chosen) {  // it is not listed yet, or another one has come
      this.clearRing();
      return;
    }
    this.drawMark(source[0] + 0.5, source[1] + 0.5);
  }

  /**
   * A ring with a cross, of a constant size on the screen.
   * @param {number} x
   * @param {number} y
   */
  drawMark(x, y) {
    const canvas = this.marks, to = context(canvas);
    to.clearRect(0, 0, canvas.width, canvas.height);
    const unit = canvas.width / Math.max(1, this.box.clientWidth);
    for (const [colour, width] of /** @type {const} */ ([['rgb(0 0 0 / 75%)', 4], ['#ffb13d', 1.8]])) {
      to.strokeStyle = colour;
      to.lineWidth = width * unit;
      to.beginPath();
      to.arc(x, y, 8 * unit, 0, 7);
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        to.moveTo(x + dx * 11 * unit, y + dy * 11 * unit);
        to.lineTo(x + dx * 18 * unit, y + dy * 18 * unit);
      }
      to.stroke();
    }
  }

  clearRing() { context(this.marks).clearRect(0, 0, this.marks.width, this.marks.height); }

  clearMark() {
    this.clearRing();
    this.onPlace(null);
  }

  /**
   * A place of the exemplar under the pointer.
   * @param {PointerEvent | MouseEvent} event
   */
  placeAt(event) {
    const box = this.box.getBoundingClientRect();
    return {x: (event.clientX - box.left) / box.width * this.base.width,
            y: (event.clientY - box.top) / box.height * this.base.height};
  }

  /** @param {PointerEvent} event */
  hover(event) {
    if (this.locked || event.buttons) return;
    this.clearRing();
    const {x, y} = this.placeAt(event);
    this.tell(x, y);
  }

  /** @param {number} x @param {number} y */
  tell(x, y) {
    const exemplar = this.current;
    if (!exemplar) return;
    this.onPlace({style: exemplar.style, exemplar: exemplar.index, x: clamp(Math.floor(x), 0, this.base.width - 1),
                  y: clamp(Math.floor(y), 0, this.base.height - 1)});
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
    const step = /** @type {Record<string, number[]>} */ (steps)[event.key];
    if (!step || this.locked) return;
    event.preventDefault();
    this.cross = this.cross.map((at, axis) => clamp(at + step[axis] * (event.shiftKey ? 0.05 : 0.01), 0, 1));
    const x = this.cross[0] * this.base.width, y = this.cross[1] * this.base.height;
    this.drawMark(x, y);
    this.tell(x, y);
  }
}
