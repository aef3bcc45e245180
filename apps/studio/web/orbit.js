// The camera under the pointer and the keys: orbit, pan, distance; and the picture itself with Ctrl.
import {clamp, rounded} from './dom.js';

/** @typedef {import('./api.js').Orbit} Orbit */

const kDegreesPerPixel = 0.35;
const kFov = 35;
const kClickPixels = 4;

/** @param {Orbit} eye @param {Partial<Orbit>} change @returns {Orbit} */
export function turned(eye, change) {
  const next = {...eye, ...change};
  let azimuth = (next.azimuth + 180) % 360;
  if (azimuth < 0) azimuth += 360;
  return {...next, azimuth: rounded(azimuth - 180), elevation: rounded(clamp(next.elevation, -90, 90)),
          distance: rounded(next.distance, 5), right: rounded(next.right, 5), up: rounded(next.up, 5)};
}

export class OrbitControl {
  /**
   * @param {import('./store.js').Store} store
   * @param {import('./view.js').View} view
   * @param {(pixel: {x: number, y: number}, at: {x: number, y: number}) => void} onClick
   */
  constructor(store, view, onClick) {
    this.store = store;
    this.view = view;
    this.onClick = onClick;
    /** @type {Map<number, {x: number, y: number}>} */
    this.pointers = new Map();
    this.moved = 0;
    const stage = view.stage;
    stage.addEventListener('pointerdown', (event) => this.down(event));
    stage.addEventListener('pointermove', (event) => this.move(event));
    stage.addEventListener('pointerup', (event) => this.up(event, true));
    stage.addEventListener('pointercancel', (event) => this.up(event, false));
    stage.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    stage.addEventListener('keydown', (event) => this.key(event));
  }

  /** @param {Partial<Orbit>} change @param {string} gesture */
  look(change, gesture) {
    const view = turned(this.store.state.eye, change);
    void this.store.patch({view}, {moving: true, gesture});
  }

  /**
   * Looks at the scene's centre from here.
   * @param {number} azimuth
   * @param {number} elevation
   */
  from(azimuth, elevation) {
    void this.store.patch({view: {...this.store.state.eye, azimuth, elevation, right: 0, up: 0}});
  }

  home() { void this.store.patch({view: null}); }

  frameAll() { void this.store.patch({view: {...this.store.state.eye, distance: 0, right: 0, up: 0}}); }

  /** Metres in the plane that is looked at, for one CSS pixel. */
  metresPerPixel() {
    const eye = this.store.state.eye;
    const height = this.view.height * this.view.scale / devicePixelRatio;
    return 2 * eye.distance * Math.tan((eye.fov || kFov) * Math.PI / 360) / height;
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (event.target instanceof HTMLElement && event.target.id === 'wipe') return;
    if (event.button > 1) return;
    if (event.button === 1) event.preventDefault();
    this.view.stage.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    if (this.pointers.size === 1) this.moved = 0;
  }

  /** @param {PointerEvent} event */
  move(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const dx = event.clientX - last.x, dy = event.clientY - last.y;
    if (this.pointers.size === 2) {
      this.pinch(event, last);
      return;
    }
    this.moved += Math.abs(dx) + Math.abs(dy);
    if (this.moved < kClickPixels) return;
    this.view.stage.dataset.drag = '';
    this.pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    const eye = this.store.state.eye;
    if (event.ctrlKey || event.metaKey) {
      this.view.pan(dx, dy);
    } else if (event.shiftKey) {
      const step = this.metresPerPixel();
      this.look({right: eye.right - dx * step, up: eye.up + dy * step}, 'pan');
    } else {
      this.look(
          {azimuth: eye.azimuth - dx * kDegreesPerPixel, elevation: eye.elevation + dy * kDegreesPerPixel}, 'orbit');
    }
  }

  /**
   * Two fingers move and zoom the picture.
   * @param {PointerEvent} event
   * @param {{x: number, y: number}} last
   */
  pinch(event, last) {
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1] ?? last;
    const span = (/** @type {{x: number, y: number}} */ p) => Math.hypot(p.x - other.x, p.y - other.y) || 1;
    const now = {x: event.clientX, y: event.clientY};
    this.view.setZoom(this.view.scale * span(now) / span(last), {x: (now.x + other.x) / 2, y: (now.y + other.y) / 2});
    this.view.pan((now.x - last.x) / 2, (now.y - last.y) / 2);
    this.pointers.set(event.pointerId, now);
    this.moved = Infinity;
  }

  /** @param {PointerEvent} event @param {boolean} isClick */
  up(event, isClick) {
    if (!this.pointers.delete(event.pointerId) || this.pointers.size) return;
    delete this.view.stage.dataset.drag;
    if (!isClick || this.moved >= kClickPixels || event.button !== 0) return;
    const pixel = this.view.pixelAt(event.clientX, event.clientY);
    if (pixel) this.onClick(pixel, {x: event.clientX, y: event.clientY});
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const delta = clamp(event.deltaY * (event.deltaMode === 1 ? 30 : 1), -240, 240);
    if (event.ctrlKey || event.metaKey) {
      this.view.setZoom(this.view.scale * 1.0025 ** -delta, {x: event.clientX, y: event.clientY});
    } else {
      this.look({distance: this.store.state.eye.distance * 1.0012 ** delta}, 'distance');
    }
  }

  /** @param {KeyboardEvent} event */
  key(event) {
    if (event.target !== this.view.stage || event.altKey || event.ctrlKey || event.metaKey) return;
    if (event.code.startsWith('Numpad')) return;
    const eye = this.store.state.eye, step = this.metresPerPixel() * 40, shift = event.shiftKey;
    /** @type {Record<string, [Partial<Orbit>, Partial<Orbit>]>} plain, with Shift */
    const moves = {
      ArrowLeft: [{azimuth: eye.azimuth - 5}, {right: eye.right - step}],
      ArrowRight: [{azimuth: eye.azimuth + 5}, {right: eye.right + step}],
      ArrowUp: [{elevation: eye.elevation + 5}, {up: eye.up + step}],
      ArrowDown: [{elevation: eye.elevation - 5}, {up: eye.up - step}],
      PageUp: [{distance: eye.distance / 1.1}, {distance: eye.distance / 1.1}],
      PageDown: [{distance: eye.distance * 1.1}, {distance: eye.distance * 1.1}],
    };
    const move = moves[event.key];
    if (!move) return;
    event.preventDefault();
    this.look(move[shift ? 1 : 0], 'keys');
  }
}
