// The state of the server as this page knows it, changes on their way to it, and undo.
import {call, getJson} from './api.js';

/** @typedef {import('./api.js').State} State */
/** @typedef {import('./api.js').Changes} Changes */
/** @typedef {import('./api.js').Save} Save */
/** @typedef {{before: Changes, after: Changes, style: string, gesture: string, time: number, saved?: boolean}} Step
 *   style: that was chosen before it; saved: keys of it were written into the style's file since */
/** @typedef {{keys: string[], lost: string[]}} Taken
 *   of a step that was undone or done again. keys: those that differ from the file now, if keys of the step were saved;
 *   lost: those whose values came from another page */

// Changes of one gesture, such as a slider's drag, are undone together.
const kGestureMs = 900;
const kMostSteps = 200;
const kFollowMs = 200;
// What a change of the scene or of the style resets, and undo brings back.
const kOfScene = /** @type {const} */ (['camera', 'view', 'light', 'frame', 'assignments']);

/**
 * The state after changes, as far as the page can tell before the server answers.
 * @param {State} state @param {Changes} changes @returns {State}
 */
export function applied(state, changes) {
  const {keys, ...rest} = changes;
  const next = /** @type {State} */ ({...state, ...rest});
  if (changes.scene !== undefined && changes.scene !== state.scene) {
    Object.assign(next, {camera: '', view: null, light: null, assignments: [], ...rest});
  }
  if (changes.style !== undefined && changes.style !== state.style) next.keys = {};
  if (keys) {
    next.keys = {...next.keys};
    for (const [name, value] of Object.entries(keys)) {
      if (value === null) delete next.keys[name];
      else next.keys[name] = value;
    }
  }
  if (changes.view) next.eye = {...state.eye, ...changes.view, distance: changes.view.distance || state.eye.distance};
  if (changes.budget_ms) next.quality = 'final';
  if (changes.quality !== undefined && changes.budget_ms === undefined) next.budget_ms = 0;
  return next;
}

/**
 * What undoes changes.
 * @param {State} state
 * @param {Changes} changes
 * @returns {Changes}
 */
export function inverse(state, changes) {
  const fields = new Set(/** @type {(keyof Changes)[]} */ (Object.keys(changes)));
  if (fields.has('scene')) kOfScene.forEach((field) => fields.add(field));
  if (fields.has('quality') || fields.has('budget_ms')) {
    fields.delete('quality');
    fields.add(state.budget_ms ? 'budget_ms' : 'quality');
  }
  /** @type {Changes} */
  const before = {};
  for (const field of fields) if (field !== 'keys') Object.assign(before, {[field]: state[field]});
  if (!state.budget_ms) delete before.budget_ms;
  if (changes.style !== undefined && changes.style !== state.style) {
    before.keys = {...state.keys};
  } else if (changes.keys) {
    before.keys = Object.fromEntries(Object.keys(changes.keys).map((name) => [name, state.keys[name] ?? null]));
  }
  return before;
}

/**
 * All that a patch can set, to come back to it.
 * @param {State} state
 * @returns {Changes}
 */
export function settingsOf(state) {
  const {scene, style, keys, assignments, camera, view, light, finish, frame, size, seed, quality, budget_ms} =
      state;
  /** @type {Changes} */
  const settings = {scene, style, keys: {...keys}, assignments, camera, view, light, finish, frame, size, seed};
  if (budget_ms) settings.budget_ms = budget_ms;
  else settings.quality = quality;
  return settings;
}

/**
 * Changed keys, null as the file has it, for a file into which keys were saved.
 * @param {Step} step @param {Changes['keys']} keys one side of the step
 * @param {Record<string, any>} saved @param {Record<string, any>} before
 */
function rebaseKeys(step, keys, saved, before) {
  for (const name of Object.keys(saved)) {
    if (!keys || !(name in keys)) continue;
    step.saved = true;
    if (keys[name] === null) keys[name] = before[name];
    else if (keys[name] === saved[name]) keys[name] = null;
  }
}

export class Store {
  constructor() {
    /** @type {State | null} */
    this.known = null;
    /** @type {((state: State) => void)[]} */
    this.listeners = [];
    /** @type {(error: unknown) => void} */
    this.onError = () => {};
    /** @type {(moving: boolean) => void} */
    this.onSent = () => {};
    /** @type {(style: string, saved: Record<string, any>, before: Record<string, any>) => void} as rebase has them */
    this.onSaved = () => {};
    this.heard = 0;  // the number of the newest save that undo has followed
    /** @type {{changes: Changes, moving: boolean, step: Step | null}[]} */
    this.queue = [];
    this.sending = false;
    /** @type {Changes | null} */
    this.onItsWay = null;
    this.sent = 0;  // changes that were answered
    this.following = 0;  // a timer
    this.told = 0;  // the newest revision that an event has named
    /** @type {Step[]} */
    this.undoSteps = [];
    /** @type {Step[]} */
    this.redoSteps = [];
  }

