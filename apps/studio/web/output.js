// Size, quality, and the random seed of the picture.
import {byId, fillSelect, showNumber} from './dom.js';

/** @typedef {import('./api.js').State} State */

const kSizes =
    ['640×360', '960×540', '1280×720', '1920×1080', '2560×1440', '3840×2160', '720×720', '1080×1080', '1080×1920'];
const kBudgetMs = 50;
const kMostSide = 16384;

export class OutputPanel {
  /** @param {import('./store.js').Store} store */
  constructor(store) {
    this.store = store;
    this.width = byId('size-width', HTMLInputElement);
    this.height = byId('size-height', HTMLInputElement);
    this.preset = byId('size-preset', HTMLSelectElement);
    this.quality = byId('quality', HTMLSelectElement);
    this.budget = byId('budget', HTMLInputElement);
    this.seed = byId('seed', HTMLInputElement);
    for (const input of [this.width, this.height]) input.addEventListener('change', () => this.resize());
    this.preset.addEventListener('change', () => {
      const [width, height] = this.preset.value.split('×').map(Number);
      if (height) void store.patch({size: [width, height]});
    });
    this.quality.addEventListener('change', () => {
      if (this.quality.value === 'budget') void store.patch({budget_ms: Number(this.budget.value) || kBudgetMs});
      else void store.patch({quality: this.quality.value});
    });
    this.budget.addEventListener('change', () => {
      if (this.budget.value && this.budget.validity.valid) void store.patch({budget_ms: Number(this.budget.value)});
    });
    this.seed.addEventListener('change', () => {
      if (this.seed.value && this.seed.validity.valid) void store.patch({seed: Number(this.seed.value)});
    });
    byId('seed-next', HTMLElement).addEventListener('click', () => void store.patch({seed: store.state.seed + 1}));
    fillSelect(this.quality, [{value: 'final', text: 'Final: the style as it is'}, {value: 'preview', text: 'Preview'},
                              {value: 'draft', text: 'Draft'}, {value: 'budget', text: 'Within a budget'}], 'final');
    // Last: what the listeners above refused gives way to what is.
    for (const input of [this.width, this.height, this.budget, this.seed]) {
      for (const event of ['change', 'blur']) input.addEventListener(event, () => this.showRefused(input));
    }
    store.listen((state) => this.update(state));
  }

  resize() {
    const size = [this.width, this.height].map((input) => Math.round(Number(input.value)));
    if (size.some((side) => !(side >= 1 && side <= kMostSide))) return;
    void this.store.patch({size: [size[0], size[1]]});
  }

  /** @param {HTMLInputElement} input a field whose number counts, or was refused */
  showRefused(input) {
    input.dataset.value = '';  // showNumber leaves a number that is being typed alone
    this.update(this.store.state);
  }

  /** @param {State} state */
  update(state) {
    const [width, height] = state.size, own = `${width}×${height}`;
    showNumber(this.width, width);
    showNumber(this.height, height);
    showNumber(this.seed, state.seed);
    if (state.budget_ms) showNumber(this.budget, state.budget_ms);
    const sizes = kSizes.includes(own) ? kSizes : [...kSizes, own];
    fillSelect(this.preset, sizes.map((size) => ({value: size, text: size})), own);
    this.quality.value = state.budget_ms ? 'budget' : state.quality;
    byId('budget-field', HTMLElement).hidden = !state.budget_ms;
  }
}
