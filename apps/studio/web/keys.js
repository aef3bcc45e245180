// The keys of the style as controls, made from the one table that the server has of them.
import {byId, clamp, fillTrack, icon, make} from './dom.js';

/** @typedef {import('./api.js').StyleKey} StyleKey */
/** @typedef {import('./api.js').KeyValue} KeyValue */
/** @typedef {import('./api.js').State} State */
/** @typedef {{key: StyleKey, row: HTMLElement, reset: HTMLButtonElement, show: (value: KeyValue) => void}} Control */

// A slider of more steps than this has its small values spread out.
const kMostSteps = 400;

/**
 * "transfer.blend_radius" → "Blend radius"
 * @param {string} name
 */
export function labelOf(name) {
  const last = name.replace(/^transfer\.(guide_weights\.)?/, '').replaceAll('_', ' ');
  return last.startsWith('lpe.') ? last : last[0].toUpperCase() + last.slice(1);
}

/**
 * What the style's file says of this frame, or the default.
 * @param {StyleKey} key
 * @param {State} state
 * @returns {KeyValue}
 */
function fileValue(key, state) {
  return state.file_keys[key.name] ?? key.default ?? (key.kind === 'flag' ? false : key.kind === 'text' ? '' : 0);
}

/**
 * A number as a field shows it: of key frames a line's values between them have many digits.
 * @param {StyleKey} key @param {State} state
 * @returns {KeyValue}
 */
function shownValue(key, state) {
  const value = state.keys[key.name] ?? fileValue(key, state);
  return typeof value === 'number' && key.name in state.key_frames ? Number(value.toPrecision(4)) : value;
}

/**
 * Sliders of wide ranges go by a power of their position.
 * @param {StyleKey} key
 */
export function sliderScale(key) {
  const least = key.least ?? 0, most = key.most ?? 1, step = key.step || 0.01;
  const power = (most - least) / step > kMostSteps && least >= 0 ? ((most - least) / step > 4000 ? 4 : 2) : 1;
  return {
    power,
    toPosition: (/** @type {number} */ value) => (clamp((value - least) / (most - least), 0, 1)) ** (1 / power),
    toValue: (/** @type {number} */ position) => {
      const value = least + position ** power * (most - least);
      return clamp(Number((least + Math.round((value - least) / step) * step).toFixed(6)), least, most);
    },
  };
}

export class KeysPanel {
  /** @param {import('./store.js').Store} store @param {StyleKey[]} keys */
  constructor(store, keys) {
    this.store = store;
    /** @type {Map<string, Control>} */
    this.controls = new Map();
    this.box = byId('keys', HTMLElement);
    this.help = byId('key-help', HTMLElement);
    this.find = byId('keys-find', HTMLInputElement);
    this.only = byId('keys-only', HTMLInputElement);
    this.build(keys.filter((key) => !key.name.startsWith('exemplar.')));
    this.find.addEventListener('input', () => this.filter());
    this.only.addEventListener('change', () => this.filter());
    byId('keys-reset', HTMLElement).addEventListener('click', () => this.resetAll());
    store.listen((state) => this.update(state));
  }

  /** @param {StyleKey[]} keys */
  build(keys) {
    /** @type {Map<string, StyleKey[]>} */
    const groups = new Map();
    for (const key of keys) groups.set(key.group, [...(groups.get(key.group) ?? []), key]);
    const names = [...groups.keys()].sort((a, b) => Number(a === 'Style') - Number(b === 'Style'));
    for (const name of names) {
      const details = make('details', {open: name !== 'Style' && name !== 'Guide weights'});
      details.dataset.group = name;
      const count = make('span', {className: 'note'});
      details.append(make('summary', {}, make('h3', {textContent: name}), count));
      for (const key of groups.get(name) ?? []) details.append(this.row(key));
      this.box.append(details);
    }
  }

  /** @param {StyleKey} key */
  row(key) {
    const id = `key-${key.name}`, help = make('span', {className: 'unseen', id: `${id}-help`, textContent: key.help});
    const row = make('div', {className: 'key'});
    row.dataset.key = key.name;
    const reset = make('button', {type: 'button', className: 'icon', 'aria-label': `Reset ${labelOf(key.name)}`,
                                  title: "Back to the file's"}, icon('reset'));
    reset.addEventListener('click', () => {
      this.change(key, null, false);
      row.querySelector('input, select')?.dispatchEvent(new FocusEvent('focus'));
      /** @type {HTMLElement | null} */ (row.querySelector('input, select'))?.focus();
    });
    const {elements, show} = key.kind === 'number' || key.kind === 'whole' ? this.number(key, id)
                           : key.kind === 'flag' ? this.flag(key, id)
                           : key.kind === 'choice' ? this.choice(key, id) : this.text(key, id);
    elements[elements.length - 1].id = id;
    for (const element of elements) element.setAttribute('aria-describedby', help.id);
    row.classList.toggle('wide', elements.length === 1);
    row.append(make('label', {htmlFor: id, textContent: labelOf(key.name)}), ...elements, reset, help);
    row.addEventListener('pointerenter', () => this.explain(key));
    row.addEventListener('focusin', () => this.explain(key));
    this.controls.set(key.name, {key, row, reset, show});
    return row;
  }

