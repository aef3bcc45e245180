// Styles and scenes to choose from, with thumbnails.
import {withQuery} from './api.js';
import {byId, make} from './dom.js';

/** @typedef {import('./api.js').State} State */

let version = 0;  // of the styles' files: browsers ask again for another address alone

/** @param {'style' | 'scene'} kind @param {string} id */
export function thumbnailOf(kind, id) {
  return withQuery('/api/thumbnail', {[kind]: id, ...(kind === 'style' && version && {version})});
}

export class Library {
  /** @param {import('./store.js').Store} store */
  constructor(store) {
    this.store = store;
    for (const kind of /** @type {const} */ (['style', 'scene'])) this.show(kind);
  }

  /** Files changed on the disk: styles that are not bundled may look different. */
  renew() {
    version++;
    for (const {id, bundled} of this.store.state.styles) {
      const image = bundled ? null : document.querySelector(`[data-style="${CSS.escape(id)}"] img`);
      if (image instanceof HTMLImageElement) image.src = thumbnailOf('style', id);
    }
  }

  /** @param {'style' | 'scene'} kind */
  show(kind) {
    const {store} = this;
    const box = byId(`${kind}s`, HTMLElement);
    let built = '';
    box.addEventListener('change', (event) => {
      if (event.target instanceof HTMLInputElement) void store.patch({[kind]: event.target.value});
    });
    store.listen((state) => {
      const list = kind === 'style' ? state.styles : state.scenes;
      const signature = JSON.stringify(list.map(({id, name}) => [id, name]));
      if (signature !== built) box.replaceChildren(...list.map(({id, name}) => choice(kind, id, name)));
      built = signature;
      for (const input of box.querySelectorAll('input')) input.checked = input.value === state[kind];
    });
  }
}

/** @param {'style' | 'scene'} kind @param {string} id @param {string} name */
function choice(kind, id, name) {
  const input = make('input', {type: 'radio', name: kind, value: id, 'aria-label': name});
  const image = make('img', {alt: '', loading: 'lazy', src: thumbnailOf(kind, id), draggable: false});
  const label = make('label', {className: 'thumb', title: name}, input, image, make('span', {textContent: name}));
  label.dataset[kind] = id;
  return label;
}
