// The studio's page: what stands where is in index.html; here the parts are made and tied together.
//
// For browser tests, ids and attributes that stay:
//   html          data-revision, data-drawn (draft | final), data-shown: the picture that is on the screen;
//                 data-gone while the server does not answer; data-compare (off | wipe | side | difference | flip);
//                 data-command: the command line that was copied last
//   #picture      the canvas with the picture, in its own pixels; #overlay: masks over it; #stage: takes the pointer
//   #pick #status #problem #problem-text #scene-warnings #gone #timing #busy: what the page says
//   [data-key="transfer.threshold"]: a key's row, .changed where it differs; in it #key-transfer.threshold, the slider
//                 [data-slider], and button.icon, its reset; #keys-reset resets all, #keys-find finds
//   [data-style="oil"] input, [data-scene="snail"] input: choices; #camera #show #compare #beside: selects
//   #size-width #size-height #quality #budget #seed #light-sphere #light-azimuth #light-elevation #light-reset
//   #popover [data-assign="ink"]: a style for what was clicked; #assign-name #assign-style #assign-form #assignments
//   [data-seen="3"] with .restore and [data-side="a"], [data-side="b"]: pictures that were seen; #wipe: the slider
//   #timeline #play #loop #frame-slider #frame-number; #undo #redo #save #save-as #copy-command #download and dialogs
//   #exemplar #exemplar-base #exemplar-layer #exemplar-marks #warnings; #paint #brush-… #paint-save #conflict-dialog
import {CallError, getJson, listen} from './api.js';
import {Assigner} from './assign.js';
import {BrushPanel} from './brush.js';
import {Compare} from './compare.js';
import {byId, fillSelect} from './dom.js';
import {ExemplarPanel} from './exemplar.js';
import {draw, Frames} from './frame.js';
import {keepInHash, lostSettings, readHash, touchHash} from './hash.js';
import {History} from './history.js';
import {Keeper} from './keep.js';
import {KeysPanel, labelOf} from './keys.js';
import {Library} from './library.js';
import {FinishPanel} from './finish.js';
import {LightPanel} from './light.js';
import {keepSteps, keepUnsent, keptSteps, keptUnsent} from './memory.js';
import {announce, announceSoon, showBusy, showError, showGone, showProblem, showWarnings} from './messages.js';
import {OrbitControl} from './orbit.js';
import {OutputPanel} from './output.js';
import {Picker} from './pick.js';
import {shortcutTable} from './shortcut_table.js';
import {listenToKeys} from './shortcuts.js';
import {settingsOf, Store} from './store.js';
import {followTheme} from './theme.js';
import {Timeline} from './timeline.js';
import {showTimes} from './timing.js';
import {View} from './view.js';

/** @typedef {import('./api.js').State} State */

const kShows = ['picture', 'sources', 'chunks', 'borders', 'levels', 'error', 'exemplar', 'styles'];

const kReadSeconds = 8;  // for what is more than a word
const kMostNamed = 2;    // keys, in a line

const root = document.documentElement;
const store = new Store();
const view = new View();
const frames = new Frames(store);
const seen = new History(store);
const kept = readHash();
let hasStarted = false;

/** @param {unknown} error */
function fail(error) {
  showBusy(null);
  showError(error);
  if (error instanceof CallError && error.isGone) lookAnew();
}

/**
 * A picture has come: it is drawn, and told once it is on the screen.
 * @param {import('./frame.js').Picture} picture
 */
function show(picture) {
  draw(view.picture, picture.source);
  const [width, height] = picture.quality === 'final' ? [picture.width, picture.height] : store.state.size;
  view.setSize(width, height);
  showTimes(picture.stages, picture.ms);
  showBusy(null);
  if (!store.state.problem) showProblem(null);
  const tell = () => {
    root.dataset.revision = String(picture.revision);
    root.dataset.drawn = picture.quality;
    root.dataset.shown = picture.show;
  };
  // A hidden page gets no animation frames.
  if (document.hidden) tell();
  else requestAnimationFrame(tell);
  if (picture.quality !== 'final') return;
  announceSoon(`drawn in ${Math.round(picture.ms)} ms`);
  see();
  compare.now(picture.show);
}

