// Painting on the exemplar in a pinch: the tools, the pointer, and saving the layer.
import {call, CallError, getJson, withQuery} from './api.js';
import {byId, context, download, fillTrack, pngOf, scratch} from './dom.js';
import {Strokes} from './strokes.js';

/** @typedef {import('./api.js').Paintable} Paintable */

export class BrushPanel {
  /**
   * @param {import('./exemplar.js').ExemplarPanel} exemplar
   * @param {{announce: (text: string) => void, error: (error: unknown) => void, saveAs: () => void,
   *   layout: () => void}} page
   */
  constructor(exemplar, page) {
    this.exemplar = exemplar;
    this.page = page;
    this.isOn = false;
    this.saving = false;
    // The exemplar that strokes lie on, its file, its style's name, and what that was when the first of them was drawn.
    this.belongsTo = this.file = this.style = '';
    /** @type {Paintable | null} */
    this.own = null;
    /** @type {Paintable | null} of the exemplar that is shown */
    this.paintable = null;
    this.button = byId('paint', HTMLButtonElement);
    this.strokes = new Strokes(byId('exemplar-layer', HTMLCanvasElement));
    this.colour = byId('brush-colour', HTMLInputElement);
    this.eraser = byId('brush-eraser', HTMLInputElement);
    this.sliders = ['size', 'hardness', 'opacity'].map((name) => byId(`brush-${name}`, HTMLInputElement));
    for (const slider of this.sliders) slider.addEventListener('input', () => this.showSliders());
    this.showSliders();
    this.button.addEventListener('click', () => void this.toggle());
    byId('brush-undo', HTMLElement).addEventListener('click', () => this.undo());
    byId('brush-redo', HTMLElement).addEventListener('click', () => this.redo());
    byId('paint-save', HTMLElement).addEventListener('click', () => void this.save());
    byId('paint-download', HTMLElement).addEventListener('click', () => void this.downloadLayer());
    byId('conflict-download', HTMLElement).addEventListener('click', () => void this.downloadLayer());
    byId('conflict-reload', HTMLElement).addEventListener('click', () => void this.reloadBelow());
    const box = exemplar.box;
    box.addEventListener('pointerdown', (event) => this.down(event));
    box.addEventListener('pointermove', (event) => this.move(event));
    box.addEventListener('pointerup', (event) => this.up(event));
    box.addEventListener('pointercancel', (event) => this.up(event));
    box.addEventListener('pointerleave', () => this.cursor(null));
    addEventListener('beforeunload', (event) => {
      if (!this.strokes.isSaved) event.preventDefault();
    });
    this.showUndo();
  }

  showSliders() {
    for (const slider of this.sliders) {
      fillTrack(slider);
      const output = document.querySelector(`output[for="${slider.id}"]`);
      if (output) output.textContent = slider.id === 'brush-size' ? slider.value : `${slider.value} %`;
    }
  }

  /** @returns {import('./strokes.js').Brush} */
  get brush() {
    const [size, hardness, opacity] = this.sliders.map((slider) => Number(slider.value));
    return {
      size,
      hardness: hardness / 100,
      opacity: opacity / 100,
      colour: this.colour.value,
      eraser: this.eraser.checked
    };
  }

  /** @param {number} factor */
  resize(factor) {
    const size = this.sliders[0];
    size.value = String(Math.max(1, Math.round(Number(size.value) * factor)));
    this.showSliders();
  }

  async toggle() {
    if (this.isOn) {
      this.close();
      return;
    }
    if (!this.exemplar.current) return;
    this.isOn = true;
    await this.follow();
  }

  /** The stroke that is being drawn counts. */
  get hasUnsaved() { return !!this.strokes.stroke || (!this.strokes.isSaved && !this.strokes.isEmpty); }

