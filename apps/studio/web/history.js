// The strip of what has been seen: a picture and the settings that made it. A click brings the settings back.
import {call} from './api.js';
import {byId, context, make, pngOf, scratch} from './dom.js';
import {labelOf} from './keys.js';
import {keepSeen, keptSeen} from './memory.js';
import {settingsOf} from './store.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Changes} Changes */
/** @typedef {import('./memory.js').SeenPicture & {item: HTMLLIElement, name: string,
 *   mayBeOld: boolean, picture: (signal: AbortSignal) => Promise<Blob>}} Entry
 *   name: the label, as the page shows it; mayBeOld: files have changed since it was on the screen */

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
  if (state.finish) words.push(state.finish.name);
  if (state.budget_ms) words.push(`${state.budget_ms} ms`);
  else if (state.quality !== 'final') words.push(state.quality);
  for (const {name, style} of state.assignments.slice(0, 1)) words.push(`${name} in ${style}`);
  if (state.seed) words.push(`seed ${state.seed}`);
  return words.join(' · ');
}

/**
 * A number that changes with the pixels.
 * @param {CanvasRenderingContext2D} from
 */
function hashOf(from) {
  const {width, height} = from.canvas;
  let hash = width;
  for (const pixel of new Int32Array(from.getImageData(0, 0, width, height).data.buffer)) {
    hash = Math.imul(hash ^ pixel, 0x01000193);
    hash ^= hash >>> 15;
  }
  return hash;
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

  /** The same settings may be another picture now. */
  filesChanged() {
    for (const entry of this.entries) entry.mayBeOld = true;
  }

  /** Something moves: what is on the screen is a draft. */
  leave() { clearTimeout(this.timer); }

  /** @param {HTMLCanvasElement} canvas @param {State} state */
  keep(canvas, state) {
    const settings = settingsOf(state), signature = JSON.stringify(settings);
    const same = [...this.entries].reverse().find((entry) => entry.signature === signature);
    if (same && !same.mayBeOld) {
      this.markNow(same);
      return;
    }
    const copy = scratch(canvas.width, canvas.height);
    copy.to.drawImage(canvas, 0, 0);
    const pixels = hashOf(copy.to);
    if (same?.pixels === pixels) {
      same.mayBeOld = false;
      this.markNow(same);
      return;
    }
    const picture = pngOf(copy.canvas);
    const thumb = make(
        'canvas', {height: kThumbHeight, width: Math.max(1, Math.round(kThumbHeight * canvas.width / canvas.height))});
    const to = context(thumb);
    to.imageSmoothingQuality = 'high';
    to.fillStyle = '#fff';
    to.fillRect(0, 0, thumb.width, thumb.height);
    to.drawImage(canvas, 0, 0, thumb.width, thumb.height);
    const thumbnail = thumb.toDataURL('image/jpeg', 0.9);
    const label = describe(state), seen = {id: this.next++, settings, signature, label, thumbnail, pixels};
    this.markNow(this.add(seen, label, () => picture));
    this.write();
    this.onChange();
  }

  write() {
    keepSeen(this.entries.map(({id, settings, signature, label, thumbnail, pixels}) =>
        ({id, settings, signature, label, thumbnail, pixels})));
  }

  /**
   * Keys were written into a style's file: what was seen with the file's values has them as keys of its own now.
   * @param {string} style
   * @param {Record<string, any>} saved @param {Record<string, any>} before as Store.rebase has them
   */
  rebase(style, saved, before) {
    for (const entry of this.entries) {
      if (entry.settings.style !== style) continue;
      /** @type {Record<string, any>} */
      const keys = {...entry.settings.keys};
      for (const name of Object.keys(saved)) {
        if (!(name in keys)) keys[name] = before[name];
        else if (keys[name] === saved[name]) delete keys[name];
      }
      entry.settings.keys = keys;
      entry.signature = JSON.stringify(entry.settings);
    }
    this.write();
  }

  /** What this tab had seen before it was loaded anew: its settings and thumbnails. The pictures are painted again. */
  remember() {
    for (const seen of keptSeen()) {
      const entry = this.add(seen, `${seen.label} · painted anew`, async (signal) => {
        const changes = this.store.changesTo(entry.settings);
        const json = {changes, quality: 'final', format: 'png', show: ''};
        return (await call('POST', '/api/frame', {json, signal})).blob();
      });
      entry.mayBeOld = true;
      this.next = Math.max(this.next, seen.id + 1);
    }
    this.onChange();
  }

  /**
   * At the end of the strip.
   * @param {import('./memory.js').SeenPicture} seen
   * @param {string} name
   * @param {Entry['picture']} picture
   */
  add(seen, name, picture) {
    const {id, thumbnail} = seen;
    const item = make('li', {className: 'seen'});
    item.dataset.seen = String(id);
    const restore = make('button', {type: 'button', className: 'restore', title: `${name}: click to come back to it`,
                                    'aria-label': `Come back to ${id}: ${name}`},
                         make('img', {alt: '', src: thumbnail, height: kThumbHeight / 2, draggable: false}));
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
    /** @type {Entry} */
    const entry = {...seen, item, name, picture, mayBeOld: false};
    this.entries.push(entry);
    this.list.append(item);
    if (this.entries.length > kMost) this.entries.shift()?.item.remove();
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
