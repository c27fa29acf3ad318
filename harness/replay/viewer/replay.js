// The replay: what is on the page, and how a time, a choice or a key changes it.

import { Camera, bodyUnder, controlCamera } from "./camera.js";
import { Clock } from "./clock.js";
import { HitList } from "./hitlist.js";
import { cross, unit } from "./matrix.js";
import { Stage } from "./stage.js";
import { Timeline } from "./timeline.js";

const SHOWN_FOR = 0.3; // s, at speed 1, for which a hit can be seen
const RING = 32; // pieces of a circle
const RING_SIZE = 0.16; // its radius, of the size of the smaller body
const AHEAD = 400; // legs of a path drawn at the most
const NAMES = ["page", "panel", "ink", "edge", "plain", "met", "wall", "chosen", "halo", "near"];
const by = (id) => document.getElementById(id);

export class Replay {
  constructor() {
    this.camera = new Camera();
    this.clock = new Clock(() => this._requestDraw());
    this.timeline = new Timeline(by("timeline"));
    this.list = new HitList(by("hits"), (hit) => this.goTo(this.recording.hit_times[hit], this.recording.nameOf(hit)));
    this.chosen = -1;
    this.canvas = by("stage");
    try {
      this.stage = new Stage(this.canvas);
      document.documentElement.classList.add("drawn");
      controlCamera(this.canvas, this.camera, () => this._requestDraw(), (x, y) => this._pick(x, y));
    } catch (error) {
      by("nothing").hidden = false;
    }
    this._colours();
    this._listen();
  }

  /** Show a recording, from its start. */
  show(recording) {
    this.recording = recording;
    this.clock.load(recording.duration, recording.step);
    this.timeline.load(recording);
    if (this.stage) this.stage.load(recording);
    by("time").max = recording.duration;
    by("time").step = "any";
    by("body").max = recording.count - 1;
    by("key-near").hidden = !recording.near_frames;
    by("key-ring").hidden = !recording.hit_points;
    // where it was asked which bodies are near, an event is that two come near
    for (const element of document.querySelectorAll("[data-near]")) {
      element.dataset.plain ??= element.textContent;
      element.textContent = recording.near_frames ? element.dataset.near : element.dataset.plain;
    }
    for (const id of ["play", "before", "after", "back", "on", "time"]) by(id).disabled = !recording.duration;
    this.choose(this.chosen < recording.count ? this.chosen : -1);
    this._requestDraw();
  }

  /** Begin to play, unless the system is set to reduce motion. */
  begin() {
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.clock.play(true);
  }

  /** Stop at a time, and announce what happens there. */
  goTo(time, what = "") {
    this.clock.playing = false;
    this.clock.seek(time);
    this._say(what);
  }

  /** Choose a body, or none (-1). */
  choose(body) {
    this.chosen = body;
    const { recording } = this, all = recording.hitsByBody;
    by("body").value = body >= 0 ? body : "";
    by("only").disabled = body < 0;
    if (body < 0) by("only").checked = false;
    this.list.load(recording, by("only").checked ? all[body] : Array.from({ length: recording.hits }, (_, hit) => hit));
    this._requestDraw();
  }

