// The table of keys: one for what they do and for the help that lists them.
import {byId, isField, make} from './dom.js';

/**
 * @typedef {{group: string, keys: string, does: string, key?: string[], code?: string[], ctrl?: boolean,
 *   shift?: boolean, single?: boolean, isUndo?: boolean, run?: (event: KeyboardEvent) => boolean | void,
 *   release?: () => void}} Shortcut
 * `single`: a key that types a character, which can be switched off; `isUndo`: text fields have their own. `run`
 * answers false where the key is not its. Without `run` the row is for the help alone.
 */

const kStored = 'scumble.letters';

/** @param {Shortcut[]} table */
export function listenToKeys(table) {
  const letters = byId('letters', HTMLInputElement), dialog = byId('help-dialog', HTMLDialogElement);
  letters.checked = stored(kStored) !== 'off';
  letters.addEventListener('change', () => store(kStored, letters.checked ? 'on' : 'off'));
  fillHelp(table);
  byId('help', HTMLElement).addEventListener('click', () => dialog.showModal());
  for (const button of document.querySelectorAll('[data-close]')) {
    button.addEventListener('click', () => button.closest('dialog')?.close());
  }

  document.addEventListener('keydown', (event) => {
    if (event.defaultPrevented || document.querySelector('dialog[open]')) return;
    const shortcut = table.find((row) => row.run && fits(row, event, letters.checked));
    if (shortcut?.run?.(event) === false || !shortcut) return;
    event.preventDefault();
  });
  document.addEventListener('keyup', (event) => {
    for (const row of table) if (row.release && row.key?.includes(event.key.toLowerCase())) row.release();
  });
  addEventListener('blur', () => table.forEach((row) => row.release?.()));
}

/** @param {Shortcut} row @param {KeyboardEvent} event @param {boolean} letters */
function fits(row, event, letters) {
  if (event.altKey || (event.ctrlKey || event.metaKey) !== !!row.ctrl) return false;
  if (row.single && (!letters || isField(event.target))) return false;
  if (!row.ctrl && isField(event.target)) return false;
  if (row.isUndo && isText(event.target)) return false;
  if (row.shift !== undefined && row.shift !== event.shiftKey) return false;
  if (row.code) return row.code.includes(event.code);
  return !event.code.startsWith('Numpad') &&
      !!row.key?.includes(event.key.length === 1 ? event.key.toLowerCase() : event.key);
}

/**
 * Whether it undoes what was typed by itself.
 * @param {EventTarget | null} target
 */
function isText(target) {
  return target instanceof HTMLInputElement && ['text', 'search'].includes(target.type);
}

/** @param {Shortcut[]} table */
function fillHelp(table) {
  const groups = [...new Set(table.map((row) => row.group))].filter((group) => group !== '');
  byId('help-list', HTMLElement).replaceChildren(...groups.map((group) => make('section', {},
      make('h3', {textContent: group}),
      make('dl', {}, ...table.filter((row) => row.group === group).flatMap((row) => [
        make('dt', {}, ...row.keys.split(' / ').flatMap((keys, index) =>
            [...(index ? [' '] : []), make('kbd', {textContent: keys})])),
        make('dd', {textContent: row.does}),
      ])))));
}

/**
 * Whether Space and Enter belong to the element.
 * @param {EventTarget | null} target
 */
export function isPressable(target) {
  return target instanceof Element && !!target.closest('button, summary, a, input, select, [role="slider"]');
}

/** @param {string} name */
export function stored(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null;  // the browser keeps nothing
  }
}

/** @param {string} name @param {string} value */
export function store(name, value) {
  try {
    localStorage.setItem(name, value);
  } catch {
    // it lasts until the page is closed
  }
}
