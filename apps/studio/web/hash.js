// The page's own state, and the settings of the server's, in the address: a reload loses nothing, nor does a server
// that was started anew.
import {settingsOf} from './store.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Changes} Changes */
/**
 * @typedef {{revision: number, run?: string, first?: State['first'], settings: Changes,
 *   page: Record<string, any>}} Kept
 */

/** @type {Record<string, () => unknown>} */
const parts = {};
let timer = 0;
/** @type {State | null} */
let state = null;

/** @returns {Kept | null} what the address holds; null where it holds nothing that can be read */
export function readHash() {
  try {
    const kept = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    return kept && typeof kept.revision === 'number' ? {page: {}, settings: {}, ...kept} : null;
  } catch {
    return null;
  }
}

/** @param {string} name @param {() => unknown} value undefined: as at the beginning, not written */
export function keepInHash(name, value) {
  parts[name] = value;
}

/**
 * Writes the address soon: browsers slow down pages that change it often.
 * @param {State} [now]
 */
export function touchHash(now) {
  if (now) state = now;
  if (timer || !state) return;
  timer = setTimeout(() => {
    timer = 0;
    write();
  }, 250);
}

function write() {
  if (!state) return;
  /** @type {Record<string, unknown>} */
  const page = {};
  for (const [name, value] of Object.entries(parts)) {
    const now = value();
    if (now !== undefined) page[name] = now;
  }
  const kept = {revision: state.revision, run: state.run, first: state.first, settings: settingsOf(state), page};
  history.replaceState(null, '', `#${encodeURIComponent(JSON.stringify(kept))}`);
}

addEventListener('pagehide', write);

/**
 * Settings that a server which was started anew lacks, as far as it can have them. One that was started with another
 * scene, style or option is meant to show that, and so is one that another page has changed since.
 * @param {State} now @param {{run?: string, first?: State['first'], settings: Changes}} kept
 * @returns {Changes | null}
 */
export function lostSettings(now, kept) {
  if (now.run === kept.run || !now.as_started || JSON.stringify(now.first) !== JSON.stringify(kept.first)) return null;
  const settings = {...kept.settings};
  if (!now.scenes.some((scene) => scene.id === settings.scene)) {
    for (const field of /** @type {const} */ (['scene', 'camera', 'view', 'frame', 'assignments']))
      delete settings[field];
  }
  if (!now.styles.some((style) => style.id === settings.style)) {
    delete settings.style;
    delete settings.keys;
  }
  settings.assignments = settings.assignments?.filter(
      (assignment) => now.styles.some((style) => style.id === assignment.style));
  return settings;
}
