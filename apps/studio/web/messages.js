// What the page says: a line that is read aloud, problems that stay until they are gone, and work that takes long.
import {byId} from './dom.js';
import {CallError, isAbort} from './api.js';

/** @typedef {import('./api.js').Problem} Problem */

const kStranger = 'The studio was started anew. Open the address that it printed in the terminal.';
const kGone = 'The studio does not answer. The last picture stays; the page goes on by itself once the studio runs.';

let timer = 0;
let stays = 0;  // the time until which announceSoon does not take the place of what was said

/** @param {string} text @param {number} [seconds] how long it stays at least */
export function announce(text, seconds = 0) {
  clearTimeout(timer);
  stays = performance.now() + 1000 * seconds;
  byId('status', HTMLElement).textContent = text;
}

/**
 * Says so later, unless something else is said: what changes many times a second is not read aloud each time.
 * @param {string} text
 */
export function announceSoon(text) {
  if (performance.now() < stays) return;
  clearTimeout(timer);
  timer = setTimeout(() => announce(text), 60);
}

/** @param {Problem | null} problem */
export function showProblem(problem) {
  const banner = byId('problem', HTMLElement), text = problem?.message ?? '';
  // Written anew only where it differs: a live region is read at each writing.
  if (byId('problem-text', HTMLElement).textContent !== text) byId('problem-text', HTMLElement).textContent = text;
  banner.hidden = !problem;
}

/** @param {string[]} warnings of the scene, as the command line says them; those that were hidden stay so */
export function showWarnings(warnings) {
  const banner = byId('scene-warnings', HTMLElement), text = warnings.join('\n');
  if (byId('scene-warnings-text', HTMLElement).textContent === text) return;
  byId('scene-warnings-text', HTMLElement).textContent = text;
  banner.hidden = !text;
}

/** @param {unknown} error */
export function showError(error) {
  if (isAbort(error)) return;
  if (error instanceof CallError && error.status === 401) showGone(error);
  else if (error instanceof CallError && error.isGone) showGone(error);
  else showProblem({kind: 'input', message: error instanceof Error ? error.message : String(error)});
}

/** @param {unknown} error null: the server is there */
export function showGone(error) {
  const banner = byId('gone', HTMLElement);
  const isStranger = error instanceof CallError && error.status === 401;
  const text = !error ? '' : isStranger ? kStranger : kGone;
  if (byId('gone-text', HTMLElement).textContent !== text) byId('gone-text', HTMLElement).textContent = text;
  banner.hidden = !error;
  document.documentElement.toggleAttribute('data-gone', !!error);
}

/** @param {{label: string, share: number} | null} busy */
export function showBusy(busy) {
  byId('busy', HTMLElement).hidden = !busy || busy.share >= 1;
  if (!busy) return;
  byId('busy-label', HTMLElement).textContent = busy.label;
  const bar = byId('busy-share', HTMLProgressElement);
  if (busy.share > 0) bar.value = busy.share;
  else bar.removeAttribute('value');
}