  /** Another exemplar is shown, or its file has changed. Strokes stay with the one that they were painted on. */
  async follow() {
    const {exemplar} = this, here = exemplar.shown;
    this.strokes.canvas.hidden = this.belongsTo !== here;
    if (!exemplar.current && !this.hasUnsaved) this.close();
    if (!this.isOn) return;
    try {
      if (!this.hasUnsaved) this.paintable = await this.ask();
      else if (this.belongsTo === here) this.paintable = this.own;
      else {
        const why = `Strokes on ${this.file} of ${this.style} are not saved: go back to it to save or undo them.`;
        this.paintable = {ok: false, why};
      }
    } catch (error) {
      this.page.error(error);
      this.close();
      return;
    }
    if (here === exemplar.shown) this.show();
  }

  /** @returns {Promise<Paintable>} */
  async ask() {
    const {current} = this.exemplar;
    return current?.style === 0 ?
        getJson('/api/paintable', {exemplar: current.index}) :
        {ok: false, why: 'Only the first style can be painted on: choose it among the styles.'};
  }

  close() {
    if (!this.isOn) return;
    this.isOn = false;
    this.show();
    this.cursor(null);
  }

  show() {
    const {isOn, paintable} = this, canPaint = isOn && !!paintable?.ok;
    byId('brush', HTMLElement).hidden = !isOn;
    byId('brush-tools', HTMLElement).hidden = !canPaint;
    const why = byId('paint-why', HTMLElement);
    why.hidden = canPaint;
    why.textContent = paintable?.why ?? '';
    const {styles, style} = this.exemplar.store.state;
    if (isOn && !canPaint && !this.hasUnsaved && !styles.find(({id}) => id === style)?.writable) {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = 'Save as…';
      button.addEventListener('click', () => this.page.saveAs());
      why.append(' ', button);
    }
    this.button.setAttribute('aria-pressed', String(isOn));
    this.exemplar.locked = canPaint;
    document.body.toggleAttribute('data-paint', canPaint);
    if (canPaint && !this.hasUnsaved) {
      const {base} = this.exemplar, {canvas} = this.strokes;
      const width = paintable?.width ?? base.width, height = paintable?.height ?? base.height;
      const isOther = this.belongsTo !== this.exemplar.shown || canvas.width !== width || canvas.height !== height;
      if (isOther) this.strokes.clear(width, height);  // otherwise what was undone can be done again
      this.belongsTo = this.exemplar.shown;
      this.file = paintable?.file ?? '';
      const {state} = this.exemplar.store;
      this.style = state.styles.find(({id}) => id === state.style)?.name ?? state.style;
      this.own = paintable;
      this.strokes.canvas.hidden = false;
    }
    this.showUndo();
    this.page.layout();
  }

  showUndo() {
    byId('brush-undo', HTMLButtonElement).disabled = this.strokes.done.length === 0;
    byId('brush-redo', HTMLButtonElement).disabled = this.strokes.undone.length === 0;
    byId('paint-save', HTMLButtonElement).disabled = this.strokes.isSaved || this.saving;
  }

  /** @returns {boolean} whether the page's undo was ours */
  undo() {
    const done = this.strokes.undo();
    this.showUndo();
    if (done && !this.hasUnsaved) void this.follow();  // the file may be another one by now
    return done;
  }

  redo() {
    const done = this.strokes.redo();
    this.showUndo();
    return done;
  }

  get canPaint() { return this.isOn && this.exemplar.locked && !this.saving; }

  /** @param {PointerEvent} event */
  point(event) {
    const {x, y} = this.exemplar.placeAt(event);
    // A mouse says 0.5 while it is down; a pen says what it feels.
    return {x, y, pressure: event.pointerType === 'pen' ? event.pressure : 1};
  }

  /** @param {PointerEvent} event */
  down(event) {
    if (!this.canPaint || event.button !== 0) return;
    if (event.altKey) {
      this.takeColour(event);
      return;
    }
    this.exemplar.box.setPointerCapture(event.pointerId);
    this.strokes.begin(this.brush, this.point(event));
  }

  /** @param {PointerEvent} event */
  move(event) {
    if (!this.canPaint) return;
    this.cursor(event);
    if (!this.strokes.stroke) return;
    const events = event.getCoalescedEvents?.() ?? [];
    this.strokes.go((events.length ? events : [event]).map((one) => this.point(one)));
  }

