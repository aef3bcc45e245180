// What stands under the pointer: its source on the exemplar, its chunk in the picture, a line of words; and the other
// way round, what a place of the exemplar feeds.
import {getJson, getPicture, isAbort} from './api.js';
import {byId, make} from './dom.js';

/** @typedef {import('./api.js').Pick} Pick */

const kRestMs = 60;
const kFedRadius = 10;  // exemplar pixels

export class Picker {
  /**
   * @param {import('./view.js').View} view @param {import('./exemplar.js').ExemplarPanel} exemplar
   * @param {() => boolean} canPick whether a final is on the screen
   */
  constructor(view, exemplar, canPick) {
    this.view = view;
    this.exemplar = exemplar;
    this.canPick = canPick;
    this.caption = byId('pick', HTMLElement);
    this.timer = 0;
    this.last = '';
    this.abort = new AbortController();
    view.stage.addEventListener('pointermove', (event) => {
      if (event.buttons || event.pointerType === 'touch') return;
      const pixel = view.pixelAt(event.clientX, event.clientY);
      if (pixel) this.soon(`${pixel.x} ${pixel.y}`, () => this.pick(pixel));
      else this.clear();
    });
    view.stage.addEventListener('pointerleave', () => this.clear());
    exemplar.onPlace = (place) => {
      if (!place) this.clear();
      else this.soon(JSON.stringify(place), () => this.fed(place));
    };
  }

  /**
   * Calls when the pointer has rested.
   * @param {string} what
   * @param {() => Promise<void>} action
   */
  soon(what, action) {
    if (what === this.last) return;
    this.last = what;
    clearTimeout(this.timer);
    this.abort.abort();
    this.timer = setTimeout(async () => {
      if (!this.canPick()) {
        this.last = '';
        return;
      }
      this.abort = new AbortController();
      try {
        await action();
      } catch (error) {
        if (!isAbort(error)) this.clear();  // the picture is being painted anew, or cannot be
      }
    }, kRestMs);
  }

  clear() {
    clearTimeout(this.timer);
    this.abort.abort();
    if (this.last === '' && !this.caption.firstChild) return;
    this.last = '';
    this.view.showMask(null);
    this.caption.replaceChildren();
    this.exemplar.clearRing();
  }

  /** @param {{x: number, y: number}} pixel */
  async pick(pixel) {
    const {signal} = this.abort;
    /** @type {Pick} */
    const found = await getJson('/api/pick', pixel, signal);
    this.tell(pixel, found);
    if (!found.covered || !found.source) {
      this.view.showMask(null);
      this.exemplar.clearRing();
      return;
    }
    await this.exemplar.mark(found.style ?? 0, found.exemplar ?? 0, found.source, signal);
    this.showMask(await getPicture('/api/chunk', pixel, signal), signal);
  }

  /** @param {{style: number, exemplar: number, x: number, y: number}} place */
  async fed(place) {
    const {signal} = this.abort;
    this.showMask(await getPicture('/api/fed', {...place, radius: kFedRadius}, signal), signal);
    this.caption.replaceChildren(make('span', {textContent: `exemplar ${place.x}, ${place.y}: all that it feeds`}));
  }

  /** @param {ImageBitmap} mask @param {AbortSignal} signal */
  showMask(mask, signal) {
    if (!signal.aborted) this.view.showMask(mask);
    mask.close();
  }

  /** @param {{x: number, y: number}} pixel @param {Pick} found */
  tell(pixel, found) {
    const place = `${pixel.x}, ${pixel.y}`;
    if (!found.covered) {
      this.caption.replaceChildren(make('span', {textContent: `${place}: nothing stands here`}));
      return;
    }
    const words = [];
    if (found.style_id) words.push(found.style_id);
    if (found.source) words.push(`from ${found.source.map(Math.round).join(', ')}`);
    if (found.level !== undefined && found.level !== null) words.push(`level ${found.level}`);
    if (found.chunk) words.push(`chunk of ${found.chunk.area} px`);
    if (found.normal) words.push(`normal ${found.normal.map((n) => n.toFixed(2).replace('-', '−')).join(' ')}`);
    if (typeof found.luminance === 'number') words.push(`luminance ${found.luminance.toFixed(2)}`);
    const material = found.material && found.material !== found.object ? ` · ${found.material}` : '';
    this.caption.replaceChildren(make('b', {textContent: (found.object ?? '') + material}), ' ',
                                 make('span', {textContent: words.join(' · ')}));
    this.caption.title = `${place} · ${this.caption.textContent}`;
  }
}
