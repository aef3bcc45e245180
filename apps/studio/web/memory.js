// What this tab keeps over a reload, in its session storage: thumbnails and settings of what was seen, and the steps of
// undo. The browser deletes it with the tab.

/** @typedef {import('./api.js').Changes} Changes */
/** @typedef {import('./store.js').Step} Step */
/** @typedef {{id: number, settings: Changes, signature: string, label: string, thumbnail: string,
 *   pixels: number}} SeenPicture
 *   thumbnail: a data URL; pixels: a hash of them */

const kSeen = 'scumble-seen', kUndo = 'scumble-undo', kUnsent = 'scumble-unsent';

/** @param {string} name @param {unknown} value */
function write(name, value) {
  try {
    sessionStorage.setItem(name, JSON.stringify(value));
  } catch {
    // There is no room: a reload brings back what was kept before.
  }
}

/** @param {string} name @returns {any} */
function read(name) {
  try {
    return JSON.parse(sessionStorage.getItem(name) ?? 'null');
  } catch {
    return null;
  }
}

/** @param {SeenPicture[]} seen */
export const keepSeen = (seen) => write(kSeen, seen);

/** @returns {SeenPicture[]} the oldest first */
export const keptSeen = () => read(kSeen) ?? [];

/**
 * @param {string} run which studio it is @param {Step[]} undo @param {Step[]} redo
 * @param {string} server its own run @param {number} heard the newest save there that the steps have followed
 */
export const keepSteps = (run, undo, redo, server, heard) => write(kUndo, {run, undo, redo, server, heard});

/** @param {string} run @returns {{undo: Step[], redo: Step[], server?: string, heard: number}} */
export function keptSteps(run) {
  const kept = read(kUndo);
  if (kept?.run !== run) return {undo: [], redo: [], heard: 0};
  // Times are those of the page before: no gesture goes on.
  const steps = (/** @type {Step[]} */ of) => of.map((step) => ({...step, gesture: ''}));
  return {undo: steps(kept.undo), redo: steps(kept.redo), server: kept.server, heard: kept.heard ?? 0};
}

/** @param {string} run of the server @param {Changes | undefined} changes */
export const keepUnsent = (run, changes) => write(kUnsent, {run, changes});

/** @param {string} run @returns {Changes | null} */
export function keptUnsent(run) {
  const kept = read(kUnsent);
  return kept?.run === run && kept.changes ? kept.changes : null;
}
