// One sun in place of the scene's lights: dragged over a small sphere, or by its two angles.
import {byId, context, fillTrack, rounded} from './dom.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Light} Light */

const kFirst = {azimuth: -40, elevation: 40};

/**
 * The unit vector towards a light, +Z towards the viewer.
 * @param {Light} light
 * @returns {[number, number, number]}
 */
export function directionOf({azimuth, elevation}) {
  const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180;
  return [Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e)];
}

/**
 * The light that shines on a place of the sphere straight.
 * @param {number} x right
 * @param {number} y up, unit disc
 */
export function lightAt(x, y) {
  const length = Math.max(1, Math.hypot(x, y) / 0.999);
  const nx = x / length, ny = y / length, nz = Math.sqrt(Math.max(0, 1 - nx * nx - ny * ny));
  return {
    azimuth: rounded(Math.atan2(nx, nz) * 180 / Math.PI, 1),
    elevation: rounded(Math.asin(ny) * 180 / Math.PI, 1)
  };
}

export class LightPanel {
  /** @param {import('./store.js').Store} store */
  constructor(store) {
    this.store = store;
    this.canvas = byId('light-sphere', HTMLCanvasElement);
    this.azimuth = byId('light-azimuth', HTMLInputElement);
    this.elevation = byId('light-elevation', HTMLInputElement);
    this.drawn = '';
    const drag = (/** @type {PointerEvent} */ event) => {
      const box = this.canvas.getBoundingClientRect();
      this.change(
          lightAt((event.clientX - box.left) / box.width * 2 - 1, 1 - (event.clientY - box.top) / box.height * 2));
    };
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      drag(event);
    });
    this.canvas.addEventListener('pointermove', (event) => {
      if (this.canvas.hasPointerCapture(event.pointerId)) drag(event);
    });
    for (const input of [this.azimuth, this.elevation]) {
      input.addEventListener('input', () => this.change({azimuth: Number(this.azimuth.value),
                                                         elevation: Number(this.elevation.value)}));
    }
    byId('light-reset', HTMLElement).addEventListener('click', () => void store.patch({light: null}));
    store.listen((state) => this.update(state));
  }

  /** @param {Light} light */
  change(light) {
    void this.store.patch({light}, {moving: true, gesture: 'light'});
  }

  /** @param {State} state */
  update(state) {
    const light = state.light ?? kFirst;
    this.azimuth.value = String(light.azimuth);
    this.elevation.value = String(light.elevation);
    for (const input of [this.azimuth, this.elevation]) {
      fillTrack(input);
      const output = document.querySelector(`output[for="${input.id}"]`);
      if (output) output.textContent = state.light ? `${Math.round(Number(input.value))}°` : '–';
    }
    byId('light-reset', HTMLButtonElement).disabled = state.light === null;
    byId('light-note', HTMLElement).textContent = state.light ? 'One sun.'
        : `${state.lights} ${state.lights === 1 ? 'light' : 'lights'} of the scene.`;
    const signature = JSON.stringify(state.light);
    if (signature !== this.drawn) this.draw(state.light);
    this.drawn = signature;
  }

  /**
   * A sphere in this light; in the scene's own it is flat grey.
   * @param {Light | null} light
   */
  draw(light) {
    const size = this.canvas.width, half = size / 2, to = context(this.canvas);
    const image = to.createImageData(size, size);
    const [lx, ly, lz] = directionOf(light ?? kFirst);
    for (let row = 0; row < size; row++) {
      for (let column = 0; column < size; column++) {
        const x = (column + 0.5) / half - 1, y = 1 - (row + 0.5) / half, rest = 1 - x * x - y * y;
        if (rest <= 0) continue;
        const lit = Math.max(0, x * lx + y * ly + Math.sqrt(rest) * lz);
        const grey = light ? 38 + 205 * lit ** 0.8 : 88 + 62 * lit;
        image.data.set(
            [grey, grey * 0.985, grey * 0.96, 255 * Math.min(1, rest * half * 0.5)], (row * size + column) * 4);
      }
    }
    to.putImageData(image, 0, 0);
    if (!light) return;
    to.beginPath();
    to.arc(half + lx * half * 0.94, half - ly * half * 0.94, 7, 0, 7);
    to.lineWidth = 4;
    to.strokeStyle = '#1b1205';
    to.fillStyle = lz < 0 ? 'transparent' : '#ffb13d';
    to.stroke();
    to.fill();
    to.lineWidth = 2;
    to.strokeStyle = '#ffb13d';
    to.stroke();
  }
}