  /** @returns {State} */
  get state() {
    if (!this.known) throw new Error('the state has not been read yet');
    return this.known;
  }

  /** @param {(state: State) => void} listener called now, if there is a state, and after each change */
  listen(listener) {
    this.listeners.push(listener);
    if (this.known) listener(this.known);
  }

  /**
   * @param {State} state
   * @param {boolean} [moving] panels follow a little later: while something is dragged, the picture comes first
   */
  set(state, moving = false) {
    this.known = state;
    if (moving) {
      this.following ||= setTimeout(() => this.set(this.state), kFollowMs);
      return;
    }
    clearTimeout(this.following);
    this.following = 0;
    for (const listener of this.listeners) listener(state);
  }

  /**
   * Changes the state, here at once and on the server as soon as it has taken the change before.
   * @param {Changes} changes
   * @param {{moving?: boolean, gesture?: string, undoable?: boolean}} [how] moving: more will follow soon, drafts will
   *   do; gesture: changes with this name are one step of undo
   */
  patch(changes, how = {}) {
    const {moving = false, gesture = '', undoable = true} = how;
    const sent = structuredClone(changes);  // a save changes steps of undo, and nothing that is on its way
    const step = undoable ? this.remember(changes, gesture) : null;
    this.set(applied(this.state, changes), moving);
    const last = this.queue[this.queue.length - 1];
    if (last && !('scene' in changes) && !('style' in changes)) {
      // Quality and budget clear each other: the later one alone is sent.
      if ('quality' in changes) delete last.changes.budget_ms;
      if ('budget_ms' in changes) delete last.changes.quality;
      const keys = {...last.changes.keys, ...sent.keys};
      Object.assign(last.changes, sent);
      if (Object.keys(keys).length) last.changes.keys = keys;
      last.moving = moving;
      last.step = step ?? last.step;
    } else {
      this.queue.push({changes: sent, moving, step});
    }
    return this.send();
  }

  /** @param {Changes} changes @param {string} gesture */
  remember(changes, gesture) {
    const time = performance.now();
    const last = this.undoSteps[this.undoSteps.length - 1];
    const before = inverse(this.state, changes);
    if (gesture && last?.gesture === gesture && time - last.time < kGestureMs) {
      const keys = {...last.after.keys, ...changes.keys};
      last.after = {...last.after, ...changes, ...(changes.keys && {keys})};
      const keysBefore = {...before.keys, ...last.before.keys};
      last.before = {...before, ...last.before, ...(before.keys && {keys: keysBefore})};
      last.time = time;
    } else {
      this.undoSteps.push({before, after: structuredClone(changes), style: this.state.style, gesture, time});
      if (this.undoSteps.length > kMostSteps) this.undoSteps.shift();
    }
    this.redoSteps = [];
    return this.undoSteps[this.undoSteps.length - 1];
  }

  /** @param {Changes} settings */
  restore(settings) { return this.patch(this.changesTo(settings)); }

  /**
   * What brings these settings about: keys that they do not name are the file's again.
   * @param {Changes} settings
   */
  changesTo(settings) {
    const changes = structuredClone(settings);
    if (changes.style === this.state.style) {
      const others = Object.keys(this.state.keys).filter((name) => !(name in (settings.keys ?? {})));
      changes.keys = {...Object.fromEntries(others.map((name) => [name, null])), ...changes.keys};
    }
    return changes;
  }

  /**
   * Keys were written into the style's file: "as the file has it" is another value now, in what undo and redo bring
   * back.
   * @param {string} style
   * @param {Record<string, any>} saved the keys, as they were changed
   * @param {Record<string, any>} before the values in the file until now
   */
  rebase(style, saved, before) {
    for (const step of [...this.undoSteps, ...this.redoSteps]) {
      for (const changes of [step.before, step.after]) {
        if ((changes.style ?? step.style) === style) rebaseKeys(step, changes.keys, saved, before);
      }
    }
  }

  /**
   * The style was saved under another name, which is chosen now: the newest steps, back to a choice of a style, are
   * taken back in the copy.
   * @param {Record<string, any>} saved @param {Record<string, any>} before as rebase has them
   * @param {string} copy
   */
  moveTo(copy, saved, before) {
    for (const steps of [this.undoSteps, this.redoSteps]) {
      for (const step of [...steps].reverse()) {
        if (step.before.style !== undefined || step.after.style !== undefined) break;
        step.style = copy;
        for (const {keys} of [step.before, step.after]) rebaseKeys(step, keys, saved, before);
      }
    }
  }