  /** @param {PointerEvent} event */
  up(event) {
    if (!this.strokes.stroke) return;
    if (event.type === 'pointerup') this.strokes.go([this.point(event)]);
    this.strokes.end();
    this.showUndo();
  }

  /**
   * A ring of the brush's size.
   * @param {PointerEvent | null} event
   */
  cursor(event) {
    const canvas = this.exemplar.marks, to = context(canvas);
    to.clearRect(0, 0, canvas.width, canvas.height);
    if (!event) return;
    const {x, y} = this.exemplar.placeAt(event), unit = canvas.width / Math.max(1, this.exemplar.box.clientWidth);
    for (const [colour, width] of /** @type {const} */ ([['rgb(0 0 0 / 70%)', 3], ['#ffffff', 1.2]])) {
      to.strokeStyle = colour;
      to.lineWidth = width * unit;
      to.beginPath();
      to.arc(x, y, Math.max(2 * unit, this.brush.size / 2), 0, 7);
      to.stroke();
    }
  }

  /**
   * The colour that is seen there: the file's, with strokes over it.
   * @param {PointerEvent} event
   */
  takeColour(event) {
    const {x, y} = this.exemplar.placeAt(event);
    const {to} = scratch(1, 1);
    for (const canvas of [this.exemplar.base, this.strokes.canvas])
      to.drawImage(canvas, -Math.floor(x), -Math.floor(y));
    const bytes = [...to.getImageData(0, 0, 1, 1).data].slice(0, 3);
    this.colour.value = `#${bytes.map((byte) => byte.toString(16).padStart(2, '0')).join('')}`;
    this.eraser.checked = false;
  }

  async save() {
    this.strokes.end();
    await this.exemplar.store.rested();  // another style may be on its way, whose file may have the same bytes
    const exemplar = this.exemplar.current, isOwn = this.belongsTo === this.exemplar.shown;
    if (!this.canPaint || this.strokes.isSaved || !exemplar || !isOwn) return;
    this.saving = true;
    this.showUndo();
    try {
      const query = {exemplar: exemplar.index, stamp: this.paintable?.stamp ?? ''};
      const response = await call('POST', withQuery('/api/paint', query), {blob: await pngOf(this.strokes.canvas)});
      this.paintable = this.own = await response.json();
      this.strokes.isSaved = true;
      this.strokes.clear(exemplar.width, exemplar.height);  // they are in the file now
      this.page.announce(`paint saved in ${this.paintable?.file ?? exemplar.file}`);
      await this.exemplar.renew();
    } catch (error) {
      if (error instanceof CallError && error.status === 409) this.conflict(error);
      else this.page.error(error);
    } finally {
      this.saving = false;
      this.showUndo();
    }
  }

  /** @param {CallError} error */
  conflict(error) {
    byId('conflict-text', HTMLElement).textContent = error.message;
    byId('conflict-reload', HTMLButtonElement).disabled = false;
    byId('conflict-dialog', HTMLDialogElement).showModal();
  }

  /** The strokes stay; the file as it is now lies below them. */
  async reloadBelow() {
    const dialog = byId('conflict-dialog', HTMLDialogElement), {canvas} = this.strokes;
    const exemplar = this.exemplar.current;
    if (!exemplar) {
      dialog.close();
      return;
    }
    try {
      /** @type {Paintable} */
      const now = await getJson('/api/paintable', {exemplar: exemplar.index});
      if (now.ok && (now.width !== canvas.width || now.height !== canvas.height)) {
        byId('conflict-text', HTMLElement).textContent =
            `${now.file} is ${now.width}×${now.height} pixels now, your strokes are ${canvas.width}×${
                canvas.height}, so they cannot lie over it: download the layer, then undo the strokes.`;
        byId('conflict-reload', HTMLButtonElement).disabled = true;
        return;
      }
      dialog.close();
      this.paintable = this.own = now;
      await this.exemplar.renew();
      this.page.announce('the file was read anew; your strokes lie over it');
    } catch (error) {
      dialog.close();
      this.page.error(error);
    }
  }

  async downloadLayer() {
    try {
      download(await pngOf(this.strokes.canvas), 'scumble-layer.png');
    } catch (error) {
      this.page.error(error);
    }
  }
}
