// Strokes of a round brush in a layer, with undo. Knows no elements of the page but the layer's canvas.
import {context, scratch} from './dom.js';

/** @typedef {{size: number, hardness: number, opacity: number, colour: string, eraser: boolean}} Brush */
/** @typedef {{x: number, y: number, pressure: number}} Point */
/** @typedef {{x: number, y: number, before: ImageData, after: ImageData}} Done */

const kSpacing = 0.12;  // of the brush's size
const kMostUndo = 60;

/**
 * One dab of the brush, white with alpha.
 * @param {Brush} brush
 */
function dabOf({size, hardness}) {
  const side = Math.ceil(size) + 2;
  const {canvas, to} = scratch(side, side);
  const fade =
      to.createRadialGradient(side / 2, side / 2, size / 2 * Math.min(hardness, 0.97), side / 2, side / 2, size / 2);
  for (const [at, alpha] of [[0, 1], [0.25, 0.84], [0.5, 0.5], [0.75, 0.16], [1, 0]]) {
    fade.addColorStop(at, `rgb(255 255 255 / ${alpha})`);
  }
  to.fillStyle = fade;
  to.fillRect(0, 0, side, side);
  return canvas;
}

export class Strokes {
  /** @param {HTMLCanvasElement} canvas the layer */
  constructor(canvas) {
    this.canvas = canvas;
    /** @type {Done[]} */
    this.done = [];
    /** @type {Done[]} */
    this.undone = [];
    /** @type {{brush: Brush, dab: HTMLCanvasElement, mask: HTMLCanvasElement, before: HTMLCanvasElement, last: Point,
     *   rest: number, box: number[]} | null} */
    this.stroke = null;
    this.hasForgotten = false;  // strokes that are too old to be undone
    this.isSaved = true;
  }

  get isEmpty() { return this.done.length === 0 && !this.hasForgotten; }

  /**
   * An empty layer of this size.
   * @param {number} width
   * @param {number} height
   */
  clear(width, height) {
    this.canvas.width = width;
    this.canvas.height = height;
    this.done = [];
    this.undone = [];
    this.stroke = null;
    this.hasForgotten = false;
    this.isSaved = true;
  }

  /** @param {Brush} brush @param {Point} point */
  begin(brush, point) {
    const {width, height} = this.canvas;
    const before = scratch(width, height);
    before.to.drawImage(this.canvas, 0, 0);
    this.stroke = {brush, dab: dabOf(brush), mask: scratch(width, height).canvas, before: before.canvas, last: point,
                   rest: 0, box: [width, height, 0, 0]};
    this.stamp(point);
    this.show();
  }

  /** @param {Point[]} points */
  go(points) {
    const stroke = this.stroke;
    if (!stroke) return;
    for (const point of points) {
      const from = stroke.last, length = Math.hypot(point.x - from.x, point.y - from.y);
      const step = Math.max(0.5, stroke.brush.size * kSpacing);
      let at = step - stroke.rest;
      for (; at <= length; at += step) {
        const share = at / length;
        this.stamp({x: from.x + (point.x - from.x) * share, y: from.y + (point.y - from.y) * share,
                    pressure: from.pressure + (point.pressure - from.pressure) * share});
      }
      stroke.rest = length - (at - step);
      stroke.last = point;
    }
    this.show();
  }

  /** @param {Point} point */
  stamp({x, y, pressure}) {
    const stroke = this.stroke;
    const to = stroke?.mask.getContext('2d');
    if (!stroke || !to) return;
    const side = stroke.dab.width * (0.3 + 0.7 * pressure);
    to.globalAlpha = 0.4 + 0.6 * pressure;
    to.drawImage(stroke.dab, x - side / 2, y - side / 2, side, side);
    const box = stroke.box;
    stroke.box = [Math.min(box[0], x - side / 2 - 1), Math.min(box[1], y - side / 2 - 1),
                  Math.max(box[2], x + side / 2 + 1), Math.max(box[3], y + side / 2 + 1)];
  }

  /**
   * The part of the layer that the stroke touches.
   * @returns {[number, number, number, number]} x, y, width, height
   */
  touched() {
    const {width, height} = this.canvas, box = this.stroke?.box ?? [0, 0, 0, 0];
    const x = Math.max(0, Math.floor(box[0])), y = Math.max(0, Math.floor(box[1]));
    return [x, y, Math.min(width, Math.ceil(box[2])) - x, Math.min(height, Math.ceil(box[3])) - y];
  }

  /** Draws the stroke as it is now: all of it with one opacity, however often it crosses itself. */
  show() {
    const stroke = this.stroke;
    const [x, y, width, height] = this.touched();
    if (!stroke || width <= 0 || height <= 0) return;
    const {brush} = stroke;
    const {canvas: paint, to: fill} = scratch(width, height);
    fill.drawImage(stroke.mask, -x, -y);
    fill.globalCompositeOperation = 'source-in';
    fill.fillStyle = brush.colour;
    fill.fillRect(0, 0, width, height);
    const to = context(this.canvas);
    to.clearRect(x, y, width, height);
    to.drawImage(stroke.before, x, y, width, height, x, y, width, height);
    to.globalAlpha = brush.opacity;
    to.globalCompositeOperation = brush.eraser ? 'destination-out' : 'source-over';
    to.drawImage(paint, x, y);
    to.globalAlpha = 1;
    to.globalCompositeOperation = 'source-over';
  }

  end() {
    const stroke = this.stroke;
    const [x, y, width, height] = this.touched();
    this.stroke = null;
    if (!stroke || width <= 0 || height <= 0) return;
    this.done.push({x, y, before: context(stroke.before).getImageData(x, y, width, height),
                    after: context(this.canvas).getImageData(x, y, width, height)});
    if (this.done.length > kMostUndo) {
      this.done.shift();
      this.hasForgotten = true;
    }
    this.undone = [];
    this.isSaved = false;
  }

  undo() {
    const step = this.done.pop();
    if (!step) return false;
    context(this.canvas).putImageData(step.before, step.x, step.y);
    this.undone.push(step);
    this.isSaved = this.isEmpty;
    return true;
  }

  redo() {
    const step = this.undone.pop();
    if (!step) return false;
    context(this.canvas).putImageData(step.after, step.x, step.y);
    this.done.push(step);
    this.isSaved = false;
    return true;
  }
}