  /**
   * The style was saved under another name, which is chosen now: undo chooses the one before, with its changed keys.
   * @param {string} copy @param {string} style @param {Record<string, any>} keys
   */
  wentTo(copy, style, keys) {
    const before = {style, keys: {...keys}}, after = {style: copy};
    this.undoSteps.push({before, after, style, gesture: '', time: performance.now()});
    this.redoSteps = [];
    this.set(this.state);
  }

  /**
   * Follows what this page or another one has saved since, by the server's own list. The states alone do not say it: a
   * change may be on its way between two of them.
   * @param {Save[]} saves
   */
  hearSaves(saves) {
    for (const {number, style, from, keys, before, had_frames: hadFrames} of saves) {
      if (number <= this.heard) continue;
      this.heard = number;
      if (style === from) {
        this.rebase(style, keys, before);
        this.onSaved(style, keys, before);
      } else if (hadFrames) {
        this.wentTo(style, from, keys);  // one value cannot bring a key's frames back
      } else {
        this.moveTo(style, keys, before);
      }
    }
  }

  /** @param {State} answer of the server, before it is shown */
  take(answer) {
    if (this.known?.run === answer.run) this.hearSaves(answer.saves);
    else this.heard = answer.saves[answer.saves.length - 1]?.number ?? 0;
  }

  /** @returns {Changes | undefined} what the server has not answered: if the page goes now, it may be lost */
  get unsent() {
    const waiting = [this.onItsWay ?? {}, ...this.queue.map(({changes}) => changes)];
    const keys = Object.assign({}, ...waiting.map((changes) => changes.keys ?? {}));
    const all = Object.assign({}, ...waiting, Object.keys(keys).length ? {keys} : {});
    return Object.keys(all).length ? all : undefined;
  }

  /** Waits until no change is on its way. */
  async rested() {
    while (this.sending) await new Promise((resolve) => setTimeout(resolve, 20));
  }

  undo() { return this.move(this.undoSteps, this.redoSteps, 'before', 'after'); }

  redo() { return this.move(this.redoSteps, this.undoSteps, 'after', 'before'); }

  /**
   * Takes the newest step. The way back leads to what the page shows now, whoever has set it.
   * @param {Step[]} from @param {Step[]} to
   * @param {'before' | 'after'} side that is brought about @param {'before' | 'after'} other
   * @returns {Taken | null} null: there is no step
   */
  move(from, to, side, other) {
    const step = from.pop();
    if (!step) return null;
    const changes = structuredClone(step[side]), shown = inverse(this.state, changes);
    const left = step[other].keys ?? {}, now = shown.keys ?? {};
    const files = this.state.file_keys;
    const lost = Object.keys({...left, ...now})
        .filter((name) => (left[name] ?? files[name]) !== (now[name] ?? files[name]));
    to.push({...step, [other]: shown, gesture: ''});
    void this.patch(changes, {undoable: false});
    return {keys: step.saved ? Object.keys(changes.keys ?? {}).filter((name) => name in this.state.keys) : [], lost};
  }

  async send() {
    if (this.sending) return;
    this.sending = true;
    let next = this.queue.shift();
    try {
      for (; next; next = this.queue.shift()) {
        this.onItsWay = next.changes;
        /** @type {State} */
        const answer = await (await call('PATCH', '/api/state', {json: next.changes})).json();
        this.sent++;
        this.take(answer);
        this.set(this.queue.reduce((state, waiting) => applied(state, waiting.changes), answer), next.moving);
        this.onSent(next.moving);
      }
    } catch (error) {
      // All or nothing: what was shown before the answer is taken back.
      const failed = [next, ...this.queue].map((sent) => sent?.step);
      this.undoSteps = this.undoSteps.filter((step) => !failed.includes(step));
      this.queue = [];
      this.onError(error);
      this.sending = false;
      await this.refresh().catch(this.onError);
    } finally {
      this.sending = false;
      this.onItsWay = null;
    }
    await this.hear(this.told).catch(this.onError);
  }

  /**
   * The server has this revision. Our own changes bring theirs with their answers, so that is waited for.
   * @param {number} revision
   */
  async hear(revision) {
    this.told = Math.max(this.told, revision);
    if (this.sending || this.told <= this.state.revision) return;
    await this.refresh();
    this.told = 0;
    this.onSent(false);
  }

  /** Reads the state anew. */
  async refresh() {
    const {sent} = this;
    /** @type {State} */
    const answer = await getJson('/api/state');
    this.take(answer);
    // A change that is on its way is not in this answer, but will be in its own; one that overtook it is not in it.
    const isOld = sent !== this.sent && answer.revision < this.state.revision;
    if (!this.sending && !isOld) this.set(answer);
    return answer;
  }
}
