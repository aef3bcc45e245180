// Styles for single objects and materials: by a click into the picture, or from two lists.
import {getJson} from './api.js';
import {byId, clamp, fillSelect, icon, make} from './dom.js';
import {thumbnailOf} from './library.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Pick} Pick */

export class Assigner {
  /** @param {import('./store.js').Store} store @param {(text: string) => void} announce */
  constructor(store, announce) {
    this.store = store;
    this.announce = announce;
    this.popover = byId('popover', HTMLElement);
    /** @type {HTMLElement | null} */
    this.cameFrom = null;
    this.listed = '';
    byId('assign-form', HTMLFormElement).addEventListener('submit', (event) => {
      event.preventDefault();
      void this.assign(byId('assign-name', HTMLSelectElement).value, byId('assign-style', HTMLSelectElement).value);
    });
    this.popover.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation();
      this.close();
    });
    this.popover.addEventListener('focusout', (event) => {
      if (event.relatedTarget instanceof Node && !this.popover.contains(event.relatedTarget)) this.close(false);
    });
    document.addEventListener('pointerdown', (event) => {
      if (event.target instanceof Node && !this.popover.contains(event.target)) this.close(false);
    });
    addEventListener('resize', () => this.close(false));
    store.listen((state) => this.update(state));
  }

  /** @param {string} name @param {string | null} style null: as everything else */
  async assign(name, style) {
    if (!name) return;
    const others = this.store.state.assignments.filter((assignment) => assignment.name !== name);
    await this.store.patch({assignments: style === null ? others : [...others, {name, style}]});
    await this.store.rested();
    const now = this.store.state.assignments.find((assignment) => assignment.name === name)?.style ?? null;
    if (now !== style) return;  // it was refused, which the banner says
    this.announce(style === null ? `${name} is painted as everything else` : `${name} in ${style}`);
  }

  /** @param {State} state */
  update(state) {
    const names = [...new Set([...state.objects, ...state.materials])];
    const name = byId('assign-name', HTMLSelectElement), style = byId('assign-style', HTMLSelectElement);
    fillSelect(name, names.map((value) => ({value, text: value})), name.value || names[0] || '');
    fillSelect(
        style, state.styles.map(({id, name: text}) => ({value: id, text})), style.value || state.styles[0]?.id || '');
    const signature = JSON.stringify(state.assignments);
    if (signature === this.listed) return;
    this.listed = signature;
    byId('assignments', HTMLElement).replaceChildren(...state.assignments.map((assignment) => {
      const remove = make('button', {type: 'button', className: 'icon', 'aria-label': `Remove ${assignment.name}`,
                                     title: 'Remove'}, icon('close'));
      remove.addEventListener('click', () => {
        void this.assign(assignment.name, null);
        name.focus();
      });
      return make('li', {}, make('img', {alt: '', src: thumbnailOf('style', assignment.style)}),
                  make('span', {textContent: `${assignment.name} → ${assignment.style}`}), remove);
    }));
  }

  /**
   * Asks what stands at a pixel, and offers styles for it.
   * @param {{x: number, y: number}} pixel @param {{x: number, y: number}} at place of the screen
   */
  async offer(pixel, at) {
    /** @type {Pick} */
    const found = await getJson('/api/pick', pixel);
    if (!found.covered || !found.object) {
      this.close();
      this.announce('nothing stands here');
      return;
    }
    this.open(found, at);
  }

  /** @param {Pick} found @param {{x: number, y: number}} at */
  open(found, at) {
    const state = this.store.state;
    const names = [...new Set([found.object, found.material])].filter((name) => !!name).map(String);
    const title = make('h2', {id: 'popover-title', textContent: 'A style for'});
    const select = make('select', {'aria-label': 'Object or material'},
                        ...names.map((name, index) => make('option', {value: name,
                          textContent: index === 0 ? `object ${name}` : `material ${name}`})));
    const close = make('button', {type: 'button', className: 'icon', 'aria-label': 'Close'}, icon('close'));
    close.addEventListener('click', () => this.close());
    const styles = state.styles.map(({id, name}) => {
      const button = make('button', {type: 'button', className: 'thumb', title: name},
                          make('img', {alt: '', src: thumbnailOf('style', id)}), make('span', {textContent: name}));
      button.dataset.assign = id;
      button.addEventListener('click', () => this.choose(select.value, id));
      return button;
    });
    const none = make('button', {type: 'button', textContent: 'As everything else'});
    const showNone = () => {
      none.hidden = !state.assignments.some((assignment) => assignment.name === select.value);
    };
    none.addEventListener('click', () => this.choose(select.value, null));
    select.addEventListener('change', showNone);
    showNone();
    this.popover.replaceChildren(
        make('div', {className: 'tools'}, title, make('span', {className: 'grow'}, select), close),
        make('div', {className: 'thumbs'}, ...styles), none);
    this.cameFrom = document.activeElement instanceof HTMLElement ? document.activeElement : null;
    this.popover.hidden = false;
    const box = this.popover.getBoundingClientRect();
    this.popover.style.left = `${clamp(at.x + 12, 8, innerWidth - box.width - 8)}px`;
    this.popover.style.top = `${clamp(at.y - 30, 8, innerHeight - box.height - 8)}px`;
    select.focus();
  }

  /** @param {string} name @param {string | null} style */
  choose(name, style) {
    this.close();
    void this.assign(name, style);
  }

  /** @param {boolean} [giveBack] the focus goes to where it came from */
  close(giveBack = true) {
    if (this.popover.hidden) return;
    this.popover.hidden = true;
    if (giveBack) this.cameFrom?.focus();
  }
}
