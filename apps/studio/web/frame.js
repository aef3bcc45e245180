// Pictures from the server: one fetch at a time, always of the newest state; drafts while something moves, the final
// when it has rested. The picture before stays until the next is decoded.
import {call, CallError, isAbort, withQuery} from './api.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Changes} Changes */
/** @typedef {{source: ImageBitmap | ImageData, width: number, height: number, revision: number, quality: string,
 *   show: string, stages: {name: string, ms: number}[], ms: number}} Picture */

const kRestMs = 150;
// Tells pages of one studio apart.
const kTab = Math.random().toString(36).slice(2);

/** @param {string | null} text "guides;dur=12.5, match;dur=3" */
export function parseTimes(text) {
  return (text ?? '').split(',').flatMap((part) => {
    const match = /^\s*([\w-]+)\s*;.*?dur=([\d.]+)/.exec(part);
    return match ? [{name: match[1], ms: Number(match[2])}] : [];
  });
}

/** @param {Response} response */
const revisionOf = (response) => Number(response.headers.get('X-Scumble-Revision'));

/**
 * @param {Response} response @param {Blob} body @param {string} quality @param {string} show @param {number} begun
 * @returns {Promise<Picture>}
 */
async function decode(response, body, quality, show, begun) {
  const size = (response.headers.get('X-Scumble-Size') ?? '').split('x').map(Number);
  const isRaw = !(response.headers.get('Content-Type') ?? '').startsWith('image/');
  const source = isRaw ? new ImageData(new Uint8ClampedArray(await body.arrayBuffer()), size[0], size[1])
                       : await createImageBitmap(body);
  return {
    source, width: source.width, height: source.height, quality, show,
    revision: revisionOf(response),
    stages: parseTimes(response.headers.get('Server-Timing')), ms: performance.now() - begun,
  };
}

/** @param {HTMLCanvasElement} canvas @param {ImageBitmap | ImageData | HTMLCanvasElement} source */
export function draw(canvas, source) {
  if (canvas.width !== source.width || canvas.height !== source.height) {
    canvas.width = source.width;
    canvas.height = source.height;
  }
  const to = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  if (source instanceof ImageData) {
    to.putImageData(source, 0, 0);
  } else {
    to.clearRect(0, 0, canvas.width, canvas.height);
    to.drawImage(source, 0, 0);
  }
}

/**
 * A final with changes that are not kept.
 * @param {Changes} changes
 * @param {string} show
 * @param {AbortSignal} signal
 */
export async function frameBeside(changes, show, signal) {
  const begun = performance.now();
  const response = await call('POST', '/api/frame',
                              {json: {changes, quality: 'final', format: 'rgba', show}, signal});
  return decode(response, await response.blob(), 'final', show, begun);
}

export class Frames {
  /** @param {import('./store.js').Store} store */
  constructor(store) {
    this.store = store;
    this.show = 'picture';
    /** @type {(picture: Picture) => void} */
    this.onPicture = () => {};
    /** @type {(error: unknown) => void} */
    this.onError = () => {};
    /** @type {(quality: string) => void} */
    this.onBegin = () => {};
    this.movedAt = -Infinity;
    this.timer = 0;
    this.running = false;
    /** @type {{quality: string, revision: number, abort: AbortController} | null} */
    this.current = null;
    /** A final was given up for a change: its draft comes first, so that changes in quick turn are seen. */
    this.owesDraft = false;
    /**
     * On the screen, or a draft that will be in a moment.
     * @type {{revision: number, quality: string, show: string} | null}
     */
    this.drawn = null;
    this.drawing = Promise.resolve();
    this.failed = '';
    this.tries = 0;
    store.onSent = (moving) => this.wake(moving);
  }

  get isMoving() { return performance.now() - this.movedAt < kRestMs; }

  /**
   * The picture may be old.
   * @param {boolean} [moving]
   */
  wake(moving = false) {
    if (moving) this.movedAt = performance.now();
    if (this.isMoving) {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.wake(), this.movedAt + kRestMs - performance.now() + 1);
    }
    const isOld = this.isMoving || this.current?.revision !== this.store.state.revision;
    if (isOld && this.current?.quality === 'final') {
      this.owesDraft = true;
      this.current.abort.abort();
    }
    void this.run();
  }

  /** Fetches anew, whatever is on the screen: files changed, or the server came back. */
  renew() {
    this.drawn = null;
    this.failed = '';
    this.wake();
  }

  /** Waits until nothing is fetched. */
  async rested() {
    while (this.running) await new Promise((resolve) => setTimeout(resolve, 30));
  }

  /** @param {string} show */
  setShow(show) {
    this.show = show;
    this.current?.abort.abort();
    this.wake();
  }

  /** @returns {string} the quality to fetch, or '' */
  next() {
    const revision = this.store.state.revision;
    if (this.failed === `${revision} ${this.show}`) return '';
    const fresh = this.drawn && this.drawn.revision >= revision && this.drawn.show === this.show;
    const quality = this.isMoving || (this.owesDraft && !fresh) ? 'draft' : 'final';
    return fresh && (quality === 'draft' || this.drawn?.quality === 'final') ? '' : quality;
  }

  async run() {
    if (this.running) return;
    this.running = true;
    try {
      for (let quality = this.next(); quality; quality = this.next()) await this.fetchOne(quality);
    } finally {
      this.running = false;
    }
  }

  /** @param {Promise<Picture>} decoded @param {AbortSignal} signal */
  async draw(decoded, signal) {
    try {
      const picture = await decoded;
      if (signal.aborted) return;
      const {revision, quality, show} = picture;
      this.drawn = {revision, quality, show};
      this.onPicture(picture);
    } catch (error) {
      this.failed = `${this.store.state.revision} ${this.show}`;
      this.onError(error);
    }
  }

  /** @param {string} quality */
  async fetchOne(quality) {
    if (quality === 'draft') this.owesDraft = false;
    const abort = new AbortController();
    const show = this.show, begun = performance.now(), revision = this.store.state.revision;
    this.current = {quality, revision, abort};
    this.onBegin(quality);
    try {
      const format = quality === 'draft' ? 'jpeg' : 'rgba';
      const query = {quality, format, show, tab: kTab};
      const response = await call('GET', withQuery('/api/frame', query), {signal: abort.signal});
      const body = await response.blob();
      if (abort.signal.aborted) return;
      await this.drawing;
      this.drawing = this.draw(decode(response, body, quality, show, begun), abort.signal);
      this.tries = 0;
      // A draft is decoded while the server makes the next one.
      if (quality === 'final') await this.drawing;
      else this.drawn = {revision: revisionOf(response), quality, show};
    } catch (error) {
      if (isAbort(error)) return;
      if (error instanceof CallError && error.status === 409) {
        // Another page may ask for its own pictures: both wait, differently long, until one is through.
        await new Promise((resolve) => setTimeout(resolve, Math.random() * 120 * 2 ** Math.min(this.tries++, 4)));
        return;
      }
      this.failed = `${revision} ${show}`;
      this.onError(error);
    } finally {
      this.current = null;
    }
  }
}
