// Small helpers for elements. Text is always set as text: names of objects and files are never markup.

/**
 * The element of this id, of this class.
 * @template {Element} T
 * @param {string} id
 * @param {new () => T} type
 * @returns {T}
 */
export function byId(id, type) {
  const found = document.getElementById(id);
  if (!(found instanceof type)) throw new Error(`the page has no ${type.name} called ${id}`);
  return found;
}

/**
 * A new element with properties, and children that are elements or text.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, unknown>} [properties] names with a dash are attributes
 * @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes('-')) element.setAttribute(name, String(value));
    else Reflect.set(element, name, value);
  }
  element.append(...children);
  return element;
}

/**
 * One of the symbols in index.html.
 * @param {string} name
 */
export function icon(name) {
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  const use = document.createElementNS(space, 'use');
  use.setAttribute('href', `#i-${name}`);
  svg.append(use);
  return svg;
}

/**
 * @param {HTMLCanvasElement} canvas
 * @param {CanvasRenderingContext2DSettings} [settings]
 * @returns {CanvasRenderingContext2D}
 */
export function context(canvas, settings) {
  const found = canvas.getContext('2d', settings);
  if (!found) throw new Error('this browser has no canvas');
  return found;
}

/**
 * A canvas that is not on the page, and what draws on it.
 * @param {number} width
 * @param {number} height
 */
export function scratch(width, height) {
  const canvas = make('canvas', {width, height});
  return {canvas, to: context(canvas)};
}

/**
 * @param {HTMLCanvasElement} canvas
 * @returns {Promise<Blob>} PNG
 */
export function pngOf(canvas) {
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => blob ? resolve(blob) : reject(new Error('the picture is too large')), 'image/png');
  });
}

/**
 * Fills the options of a select, and chooses one. Writes only where something differs: an open list stays open.
 * @param {HTMLSelectElement} select
 * @param {{value: string, text: string}[]} options
 * @param {string} value
 */
export function fillSelect(select, options, value) {
  const signature = JSON.stringify(options);
  if (select.dataset.options !== signature) {
    select.replaceChildren(...options.map((option) => make('option', option)));
    select.dataset.options = signature;
  }
  if (select.value !== value) select.value = value;
}

/**
 * Shows how far a slider has come: its track is filled up to here.
 * @param {HTMLInputElement} slider
 */
export function fillTrack(slider) {
  const least = Number(slider.min || 0), most = Number(slider.max || 100);
  const share = most > least ? (Number(slider.value) - least) / (most - least) : 0;
  slider.style.setProperty('--fill', `${(share * 100).toFixed(2)}%`);
}

/**
 * Shows a number, but leaves one that is being typed until the value changes.
 * @param {HTMLInputElement} input
 * @param {number} value
 */
export function showNumber(input, value) {
  const text = String(value);
  if (document.activeElement !== input || input.dataset.value !== text) input.value = text;
  input.dataset.value = text;
}

/**
 * Whether keys that are typed here belong to the element.
 * @param {EventTarget | null} target
 */
export function isField(target) {
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) return !['checkbox', 'radio', 'button'].includes(target.type);
  return target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement || target.isContentEditable;
}

/**
 * Hands a file to the browser's downloads.
 * @param {Blob} blob
 * @param {string} name
 */
export function download(blob, name) {
  const link = make('a', {href: URL.createObjectURL(blob), download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

/** @param {number} value @param {number} least @param {number} most */
export function clamp(value, least, most) {
  return Math.min(most, Math.max(least, value));
}

/**
 * A number without the noise of its last bits.
 * @param {number} value
 * @param {number} [digits]
 */
export function rounded(value, digits = 3) {
  return Number(value.toFixed(digits));
}