/** The strip keeps a final that is the state's. While a change is on its way, the state is already another one. */
function see() {
  const {drawn} = frames;
  const isNow = drawn?.quality === 'final' && drawn.revision === store.state.revision && !store.sending;
  if (isNow && drawn.show === 'picture') seen.see(view.picture, store.state);
  else seen.leave();
}

frames.onPicture = show;
frames.onError = fail;
frames.onBegin = (/** @type {string} */ quality) => {
  if (quality === 'draft') {
    seen.leave();
    picker.clear();
  }
};
store.onError = fail;

const exemplar = new ExemplarPanel(store, showError);
const compare = new Compare(store, view, seen, showError);
const picker =
    new Picker(view, exemplar, () => !frames.isMoving && !frames.running && frames.drawn?.quality === 'final' &&
                                     !compare.isPainting);
const assigner = new Assigner(store, announce);
const orbit = new OrbitControl(store, view, (pixel, at) => void assigner.offer(pixel, at).catch(showError));
const timeline = new Timeline(store);
const keeper = new Keeper(store, {announce, error: showError});
store.onSaved = seen.rebase.bind(seen);
const brush = new BrushPanel(exemplar, {
  announce, error: showError, saveAs: () => keeper.askName(), layout: () => view.layout(),
});
exemplar.onShown = () => void brush.follow();
new OutputPanel(store);
new LightPanel(store);
new FinishPanel(store);
const library = new Library(store);
followTheme();

/** @param {string} what */
function setShow(what) {
  byId('show', HTMLSelectElement).value = what;
  frames.setShow(what);
  touchHash();
}

/** @param {boolean} isUndo */
function step(isUndo) {
  // While one paints, strokes alone are undone.
  const done = brush.canPaint ? (isUndo ? brush.undo() : brush.redo()) : isUndo ? store.undo() : store.redo();
  const more = typeof done === 'object' && done ? aboutStep(done, isUndo) : '';
  if (!done) announce(isUndo ? 'nothing to undo' : 'nothing to do again');
  else announce((isUndo ? 'undone' : 'done again') + more, more ? kReadSeconds : 0);
}

/**
 * What a step meant for saved keys, and for those of other pages.
 * @param {import('./store.js').Taken} step @param {boolean} isUndo
 */
function aboutStep({keys, lost}, isUndo) {
  const {state} = store;
  const label = (/** @type {string} */ name) => labelOf(name).toLowerCase();
  const few = keys.map((name) => `${label(name)} ${state.keys[name]}, saved is ${state.file_keys[name]}`).join('; ');
  const values = keys.length > kMostNamed ? `${keys.length} keys as before the save` : few;
  const others = lost.length > kMostNamed ? `${lost.length} keys` : lost.map(label).join(', ');
  const back = isUndo ? 'redo' : 'undo';
  return (values && `: ${values}`) + (others && `; another page had changed ${others}: ${back} brings that back`);
}

/**
 * What is neither a panel's nor the picture's.
 * @param {State} state
 */
function update(state) {
  const scene = state.scenes.find(({id}) => id === state.scene)?.name ?? state.scene;
  const style = state.styles.find(({id}) => id === state.style)?.name ?? state.style;
  byId('title', HTMLElement).textContent = `${scene} in ${style}`;
  document.title = `${scene} in ${style} · Scumble studio`;
  view.stage.setAttribute('aria-label', `Picture: ${scene} in ${style}`);
  const cameras = [...state.cameras.map((name, index) => ({value: `camera:${index ? name : ''}`, text: name})),
                   ...(state.cameras.length ? [] : [{value: 'camera:', text: 'Framed'}]),
                   ...(state.view ? [{value: 'orbit', text: 'Free view'}] : [])];
  const named = state.camera === state.cameras[0] ? '' : state.camera;
  fillSelect(byId('camera', HTMLSelectElement), cameras, state.view ? 'orbit' : `camera:${named}`);
  byId('undo', HTMLButtonElement).disabled = store.undoSteps.length === 0;
  byId('redo', HTMLButtonElement).disabled = store.redoSteps.length === 0;
  touchHash(state);
}

