// A camera that turns about the middle of the box.

import { cross, lookAt, multiply, perspective, unit } from "./matrix.js";

const FIELD = 0.62; // rad, vertical

export class Camera {
  constructor() {
    this.reset();
  }

  /** Back to the first view. */
  reset() {
    this.turn = 0.62;
    this.tilt = 0.42;
    this.zoom = 1;
  }

  orbit(right, up) {
    this.turn -= right;
    this.tilt = Math.min(1.55, Math.max(-1.55, this.tilt + up));
  }

  closer(factor) {
    this.zoom = Math.min(12, Math.max(0.4, this.zoom * factor));
  }

  /** Matrix and axes for a box with these half sides around a place, and a picture of this aspect. */
  view(half, place, aspect) {
    const radius = Math.hypot(...half), narrow = 2 * Math.atan(Math.tan(FIELD / 2) * Math.min(1, aspect));
    const whole = (radius * 0.93) / Math.sin(narrow / 2), distance = whole / this.zoom;
    const back = [Math.cos(this.tilt) * Math.sin(this.turn), -Math.cos(this.tilt) * Math.cos(this.turn), Math.sin(this.tilt)];
    const forward = back.map((value) => -value);
    const right = unit(cross(forward, [0, 0, 1])), up = cross(right, forward);
    const lift = middle(half, forward, up, whole), aside = middle(half, forward, right, whole);
    const eye = [0, 1, 2].map((axis) => place[axis] + back[axis] * distance + up[axis] * lift + right[axis] * aside);
    const near = Math.max(distance - 1.2 * radius, distance * 0.01, radius * 0.005);
    const projection = perspective(FIELD, aspect, near, distance + 1.5 * radius);
    const matrix = multiply(projection, lookAt(eye, right, up, forward));
    return { matrix, eye, right, up, forward, distance, radius, aspect, tanHalfField: Math.tan(FIELD / 2) };
  }
}

/** How far from the middle of the box the middle of its picture lies, along an axis of the picture. */
function middle(half, forward, axis, distance) {
  let [low, high] = [Infinity, -Infinity];
  for (let corner = 0; corner < 8; corner++) {
    let along = 0, depth = distance;
    half.forEach((length, place) => {
      const at = corner & (1 << place) ? length : -length;
      along += at * axis[place];
      depth += at * forward[place];
    });
    [low, high] = [Math.min(low, along / depth), Math.max(high, along / depth)];
  }
  return ((low + high) / 2) * distance;
}

/** The nearest body under a point of the picture, given from -1 to 1 each way; -1 where there is none. */
export function bodyUnder(view, x, y, positions, sizes) {
  const ray = unit([0, 1, 2].map((axis) =>
    view.forward[axis] + view.right[axis] * x * view.tanHalfField * view.aspect + view.up[axis] * y * view.tanHalfField));
  let nearest = Infinity, found = -1;
  for (let body = 0; body < sizes.length; body++) {
    const gap = [0, 1, 2].map((axis) => positions[3 * body + axis] - view.eye[axis]);
    const along = gap[0] * ray[0] + gap[1] * ray[1] + gap[2] * ray[2];
    const square = gap[0] ** 2 + gap[1] ** 2 + gap[2] ** 2 - along ** 2, radius = sizes[body] / 2;
    if (along <= 0 || square > radius ** 2) continue;
    const front = along - Math.sqrt(radius ** 2 - square);
    if (front < nearest) [nearest, found] = [front, body];
  }
  return found;
}

/** Move the camera by pointer, two fingers, wheel and keys; a press without a drag calls `chosen` with its place. */
export function controlCamera(canvas, camera, moved, chosen) {
  const pointers = new Map();
  let travelled = 0;
  const apart = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (!pointers.size) travelled = 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const after = { x: event.clientX, y: event.clientY }, scale = 3.2 / canvas.clientHeight;
    travelled += Math.hypot(after.x - before.x, after.y - before.y);
    if (pointers.size === 1) {
      camera.orbit((after.x - before.x) * scale, (after.y - before.y) * scale);
      pointers.set(event.pointerId, after);
    } else {
      const wide = apart();
      pointers.set(event.pointerId, after);
      camera.closer(apart() / (wide || 1));
    }
    moved();
  });
  const lift = (event) => {
    if (event.type === "pointerup" && pointers.size === 1 && travelled < 6) {
      const frame = canvas.getBoundingClientRect();
      chosen(2 * (event.clientX - frame.left) / frame.width - 1, 1 - 2 * (event.clientY - frame.top) / frame.height);
    }
    pointers.delete(event.pointerId);
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.closer(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)));
    moved();
  }, { passive: false });
  const keys = {
    ArrowLeft: () => camera.orbit(-0.12, 0), ArrowRight: () => camera.orbit(0.12, 0),
    ArrowUp: () => camera.orbit(0, 0.12), ArrowDown: () => camera.orbit(0, -0.12),
    "+": () => camera.closer(1.15), "=": () => camera.closer(1.15), "-": () => camera.closer(1 / 1.15), 0: () => camera.reset(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!Object.hasOwn(keys, event.key) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
    moved();
  });
}
