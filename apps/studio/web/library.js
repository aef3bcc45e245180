// Styles and scenes to choose from, with thumbnails.
import {withQuery} from './api.js';
import {byId, make} from './dom.js';

/** @typedef {import('./api.js').State} State */

/** @param {'style' | 'scene'} kind @param {string} id */
export function thumbnailOf(kind, id) {
  return withQuery('/api/thumbnail', {[kind]: id});
}

/**
 * @param {import('./store.js').Store} store
 */
export function showLibrary(store) {
  for (const kind of /** @type {const} */ (['style', 'scene'])) {
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
