// A recorded run: straight legs between hits and steady spins, so that every pose at every time is exact.

const KINDS = { f4: Float32Array, f8: Float64Array, i4: Int32Array, u4: Uint32Array, u2: Uint16Array };
export const WALLS = ["x−", "x+", "y−", "y+", "z−", "z+"];

export class Recording {
  /** From the document that the page carries, or that a server sends. */
  constructor(recorded) {
    const bytes = Uint8Array.from(atob(recorded.data), (character) => character.charCodeAt(0)).buffer;
    for (const [name, [kind, offset, length]] of Object.entries(recorded.arrays))
      this[name] = new KINDS[kind](bytes, offset, length);
    this.title = recorded.title;
    this.shape = recorded.shape;
    this.mesh = recorded.mesh;
    this.duration = recorded.duration;
    this.dt = recorded.dt;
    this.halfBox = recorded.half_box;
    this.middle = recorded.middle;
    this.boxed = recorded.box;
    this.facts = recorded.facts;
    this.count = this.sizes.length;
    this.hits = this.hit_times.length;
    this.meshes = this.vertices ? Array.from({ length: this.face_starts.length - 1 }, (_, mesh) => this._mesh(mesh)) : [];
    this.lines = this.near_frames ? this.near_frames.length : 0; // between near bodies, of all frames
    this.largest = this.sizes.reduce((a, b) => Math.max(a, b), 0);
    this.legs = new Uint32Array(this.count); // of each body the leg that was looked up last
    this.spin_rates = Float64Array.from({ length: this.count }, (_, i) =>
      Math.hypot(this.spins[3 * i], this.spins[3 * i + 1], this.spins[3 * i + 2]));
    this.hitsByBody = Array.from({ length: this.count }, () => []);
    for (let hit = 0; hit < this.hits; hit++) {
      this.hitsByBody[this.hit_first[hit]].push(hit);
      if (this.hit_second[hit] >= 0) this.hitsByBody[this.hit_second[hit]].push(hit);
    }
  }

  /** One of the meshes that bodies have. */
  _mesh(number) {
    const [first, end] = this.vertex_starts.subarray(number, number + 2);
    const [face, last] = this.face_starts.subarray(number, number + 2);
    return { vertices: this.vertices.subarray(3 * first, 3 * end), faces: this.faces.subarray(3 * face, 3 * last) };
  }

  /** Seconds from frame to frame; 1/60 where nothing was computed in frames. */
  get step() {
    return this.dt || 1 / 60;
  }

  /** The frame that a time belongs to. */
  frameAt(time) {
    return Math.round(time / this.step);
  }

  /** The leg that a body flies on at a time: the last that has begun. */
  legAt(body, time) {
    const first = this.leg_starts[body], end = this.leg_starts[body + 1];
    let leg = this.legs[body];
    if (leg < first || leg >= end || this.leg_times[leg] > time) leg = first;
    if (leg + 1 < end && this.leg_times[leg + 1] <= time) {
      let low = leg + 1, high = end - 1;
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (this.leg_times[middle] <= time) low = middle;
        else high = middle - 1;
      }
      leg = low;
    }
    this.legs[body] = leg;
    return leg;
  }

  /** The centre of a body at a time, m. */
  positionAt(body, time) {
    const leg = this.legAt(body, time), flown = time - this.leg_times[leg];
    return [0, 1, 2].map((axis) => this.leg_positions[3 * leg + axis] + this.leg_velocities[3 * leg + axis] * flown);
  }

  /** m/s, just after what happens at that very time. */
  speedAt(body, time) {
    const v = 3 * this.legAt(body, time);
    return Math.hypot(this.leg_velocities[v], this.leg_velocities[v + 1], this.leg_velocities[v + 2]);
  }

  /** Centres (3 numbers a body) and quaternions (4, w x y z) of all bodies at a time. */
  posesAt(time, positions, quaternions) {
    const { leg_times, leg_positions, leg_velocities } = this, turns = Boolean(this.leg_quaternions);
    const spins = turns ? this.leg_spins : this.spins, start = turns ? this.leg_quaternions : this.quaternions;
    for (let i = 0; i < this.count; i++) {
      const leg = this.legAt(i, time), flown = time - leg_times[leg];
      for (let axis = 0; axis < 3; axis++)
        positions[3 * i + axis] = leg_positions[3 * leg + axis] + leg_velocities[3 * leg + axis] * flown;
      // of recorded poses every leg has its own turn, of flying bodies one spin lasts from the start
      const at = turns ? leg : i, turned = turns ? flown : time;
      const rate = turns ? Math.hypot(spins[3 * at], spins[3 * at + 1], spins[3 * at + 2]) : this.spin_rates[i];
      const c = Math.cos(0.5 * rate * turned), s = rate > 0 ? Math.sin(0.5 * rate * turned) / rate : 0;
      const x = s * spins[3 * at], y = s * spins[3 * at + 1], z = s * spins[3 * at + 2];
      const w0 = start[4 * at], x0 = start[4 * at + 1], y0 = start[4 * at + 2], z0 = start[4 * at + 3];
      quaternions[4 * i] = c * w0 - x * x0 - y * y0 - z * z0;
      quaternions[4 * i + 1] = c * x0 + x * w0 + y * z0 - z * y0;
      quaternions[4 * i + 2] = c * y0 - x * z0 + y * w0 + z * x0;
      quaternions[4 * i + 3] = c * z0 + x * y0 - y * x0 + z * w0;
    }
  }

  /** How many hits there were up to a time, those at that very time included. */
  hitsUntil(time) {
    return upper(this.hits, (hit) => this.hit_times[hit] <= time);
  }

  /** How many of a body's hits there were up to a time, and the one that comes next, or -1. */
  hitsOfUntil(body, time) {
    const hits = this.hitsByBody[body];
    const count = upper(hits.length, (place) => this.hit_times[hits[place]] <= time);
    return { count, next: count < hits.length ? hits[count] : -1 };
  }

  /** The time of the next (1) or previous (-1) hit, seen from a time; null where there is none. */
  hitTimeFrom(time, direction) {
    const after = this.hitsUntil(time);
    if (direction > 0) return after < this.hits ? this.hit_times[after] : null;
    const before = upper(this.hits, (hit) => this.hit_times[hit] < time);
    return before > 0 ? this.hit_times[before - 1] : null;
  }

  /** The lines between near bodies of the frame that a time belongs to: the first, and that after the last. */
  linesAt(time) {
    const frame = this.frameAt(time);
    const until = (end) => upper(this.lines, (line) => this.near_frames[line] < end);
    return [until(frame), until(frame + 1)];
  }

  /** How far apart the ends of a line are, m. */
  lengthOf(line) {
    const [a, b] = [6 * line, 6 * line + 3];
    return Math.hypot(...[0, 1, 2].map((axis) => this.near_points[b + axis] - this.near_points[a + axis]));
  }

  /** A hit in words: "3 – 22", or "7 – wall x+". */
  nameOf(hit) {
    const second = this.hit_second[hit];
    return `${this.hit_first[hit]} – ${second >= 0 ? second : `wall ${WALLS[-1 - second]}`}`;
  }
}

/** How many of the first `count` places the test holds for; it holds up to some place and not beyond. */
function upper(count, holds) {
  let low = 0, high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (holds(middle)) low = middle + 1;
    else high = middle;
  }
  return low;
}
