// The strip of what has been seen: a picture and the settings that made it. A click brings the settings back.
import {byId, make, pngOf, scratch} from './dom.js';
import {labelOf} from './keys.js';
import {dropPicture, keepPicture, keptPictures} from './memory.js';
import {settingsOf} from './store.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Changes} Changes */
/** @typedef {{id: number, signature: string, settings: Changes, label: string, item: HTMLLIElement,
 *   picture: Promise<Blob>, width: number, height: number}} Entry */

const kMost = 30;
const kThumbHeight = 152;
const kRestMs = 250;

/**
 * What tells a look from others, in a few words.
 * @param {State} state
 */
export function describe(state) {
  const keys = Object.entries(state.keys).map(([name, value]) => `${labelOf(name).toLowerCase()} ${value}`);
  const words = [state.style, ...keys.slice(0, 2)];
  if (keys.length > 2) words.push(`${keys.length - 2} more keys`);
  if (state.budget_ms) words.push(`${state.budget_ms} ms`);
  else if (state.quality !== 'final') words.push(state.quality);
  for (const {name, style} of state.assignments.slice(0, 1)) words.push(`${name} in ${style}`);
  if (state.seed) words.push(`seed ${state.seed}`);
  return words.join(' · ');
}

export class History {
  /** @param {import('./store.js').Store} store */
  constructor(store) {
    this.store = store;
    this.list = byId('history', HTMLElement);
    /** @type {Entry[]} */
    this.entries = [];
    this.next = 1;
    this.timer = 0;
    this.filesChanged = false;
    /** @type {(side: 'a' | 'b', entry: Entry) => void} */
    this.onMark = () => {};
    /** @type {() => void} */
    this.onChange = () => {};
    this.list.addEventListener('wheel', (event) => {
      if (!event.deltaX) this.list.scrollLeft += event.deltaY;
    }, {passive: true});
  }

  /**
   * A final is on the screen. It is kept once it has stayed there for a moment.
   * @param {HTMLCanvasElement} canvas
   * @param {State} state what it shows
   */
  see(canvas, state) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.keep(canvas, state), kRestMs);
  }

  /** Something moves: what is on the screen is a draft. */
  leave() { clearTimeout(this.timer); }

  /** @param {HTMLCanvasElement} canvas @param {State} state */
  keep(canvas, state) {
    const settings = settingsOf(state), signature = JSON.stringify(settings);
    const same = this.entries.find((entry) => entry.signature === signature);
    if (same && !this.filesChanged) {
      this.markNow(same);
      return;
    }
    this.filesChanged = false;
    const copy = scratch(canvas.width, canvas.height);
    copy.to.drawImage(canvas, 0, 0);
    const picture = pngOf(copy.canvas), seen = {id: this.next++, settings, signature, label: describe(state)};
    this.markNow(this.add({...seen, picture}, canvas));
    void picture.then((blob) => keepPicture({...seen, picture: blob}));
    this.onChange();
  }

  /** What this tab had seen before it was loaded anew. */
  async remember() {
    for (const seen of await keptPictures()) {
      const bitmap = await createImageBitmap(seen.picture);
      this.add({...seen, picture: Promise.resolve(seen.picture)}, bitmap);
      this.next = Math.max(this.next, seen.id + 1);
      bitmap.close();
    }
    this.onChange();
  }

  /**
   * At the end of the strip.
   * @param {{id: number, settings: Changes, signature: string, label: string, picture: Promise<Blob>}} seen
   * @param {HTMLCanvasElement | ImageBitmap} canvas
   */
  add({id, settings, signature, label, picture}, canvas) {
    const item = make('li', {className: 'seen'});
    item.dataset.seen = String(id);
    const thumb = make(
        'canvas', {height: kThumbHeight, width: Math.max(1, Math.round(kThumbHeight * canvas.width / canvas.height))});
    const to = thumb.getContext('2d');
    if (to) {
      to.imageSmoothingQuality = 'high';
      to.fillStyle = '#fff';
      to.fillRect(0, 0, thumb.width, thumb.height);
      to.drawImage(canvas, 0, 0, thumb.width, thumb.height);
    }
    /** @type {Entry} */
    const entry =
        {id, signature, settings, label, item, picture, width: canvas.width, height: canvas.height};
    const restore = make('button', {type: 'button', className: 'restore', title: `${label}: click to come back to it`,
                                    'aria-label': `Come back to ${id}: ${label}`}, thumb);
    restore.addEventListener('click', () => void this.store.restore(entry.settings));
    const marks = make('span', {className: 'marks'});
    for (const side of /** @type {const} */ (['a', 'b'])) {
      const button = make('button', {type: 'button', textContent: side.toUpperCase(), 'aria-pressed': 'false',
                                     'aria-label': `Compare ${id} as ${side.toUpperCase()}`,
                                     title: `Compare this as ${side.toUpperCase()}`});
      button.dataset.side = side;
      button.addEventListener('click', () => this.onMark(side, entry));
      marks.append(button);
    }
    item.append(restore, marks);
    this.entries.push(entry);
    this.list.append(item);
    const old = this.entries.length > kMost ? this.entries.shift() : undefined;
    old?.item.remove();
    if (old) void dropPicture(old.id);
    return entry;
  }

  /** @param {Entry} now */
  markNow(now) {
    for (const entry of this.entries) {
      entry.item.classList.toggle('now', entry === now);
      entry.item.firstElementChild?.setAttribute('aria-current', String(entry === now));
    }
    // Not scrollIntoView: it may scroll the page too.
    const {offsetLeft, offsetWidth} = now.item, from = this.list.scrollLeft + this.list.offsetLeft;
    if (offsetLeft < from || offsetLeft + offsetWidth > from + this.list.clientWidth) {
      this.list.scrollLeft = offsetLeft - this.list.offsetLeft - this.list.clientWidth + offsetWidth + 8;
    }
  }

  /** @param {number} id */
  find(id) { return this.entries.find((entry) => entry.id === id); }

  /**
   * Shows which entries are A and B.
   * @param {number | null} a
   * @param {number | null} b
   */
  showMarks(a, b) {
    for (const {id, item} of this.entries) {
      for (const button of item.querySelectorAll('button[data-side]')) {
        const side = /** @type {HTMLElement} */ (button).dataset.side;
        button.setAttribute('aria-pressed', String(id === (side === 'a' ? a : b)));
      }
    }
  }
}