  _listen() {
    const { clock } = this;
    by("play").addEventListener("click", () => this._toggle());
    by("back").addEventListener("click", () => this._step(-1));
    by("on").addEventListener("click", () => this._step(1));
    by("before").addEventListener("click", () => this._jump(-1));
    by("after").addEventListener("click", () => this._jump(1));
    by("time").addEventListener("input", () => {
      clock.playing = false;
      clock.seek(Number(by("time").value));
    });
    by("time").addEventListener("keydown", (event) => {
      const frames = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1, PageDown: -10, PageUp: 10 }[event.key];
      if (!frames) return;
      event.preventDefault();
      this._step(frames);
    });
    by("speed").addEventListener("change", () => (clock.speed = Number(by("speed").value)));
    by("view").addEventListener("click", () => {
      this.camera.reset();
      this._requestDraw();
    });
    for (const id of ["halos", "ahead"]) by(id).addEventListener("change", () => this._requestDraw());
    by("only").addEventListener("change", () => this.choose(this.chosen));
    by("body").addEventListener("change", () => {
      const value = by("body").value === "" ? -1 : Number(by("body").value);
      this.choose(Number.isInteger(value) && value < this.recording.count ? Math.max(-1, value) : this.chosen);
    });
    document.addEventListener("keydown", (event) => this._key(event));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this._colours());
    new ResizeObserver(() => this._requestDraw()).observe(this.canvas);
    const draw = (now) => {
      clock.tick(now);
      if (this._dirty && this.recording) this._draw();
      requestAnimationFrame(draw);
    };
    requestAnimationFrame(draw);
  }

  _key(event) {
    const busy = event.target.closest("button, input, select, summary, a, textarea");
    if (!this.recording || event.ctrlKey || event.metaKey || event.altKey || (busy && event.target.type !== "range")) return;
    const act = {
      " ": () => this._toggle(), k: () => this._toggle(), ",": () => this._step(-1), ".": () => this._step(1),
      "[": () => this._jump(-1), "]": () => this._jump(1),
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  _toggle() {
    this.clock.play(!this.clock.playing);
  }

  _step(frames) {
    this.clock.stepBy(frames);
    this._say();
  }

  _jump(direction) {
    const time = this.recording.hitTimeFrom(this.clock.time, direction);
    if (time === null) this._say(direction > 0 ? "No hit comes after this." : "No hit came before this.");
    else this.goTo(time);
  }

  _pick(x, y) {
    const { recording, stage } = this;
    this.choose(bodyUnder(this._view(), x, y, stage.positions, recording.sizes));
    this._say();
  }

  _view() {
    const { halfBox, middle } = this.recording;
    return this.camera.view(halfBox, middle, this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight));
  }

  _requestDraw() {
    this._dirty = true;
  }

  _colours() {
    const style = getComputedStyle(document.documentElement);
    this.colours = Object.fromEntries(NAMES.map((name) => {
      const hex = style.getPropertyValue(`--${name}`).trim();
      return [name, [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255)];
    }));
    this._requestDraw();
  }

  /** How long a hit is marked, in s of the recording: while it plays long enough to be seen, else for its frame alone. */
  get _markedFor() {
    return this.clock.playing ? Math.max(SHOWN_FOR * this.clock.speed, this.recording.step) : this._moment;
  }

  /** How old a hit may be, in s, to count as one of now; none at all where a hit happens at exactly this time. */
  get _moment() {
    const { clock, recording } = this, before = recording.hitsUntil(clock.time) - 1;
    const exact = before >= 0 && clock.time - recording.hit_times[before] < 1e-9;
    return exact || (recording.dt && !clock.playing) ? 1e-9 : recording.step;
  }

  _draw() {
    this._dirty = false;
    const { clock, recording, stage } = this;
    if (stage) {
      stage.fit();
      recording.posesAt(clock.time, stage.positions, stage.quaternions);
      const lines = [...this._mark(stage), ...this._nearLines()];
      stage.draw(this._view(), this.colours, { halos: by("halos").checked, ...this._pathsToNextHit(lines) });
    }
    this.timeline.draw(clock.time, this.colours);
    this.list.follow(clock.time, 1e-9);
    this._report();
  }

  /** The lines between the nearest points of the frame that is shown. */
  _nearLines() {
    const { clock, recording } = this, [first, end] = recording.linesAt(clock.time), lines = [];
    for (let line = first; line < end; line++)
      lines.push([...recording.near_points.subarray(6 * line, 6 * line + 6), ...this.colours.near, 0.95]);
    return lines;
  }

  /** A circle around the place where two bodies met, across the line of their centres at that time. */
  _ring(hit, bright) {
    const { recording } = this, bodies = [recording.hit_first[hit], recording.hit_second[hit]];
    const middle = recording.hit_points.subarray(3 * hit, 3 * hit + 3);
    const [a, b] = bodies.map((body) => recording.positionAt(body, recording.hit_times[hit]));
    const [u, v] = across([0, 1, 2].map((axis) => b[axis] - a[axis]));
    const radius = RING_SIZE * Math.min(...bodies.map((body) => recording.sizes[body]));
    const places = Array.from({ length: RING + 1 }, (_, place) => {
      const angle = (2 * Math.PI * place) / RING, c = radius * Math.cos(angle), s = radius * Math.sin(angle);
      return [0, 1, 2].map((axis) => middle[axis] + c * u[axis] + s * v[axis]);
    });
    return places.slice(1).map((place, before) => [...places[before], ...place, ...this.colours.ink, bright]);
  }

  /** Mark the bodies of the latest hits, and give a ring where each met, or else a line between those that met. */
  _mark(stage) {
    const { clock, recording } = this, lines = [];
    stage.marks.fill(0);
    for (let hit = recording.hitsUntil(clock.time) - 1; hit >= 0; hit--) {
      const age = (clock.time - recording.hit_times[hit]) / this._markedFor;
      if (age >= 1) break;
      const first = recording.hit_first[hit], second = recording.hit_second[hit], bright = (1 - age) ** 0.7;
      const place = second >= 0 ? 0 : 1;
      for (const body of second >= 0 ? [first, second] : [first])
        stage.marks[3 * body + place] = Math.max(stage.marks[3 * body + place], bright);
      if (second >= 0 && recording.hit_points) lines.push(...this._ring(hit, bright));
      else if (second >= 0) {
        const ends = [first, second].flatMap((body) => [...stage.positions.subarray(3 * body, 3 * body + 3)]);
        lines.push([...ends, ...this.colours.met, 0.9 * bright]);
      }
    }
    if (this.chosen >= 0) stage.marks[3 * this.chosen + 2] = 1;
    return lines;
  }

  /** The paths to the next hit: of the chosen body, or of all bodies where none is chosen. */
  _pathsToNextHit(lines) {
    const { chosen, clock, recording, stage } = this, ghosts = [];
    if (chosen >= 0) ghosts.push([...stage.positions.subarray(3 * chosen, 3 * chosen + 3), 1.12 * recording.sizes[chosen]]);
    if (!by("ahead").checked) return { lines, ghosts };
    const hit = this._nextHit();
    if (hit < 0) return { lines, ghosts };
    const end = recording.hit_times[hit], second = recording.hit_second[hit];
    for (const body of second >= 0 ? [recording.hit_first[hit], second] : [recording.hit_first[hit]]) {
      const places = [recording.positionAt(body, clock.time)];
      let leg = recording.legAt(body, clock.time) + 1;
      for (let drawn = 0; drawn < AHEAD && leg < recording.leg_starts[body + 1] && recording.leg_times[leg] < end; drawn++, leg++)
        places.push([...recording.leg_positions.subarray(3 * leg, 3 * leg + 3)]);
      places.push(recording.positionAt(body, end));
      for (let place = 1; place < places.length; place++)
        lines.push([...places[place - 1], ...places[place], ...this.colours.chosen, 0.95]);
      ghosts.push([...places[places.length - 1], recording.sizes[body]]);
    }
    return { lines, ghosts };
  }

  _nextHit() {
    const { clock, recording, chosen } = this;
    if (chosen >= 0) return recording.hitsOfUntil(chosen, clock.time).next;
    const next = recording.hitsUntil(clock.time);
    return next < recording.hits ? next : -1;
  }

  /** The hits of this very frame. */
  _hitsNow() {
    const { clock, recording } = this, since = this._moment, now = [];
    for (let hit = recording.hitsUntil(clock.time) - 1; hit >= 0; hit--) {
      if (clock.time - recording.hit_times[hit] > since) break;
      now.unshift(hit);
    }
    return now;
  }

  _report() {
    const { clock, recording, chosen } = this;
    by("play").textContent = clock.playing ? "❚❚ Pause" : "▶ Play";
    by("time").value = clock.time;
    const frame = recording.dt ? `frame ${recording.frameAt(clock.time)} / ${recording.frameAt(recording.duration)} · ` : "";
    by("time").setAttribute("aria-valuetext", `${clock.time.toFixed(3)} of ${recording.duration} seconds`);
    const now = this._hitsNow(), count = recording.hitsUntil(clock.time);
    const names = now.slice(0, 6).map((hit) => recording.nameOf(hit)).join(", ") + (now.length > 6 ? ", …" : "");
    by("now").textContent = `${frame}t = ${clock.time.toFixed(3)} s · ${count} of ${recording.hits} ${recording.near_frames ? "events" : "hits"}` + (names ? ` · now ${names}` : "") + this._nearText();
    by("facts-of-body").hidden = chosen < 0;
    by("none").hidden = chosen >= 0;
    if (chosen >= 0) {
      const { count: hits, next } = recording.hitsOfUntil(chosen, clock.time);
      by("body-speed").textContent = `${recording.speedAt(chosen, clock.time).toPrecision(4)} m/s`;
      by("body-size").textContent = `${Number(recording.sizes[chosen].toPrecision(4))} m`;
      by("body-hits").textContent = `${hits} of ${recording.hitsByBody[chosen].length}`;
      by("body-next").textContent = next < 0 ? "none until the end"
        : `${recording.nameOf(next)} in ${(recording.hit_times[next] - clock.time).toFixed(3)} s`;
    }
  }

  /** How many near pairs are shown, and which is the nearest. */
  _nearText() {
    const { clock, recording } = this;
    if (!recording.near_frames) return "";
    const [first, end] = recording.linesAt(clock.time);
    let nearest = first;
    for (let line = first; line < end; line++) if (recording.lengthOf(line) < recording.lengthOf(nearest)) nearest = line;
    const count = end - first, pairs = `${count} ${count === 1 ? "pair" : "pairs"} near but apart`;
    if (!count) return ` · ${pairs}`;
    const names = `${recording.near_first[nearest]} – ${recording.near_second[nearest]}`;
    return ` · ${pairs}, the shortest line ${names}: ${recording.lengthOf(nearest).toPrecision(3)} m`;
  }

  /** Write what is shown for screen readers. */
  _say(what = "") {
    const { clock, recording, chosen } = this;
    const now = this._hitsNow().map((hit) => recording.nameOf(hit)).join(", ");
    const said = [what || (now ? `hits ${now}` : "no hit"), chosen >= 0 ? `body ${chosen} chosen` : ""].filter(Boolean);
    by("said").textContent = `${clock.time.toFixed(3)} s: ${said.join("; ")}`;
  }
}

/** Two unit vectors across a direction, and across each other. */
function across(direction) {
  const n = unit(direction), sizes = n.map(Math.abs), least = sizes.indexOf(Math.min(...sizes));
  const u = unit(cross(n, [0, 1, 2].map((axis) => (axis === least ? 1 : 0))));
  return [u, cross(n, u)];
}
