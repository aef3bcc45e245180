// The picture on the screen: zoom, pan, and the layers that lie over one another in one or two panes.
import {byId, clamp, scratch} from './dom.js';

const kSteps = [0.05, 0.1, 0.17, 0.25, 0.33, 0.5, 0.67, 1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32];

export class View {
  constructor() {
    this.stage = byId('stage', HTMLElement);
    this.panes = [byId('pane-a', HTMLElement), byId('pane-b', HTMLElement)];
    this.sheets = this.panes.map((pane) => /** @type {HTMLElement} */ (pane.querySelector('.sheet')));
    this.picture = byId('picture', HTMLCanvasElement);
    this.overlay = byId('overlay', HTMLCanvasElement);
    this.width = 0;   // pixels of the final, whatever a draft has
    this.height = 0;
    /** @type {number | null} screen pixels for one of the picture; null: it fits */
    this.zoom = null;
    this.centre = [0.5, 0.5];  // what stands in the middle of a pane, as a share of the picture
    /** @type {(() => void)[]} */
    this.listeners = [];
    new ResizeObserver(() => this.layout()).observe(this.stage);
    byId('zoom-in', HTMLElement).addEventListener('click', () => this.step(1));
    byId('zoom-out', HTMLElement).addEventListener('click', () => this.step(-1));
    byId('zoom-fit', HTMLElement).addEventListener('click', () => this.setZoom(null));
    byId('zoom-one', HTMLElement).addEventListener('click', () => this.setZoom(1));
  }

  /** @param {number} width @param {number} height */
  setSize(width, height) {
    const isNew = width !== this.width || height !== this.height;
    this.width = width;
    this.height = height;
    for (const sheet of this.sheets) sheet.dataset.ready = '';
    if (isNew) this.layout();
  }

  /** Screen pixels for one of the picture. */
  get scale() {
    if (this.zoom !== null) return this.zoom;
    const box = this.panes[0].getBoundingClientRect(), ratio = devicePixelRatio, margin = 16;
    const fit = Math.min((box.width - margin) / this.width, (box.height - margin) / this.height) * ratio;
    // A picture that nearly fits as it is, is shown as it is: sharp.
    return fit > 1 && fit < 1.2 ? 1 : Math.max(fit, 0.01);
  }

  /** @param {number | null} zoom @param {{x: number, y: number} | null} [at] a place of the screen that stays */
  setZoom(zoom, at = null) {
    const fixed = at && this.placeAt(at.x, at.y);
    this.zoom = zoom === null ? null : clamp(zoom, 0.02, 64);
    if (zoom === null) this.centre = [0.5, 0.5];
    if (at && fixed) {
      const css = this.scale / devicePixelRatio;
      const box = this.panes[fixed.pane].getBoundingClientRect();
      this.centre = [(fixed.x + (box.left + box.width / 2 - at.x) / css) / this.width,
                     (fixed.y + (box.top + box.height / 2 - at.y) / css) / this.height];
    }
    this.layout();
  }

  /** @param {number} direction @param {{x: number, y: number} | null} [at] */
  step(direction, at = null) {
    const now = this.scale;
    const next = direction > 0 ? kSteps.find((step) => step > now * 1.01)
                               : [...kSteps].reverse().find((step) => step < now * 0.99);
    if (next) this.setZoom(next, at);
  }

  /**
   * Moves the picture on the screen.
   * @param {number} dx
   * @param {number} dy CSS pixels
   */
  pan(dx, dy) {
    if (this.zoom === null) this.zoom = this.scale;
    const css = this.scale / devicePixelRatio;
    this.centre = [clamp(this.centre[0] - dx / css / this.width, 0, 1),
                   clamp(this.centre[1] - dy / css / this.height, 0, 1)];
    this.layout();
  }

  layout() {
    if (!this.width) return;
    this.stack();
    const ratio = devicePixelRatio, scale = this.scale;
    const width = this.width * scale / ratio, height = this.height * scale / ratio;
    this.panes.forEach((pane, index) => {
      const sheet = this.sheets[index];
      const box = pane.getBoundingClientRect();
      const place = (/** @type {number} */ span, /** @type {number} */ centre, /** @type {number} */ size) =>
          Math.round((span / 2 - centre * size) * ratio) / ratio;
      sheet.style.width = `${width}px`;
      sheet.style.height = `${height}px`;
      sheet.style.transform =
          `translate(${place(box.width, this.centre[0], width)}px, ${place(box.height, this.centre[1], height)}px)`;
      sheet.classList.toggle('pixelated', scale > 2);
    });
    byId('zoom', HTMLElement).textContent = `${Math.round(scale * 100)} %`;
    byId('zoom-fit', HTMLElement).setAttribute('aria-pressed', String(this.zoom === null));
    byId('zoom-one', HTMLElement).setAttribute('aria-pressed', String(this.zoom === 1));
    for (const listener of this.listeners) listener();
  }

  /** Two panes stand beside each other or one above the other: where the pictures are larger. */
  stack() {
    const box = this.stage.getBoundingClientRect(), across = this.width / this.height;
    const beside = Math.min(box.width / 2, box.height * across), above = Math.min(box.width, box.height / 2 * across);
    this.stage.toggleAttribute('data-stacked', !this.panes[1].hidden && above > beside);
  }

  /**
   * The place of the picture under a place of the screen; outside of it too.
   * @param {number} x @param {number} y clientX and clientY
   */
  placeAt(x, y) {
    const second = this.panes[1].getBoundingClientRect();
    const pane = !this.panes[1].hidden && x >= second.left && y >= second.top ? 1 : 0;
    const box = this.sheets[pane].getBoundingClientRect();
    return {pane, x: (x - box.left) / box.width * this.width, y: (y - box.top) / box.height * this.height};
  }

  /**
   * The pixel under a place of the screen, or null.
   * @param {number} x
   * @param {number} y
   */
  pixelAt(x, y) {
    if (!this.width) return null;
    const place = this.placeAt(x, y);
    const px = Math.floor(place.x), py = Math.floor(place.y);
    return px >= 0 && py >= 0 && px < this.width && py < this.height ? {x: px, y: py} : null;
  }

  /**
   * Shows a mask over the picture: where it is, the accent's colour, and around it a dark line.
   * @param {ImageBitmap | null} mask grey with alpha
   */
  showMask(mask) {
    const canvas = this.overlay;
    const to = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    if (!mask) {
      to.clearRect(0, 0, canvas.width, canvas.height);
      return;
    }
    canvas.width = mask.width;
    canvas.height = mask.height;
    // A rim of two pixels: the mask eight times, moved; its inside is taken out again and laid on thinly.
    const reach = Math.max(1, Math.round(2 / Math.min(1, this.scale)));
    for (const dx of [-reach, 0, reach]) for (const dy of [-reach, 0, reach]) to.drawImage(mask, dx, dy);
    to.globalCompositeOperation = 'destination-out';
    to.drawImage(mask, 0, 0);
    to.globalCompositeOperation = 'source-in';
    to.fillStyle = '#ffb13d';
    to.fillRect(0, 0, canvas.width, canvas.height);
    const {canvas: inside, to: fill} = scratch(mask.width, mask.height);
    fill.drawImage(mask, 0, 0);
    fill.globalCompositeOperation = 'source-in';
    fill.fillStyle = 'rgb(255 177 61 / 38%)';
    fill.fillRect(0, 0, mask.width, mask.height);
    to.globalCompositeOperation = 'source-over';
    to.drawImage(inside, 0, 0);
  }
}
