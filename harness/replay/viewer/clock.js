// The time that is shown: it plays, steps and jumps, and calls back at every change.

export class Clock {
  /** From 0 to `end` (s), in frames of `step` (s). `changed` is called whenever the time changes. */
  constructor(changed) {
    this.changed = changed;
    this.time = 0;
    this.end = 0;
    this.step = 1 / 60;
    this.speed = 1;
    this.playing = false;
    this._last = 0;
  }

  load(end, step) {
    this.end = end;
    this.step = step;
    this.time = 0;
    this.playing = false;
  }

  /** Play from here, or from the start if this is the end; or pause. */
  play(wanted) {
    if (wanted && this.time >= this.end) this.time = 0;
    this.playing = wanted && this.end > 0;
    this._last = performance.now();
    this.changed();
  }

  seek(time) {
    this.time = Math.min(this.end, Math.max(0, time));
    this.changed();
  }

  /** To the next frame, or the one before; between frames to the nearest in that direction. */
  stepBy(frames) {
    this.playing = false;
    const exact = this.time / this.step, near = Math.round(exact);
    const on = Math.abs(exact - near) < 1e-6;
    this.seek((on ? near + frames : frames > 0 ? Math.ceil(exact) : Math.floor(exact)) * this.step);
  }

  /** Advance by the time since the last call (`now`, ms), times the speed; stop at the end. */
  tick(now) {
    if (!this.playing) return;
    this.time += (Math.min(now - this._last, 250) / 1000) * this.speed;
    this._last = now;
    if (this.time >= this.end) {
      this.time = this.end;
      this.playing = false;
    }
    this.changed();
  }
}
