// What this tab keeps over a reload: pictures that were seen, in the browser's database, and the steps of undo.

/** @typedef {import('./api.js').Changes} Changes */
/** @typedef {import('./store.js').Step} Step */
/** @typedef {{id: number, settings: Changes, signature: string, label: string, picture: Blob}} SeenPicture */

const kName = 'scumble', kPictures = 'seen', kUndo = 'scumble-undo', kTab = 'scumble-tab';
const kLongest = 24 * 3600 * 1000;  // ms that a closed tab's pictures are kept

const tab = sessionStorage.getItem(kTab) ?? crypto.randomUUID();
sessionStorage.setItem(kTab, tab);

/**
 * @template T
 * @param {IDBRequest<T>} request
 * @returns {Promise<T>}
 */
function done(request) {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

/** @type {Promise<IDBDatabase> | null} */
let opened = null;

/** @param {IDBTransactionMode} mode */
async function pictures(mode) {
  if (!opened) {
    const request = indexedDB.open(kName, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(kPictures, {keyPath: ['tab', 'id']});
    opened = done(request);
  }
  return (await opened).transaction(kPictures, mode).objectStore(kPictures);
}

/** @param {SeenPicture} seen */
export async function keepPicture(seen) {
  try {
    await done((await pictures('readwrite')).put({...seen, tab, time: Date.now()}));
  } catch {
    // A private window may keep nothing: the strip is as long as the page then.
  }
}

/** @param {number} id */
export async function dropPicture(id) {
  try {
    await done((await pictures('readwrite')).delete([tab, id]));
  } catch {
    // It was not kept.
  }
}

/** @returns {Promise<SeenPicture[]>} those of this tab, the oldest first */
export async function keptPictures() {
  try {
    const all = await done((await pictures('readonly')).getAll());
    const old = all.filter((one) => one.tab !== tab && Date.now() - one.time > kLongest);
    for (const one of old) await done((await pictures('readwrite')).delete([one.tab, one.id]));
    return all.filter((one) => one.tab === tab);
  } catch {
    return [];
  }
}

/**
 * @param {string} run which studio it is
 * @param {Step[]} undo @param {Step[]} redo
 */
export function keepSteps(run, undo, redo) {
  sessionStorage.setItem(kUndo, JSON.stringify({run, undo, redo}));
}

/**
 * @param {string} run
 * @returns {{undo: Step[], redo: Step[]}}
 */
export function keptSteps(run) {
  try {
    const kept = JSON.parse(sessionStorage.getItem(kUndo) ?? '{}');
    return kept.run === run ? {undo: kept.undo, redo: kept.redo} : {undo: [], redo: []};
  } catch {
    return {undo: [], redo: []};
  }
}
