// Finishing effects over the style: a preset or an effect, and four dials.
import {byId, fillSelect, fillTrack} from './dom.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Finish} Finish */

const kDials = /** @type {const} */ (['lines', 'detail', 'light', 'depth']);
const kAtRest = {lines: 0.5, detail: 0.5, light: 0.5, depth: 0.5};

export class FinishPanel {
  /** @param {import('./store.js').Store} store */
  constructor(store) {
    this.store = store;
    this.name = byId('finish-name', HTMLSelectElement);
    this.dials = byId('finish-dials', HTMLElement);
    this.sliders = kDials.map((dial) => ({dial, input: byId(`dial-${dial}`, HTMLInputElement)}));
    this.name.addEventListener('change', () => {
      const name = this.name.value;
      void store.patch({finish: name ? {...kAtRest, ...store.state.finish, name} : null});
    });
    for (const {dial, input} of this.sliders) {
      input.addEventListener('input', () => {
        const finish = store.state.finish;
        if (!finish) return;
        void store.patch({finish: {...finish, [dial]: Number(input.value)}}, {moving: true, gesture: `dial-${dial}`});
      });
    }
    store.listen((state) => this.update(state));
  }

  /** @param {State} state */
  update(state) {
    const options = state.finishes.map(({name, help}) => ({value: name, text: name, title: help}));
    const none = {value: '', text: "The style's own alone", title: ''};
    fillSelect(this.name, [none, ...options], state.finish?.name ?? '');
    this.dials.hidden = !state.finish;
    for (const {dial, input} of this.sliders) {
      const value = state.finish?.[dial] ?? 0.5;
      input.value = String(value);
      fillTrack(input);
      const output = document.querySelector(`output[for="${input.id}"]`);
      if (output) output.textContent = value.toFixed(2);
    }
  }
}
