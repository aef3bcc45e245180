// Frames of an animation: scrub, play, loop.
import {byId, clamp, fillTrack, showNumber} from './dom.js';

/** @typedef {import('./api.js').State} State */

/**
 * Where no frame is chosen, a .blend is shown at the one that it was saved at.
 * @param {State} state
 */
function shownFrame({animation, frame}) { return frame ?? animation?.saved ?? animation?.first ?? 0; }

export class Timeline {
  /** @param {import('./store.js').Store} store */
  constructor(store) {
    this.store = store;
    this.slider = byId('frame-slider', HTMLInputElement);
    this.number = byId('frame-number', HTMLInputElement);
    this.loop = byId('loop', HTMLInputElement);
    this.playing = false;
    this.from = {frame: 0, time: 0};
    this.slider.addEventListener('input', () => this.go(Number(this.slider.value)));
    this.number.addEventListener('change', () => {
      if (this.number.value) this.go(Math.round(Number(this.number.value)), false);
    });
    this.number.addEventListener('blur', () => this.update(store.state));
    byId('play', HTMLElement).addEventListener('click', () => this.toggle());
    store.listen((state) => this.update(state));
  }

  /** @param {number} frame @param {boolean} [moving] */
  go(frame, moving = true) {
    const span = this.store.state.animation;
    if (!span || !Number.isFinite(frame)) return;
    if (this.playing) this.from = {frame, time: performance.now()};
    void this.store.patch({frame: clamp(frame, span.first, span.last)}, {moving, gesture: 'frame'});
  }

  toggle() {
    const {animation} = this.store.state;
    if (!animation) return;
    this.playing = !this.playing;
    this.show();
    if (!this.playing) return;
    const now = shownFrame(this.store.state), isAtEnd = now >= animation.last;
    this.from = {frame: isAtEnd ? animation.first : now, time: performance.now()};
    requestAnimationFrame(() => this.tick());
  }

  /** Time leads: pictures that come late are left out. */
  tick() {
    const {animation} = this.store.state;
    if (!this.playing) return;
    if (!animation) {
      this.playing = false;
      this.show();
      return;
    }
    const count = animation.last - animation.first + 1;
    const passed = Math.floor((performance.now() - this.from.time) / 1000 * animation.fps);
    let frame = this.from.frame + passed;
    const isPast = frame > animation.last && !this.loop.checked;
    if (isPast) frame = animation.last;
    else if (frame > animation.last) frame = animation.first + (frame - animation.first) % count;
    // One change at a time: the next is sent when the server has taken the last.
    if (!this.store.sending) {
      if (frame !== shownFrame(this.store.state)) {
        void this.store.patch({frame}, {moving: true, gesture: 'play', undoable: false});
      }
      if (isPast) {
        this.playing = false;
        this.show();
      }
    }
    if (this.playing) requestAnimationFrame(() => this.tick());
  }

  show() {
    const button = byId('play', HTMLElement);
    button.setAttribute('aria-pressed', String(this.playing));
    button.setAttribute('aria-label', this.playing ? 'Pause' : 'Play');
    document.getElementById('play-icon')?.setAttribute('href', this.playing ? '#i-pause' : '#i-play');
  }

  /** @param {State} state */
  update(state) {
    const {animation} = state;
    byId('timeline', HTMLElement).hidden = !animation;
    if (!animation) {
      this.playing = false;
      this.show();
      return;
    }
    for (const input of [this.slider, this.number]) {
      input.min = String(animation.first);
      input.max = String(animation.last);
    }
    const now = shownFrame(state);
    this.slider.value = String(now);
    fillTrack(this.slider);
    if (!this.playing || document.activeElement !== this.number) showNumber(this.number, now);
    byId('frame-last', HTMLElement).textContent = `of ${animation.last} · ${Number(animation.fps.toFixed(3))} fps`;
  }
}
