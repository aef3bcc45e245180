// The strip of what has been seen: a picture and the settings that made it. A click brings the settings back.
import {call} from './api.js';
import {byId, context, make, pngOf, scratch} from './dom.js';
import {labelOf} from './keys.js';
import {keepSeen, keptSeen} from './memory.js';
import {settingsOf} from './store.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Changes} Changes */
/** @typedef {import('./memory.js').SeenPicture & {item: HTMLLIElement, picture: () => Promise<Blob>}} Entry */

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
    const picture = pngOf(copy.canvas);
    const thumb = make(
        'canvas', {height: kThumbHeight, width: Math.max(1, Math.round(kThumbHeight * canvas.width / canvas.height))});
    const to = context(thumb);
    to.imageSmoothingQuality = 'high';
    to.fillStyle = '#fff';
    to.fillRect(0, 0, thumb.width, thumb.height);
    to.drawImage(canvas, 0, 0, thumb.width, thumb.height);
    const thumbnail = thumb.toDataURL('image/jpeg', 0.9);
    this.markNow(this.add({id: this.next++, settings, signature, label: describe(state), thumbnail}, () => picture));
    keepSeen(this.entries.map(({id, settings, signature, label, thumbnail}) =>
        ({id, settings, signature, label, thumbnail})));
    this.onChange();
  }

  /** What this tab had seen before it was loaded anew: its settings and thumbnails. The pictures are painted again. */
  remember() {
    for (const seen of keptSeen()) {
      this.add({...seen, label: `${seen.label} · painted anew`}, async () => {
        const changes = this.store.changesTo(seen.settings);
        const answer = await call('POST', '/api/frame', {json: {changes, quality: 'final', format: 'png', show: ''}});
        return answer.blob();
      });
      this.next = Math.max(this.next, seen.id + 1);
    }
    this.onChange();
  }

  /**
   * At the end of the strip.
   * @param {import('./memory.js').SeenPicture} seen
   * @param {() => Promise<Blob>} picture
   */
  add(seen, picture) {
    const {id, settings, label, thumbnail} = seen;
    const item = make('li', {className: 'seen'});
    item.dataset.seen = String(id);
    const restore = make('button', {type: 'button', className: 'restore', title: `${label}: click to come back to it`,
                                    'aria-label': `Come back to ${id}: ${label}`},
                         make('img', {alt: '', src: thumbnail, height: kThumbHeight / 2, draggable: false}));
    restore.addEventListener('click', () => void this.store.restore(settings));
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
    const entry = {...seen, item, picture};
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