  /** @param {StyleKey} key @param {string} id */
  number(key, id) {
    const scale = sliderScale(key), isLinear = scale.power === 1;
    const step = key.step || (key.kind === 'whole' ? 1 : 0.01);
    const slider = make('input', {type: 'range', min: isLinear ? key.least ?? 0 : 0, max: isLinear ? key.most ?? 1 : 1,
                                  step: isLinear ? step : 'any', 'aria-label': `${labelOf(key.name)}, slider`});
    const number = make('input', {type: 'number', min: key.least ?? '', max: key.unlimited ? '' : key.most ?? '',
                                  step: key.kind === 'whole' ? '1' : 'any'});
    slider.dataset.slider = id;
    slider.addEventListener('input', () => {
      const value = isLinear ? Number(slider.value) : scale.toValue(Number(slider.value));
      this.change(key, value, true);
    });
    slider.addEventListener('keydown', (event) => {
      const direction = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1}[event.key];
      if (isLinear || !direction) return;
      event.preventDefault();
      // The number beside it follows a little later, while keys repeat.
      const now = Number(shownValue(key, this.store.state)) + direction * step;
      this.change(key, clamp(Number(now.toFixed(6)), key.least ?? 0, key.most ?? 1), true);
    });
    number.addEventListener('change', () => {
      const isGood = number.value !== '' && number.validity.valid;
      number.classList.toggle('wrong', !isGood);
      if (isGood) this.change(key, Number(number.value), false);
    });
    number.addEventListener('blur', () => {
      number.classList.remove('wrong');
      this.update(this.store.state);
    });
    /** @param {KeyValue} value */
    const show = (value) => {
      const at = String(isLinear ? value : scale.toPosition(Number(value)));
      if (Number(slider.value) !== Number(at)) slider.value = at;
      slider.setAttribute('aria-valuetext', String(value));
      fillTrack(slider);
      if (document.activeElement !== number || Number(number.value) !== Number(value)) number.value = String(value);
    };
    return {elements: [slider, number], show};
  }

  /** @param {StyleKey} key @param {string} _id */
  flag(key, _id) {
    const input = make('input', {type: 'checkbox'});
    input.addEventListener('change', () => this.change(key, input.checked, false));
    return {elements: [input], show: (/** @type {KeyValue} */ value) => { input.checked = value === true; }};
  }

  /** @param {StyleKey} key @param {string} _id */
  choice(key, _id) {
    const input = make(
        'select', {}, ...(key.choices ?? []).map((choice) => make('option', {value: choice, textContent: choice})));
    input.addEventListener('change', () => this.change(key, input.value, false));
    return {elements: [input], show: (/** @type {KeyValue} */ value) => { input.value = String(value); }};
  }

  /** @param {StyleKey} key @param {string} _id */
  text(key, _id) {
    const input = make('input', {type: 'text', autocomplete: 'off', spellcheck: false});
    input.addEventListener('change', () => this.change(key, input.value, false));
    input.addEventListener('blur', () => this.update(this.store.state));  // what was refused gives way to what is
    /** @param {KeyValue} value */
    const show = (value) => {
      if (document.activeElement !== input) input.value = String(value);
    };
    return {elements: [input], show};
  }

  /** @param {StyleKey} key @param {KeyValue | null} value null: the file's @param {boolean} moving */
  change(key, value, moving) {
    const {state} = this.store;  // a key that changes over time is held by one value, whichever it is
    const isFile = !(key.name in state.key_frames) && value === fileValue(key, state);
    void this.store.patch(
        {keys: {[key.name]: isFile ? null : value}}, {moving, gesture: moving ? `key ${key.name}` : ''});
  }

  resetAll() {
    const keys = Object.fromEntries(Object.keys(this.store.state.keys).map((name) => [name, null]));
    if (Object.keys(keys).length) void this.store.patch({keys});
  }

  /** @param {State} state */
  update(state) {
    /** @type {Record<string, number>} */
    const counts = {};
    for (const {key, row, reset, show} of this.controls.values()) {
      const changed = key.name in state.keys, frames = state.key_frames[key.name];
      row.classList.toggle('changed', changed);
      row.classList.toggle('moves', !!frames && !changed);
      reset.disabled = !changed;
      reset.title = `Back to the file's: ${frames ?? fileValue(key, state)}`;
      show(shownValue(key, state));
      if (changed) counts[key.group] = (counts[key.group] ?? 0) + 1;
    }
    for (const details of this.box.querySelectorAll('details')) {
      const count = counts[details.dataset.group ?? ''] ?? 0;
      const note = details.querySelector('summary .note');
      if (note) note.textContent = count ? `${count} changed` : '';
    }
    const changed = Object.keys(state.keys).length;
    byId('keys-changed', HTMLElement).textContent = changed ? `${changed} changed` : 'as in the file';
    byId('keys-reset', HTMLButtonElement).disabled = changed === 0;
    if (this.only.checked) this.filter();
  }

  filter() {
    const words = this.find.value.trim().toLowerCase();
    const isFiltering = words !== '' || this.only.checked;
    for (const {key, row} of this.controls.values()) {
      const text = `${key.name} ${labelOf(key.name)} ${key.help}`.toLowerCase();
      row.hidden = !text.includes(words) || (this.only.checked && !row.classList.contains('changed'));
    }
    for (const details of this.box.querySelectorAll('details')) {
      const isEmpty = !details.querySelector('.key:not([hidden])');
      details.hidden = isFiltering && isEmpty;
      if (isFiltering && !isEmpty) details.open = true;
    }
  }

  /** @param {StyleKey} key */
  explain(key) {
    const frames = this.store.state.key_frames[key.name];
    const moves = frames ? `; the file changes it over time: ${frames}` : '';
    this.help.replaceChildren(make('b', {textContent: key.name}), ` ${key.help}${moves}`);
  }
}