/** @param {string} name @param {any} data */
async function onEvent(name, data) {
  if (name === 'busy') showBusy(data);
  if (name === 'warnings') showWarnings(data);
  if (name === 'problem') {
    showProblem(data);
    if (!data) frames.renew();
  }
  if (name !== 'state') return;
  const isFiles = data.why === 'files';
  if (isFiles) {
    seen.filesChanged();
    // The picture is ready on the server; all else waits until it is on the screen.
    frames.renew();
    await frames.rested();
    const state = await store.refresh();
    frames.wake();  // a final that was under way already is of the revision before
    if (!state.problem && frames.drawn) showProblem(null);  // the state that it stood in was read before
    see();
    library.renew();
    await exemplar.renew();
    return;
  }
  await store.hear(data.revision);
  frames.wake();  // the page may know the revision already
  if (data.why === 'saved') await exemplar.check(0, exemplar.shown);
}

/** The server is there: at the beginning, again, or the page is looked at again. */
async function onFound() {
  const before = store.known, wasGone = root.hasAttribute('data-gone');
  const known = before ? {run: before.run, first: before.first, settings: settingsOf(before)} : kept;
  const state = await store.refresh();
  showGone(null);
  showProblem(state.problem);
  showWarnings(state.warnings);
  if (!hasStarted) await start();
  const lost = known && lostSettings(state, known);
  // The page was reloaded before the server had answered.
  const unsent = before ? null : keptUnsent(state.run);
  const missing = lost || unsent;
  if (missing) await store.patch(missing, {undoable: false});
  if (wasGone || lost) frames.renew();
  else frames.wake();
  if (before) await exemplar.renew();
}

/** What needs the state, once. */
async function start() {
  const answer = await getJson('/api/keys');
  hasStarted = true;
  new KeysPanel(store, answer.keys ?? answer);
  fillSelect(
      byId('show', HTMLSelectElement),
      kShows.map((what) => ({value: what, text: what[0].toUpperCase() + what.slice(1)})), 'picture');
  byId('show', HTMLSelectElement).addEventListener('change', () => setShow(byId('show', HTMLSelectElement).value));
  byId('camera', HTMLSelectElement).addEventListener('change', () => {
    const value = byId('camera', HTMLSelectElement).value;
    if (value !== 'orbit') void store.patch({camera: value.slice('camera:'.length), view: null});
  });
  byId('undo', HTMLElement).addEventListener('click', () => step(true));
  byId('redo', HTMLElement).addEventListener('click', () => step(false));
  byId('problem-close', HTMLElement).addEventListener('click', () => showProblem(null));
  byId('scene-warnings-close', HTMLElement).addEventListener('click', () => {
    byId('scene-warnings', HTMLElement).hidden = true;
  });
  listenToKeys(
      shortcutTable({view, orbit, compare, timeline, keeper, brush, assigner, picker, shows: kShows, setShow, step}));
  const run = JSON.stringify(store.state.first), steps = keptSteps(run);
  store.undoSteps = steps.undo;
  store.redoSteps = steps.redo;
  if (steps.server === store.state.run) store.heard = steps.heard;
  addEventListener('pagehide',
                   () => keepSteps(run, store.undoSteps, store.redoSteps, store.state.run, store.heard));
  // Earlier than that: what is on its way is given up in between.
  addEventListener('beforeunload', () => keepUnsent(store.state.run, store.unsent));
  seen.remember();
  store.hearSaves(store.state.saves);  // those while the page was not there
  restorePage();
  store.listen(update);
}

/** The page's own state: zoom, what is shown, the comparison. */
function restorePage() {
  const page = kept?.page ?? {};
  if (typeof page.zoom === 'number') {
    view.zoom = page.zoom;
    if (Array.isArray(page.centre)) view.centre = page.centre.map(Number);
  }
  if (kShows.includes(page.show)) {
    frames.show = page.show;
    byId('show', HTMLSelectElement).value = page.show;
  }
  compare.restore(page.compare);
  keepInHash('zoom', () => view.zoom ?? undefined);
  keepInHash('centre', () => view.zoom === null ? undefined : view.centre.map((at) => Number(at.toFixed(4))));
  keepInHash('show', () => frames.show === 'picture' ? undefined : frames.show);
  keepInHash('compare', () => compare.kept());
  view.listeners.push(() => touchHash());
  compare.onChange = () => touchHash();
}

const lookAnew = listen({
  event: (name, data) => void onEvent(name, data).catch(showError), lost: showGone, found: onFound,
});
