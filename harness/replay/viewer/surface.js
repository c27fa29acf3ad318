// What bodies look like: vertices with normals for drawing, and a coarser form for bodies that are small on the screen.

import { cross } from "./matrix.js";

const CREASE = Math.cos(0.6); // faces that meet at a sharper angle (rad) do not share a normal

/** Vertices, normals and corner numbers of a triangle mesh; corners that share a place and a normal are one. */
export function surface(vertices, faces) {
  const count = faces.length / 3, normals = new Float32Array(faces.length);
  const around = new Map(); // vertex: faces
  for (let face = 0; face < count; face++) {
    normals.set(faceNormal(vertices, faces, face), 3 * face); // as long as twice the area, so that large faces weigh more
    for (let corner = 0; corner < 3; corner++) {
      const vertex = faces[3 * face + corner];
      if (!around.has(vertex)) around.set(vertex, []);
      around.get(vertex).push(face);
    }
  }
  const lengths = Float32Array.from({ length: count }, (_, f) => Math.hypot(...normals.subarray(3 * f, 3 * f + 3)) || 1);
  const places = [], directions = [], corners = new Uint32Array(faces.length), known = new Map();
  for (let face = 0; face < count; face++) {
    for (let corner = 0; corner < 3; corner++) {
      const vertex = faces[3 * face + corner], sum = [0, 0, 0];
      for (const other of around.get(vertex)) {
        let dot = 0;
        for (let axis = 0; axis < 3; axis++) dot += normals[3 * face + axis] * normals[3 * other + axis];
        if (other === face || dot > CREASE * lengths[face] * lengths[other])
          for (let axis = 0; axis < 3; axis++) sum[axis] += normals[3 * other + axis];
      }
      const length = Math.hypot(...sum) || 1, normal = sum.map((value) => value / length);
      const name = `${vertex} ${normal.map((value) => Math.round(value * 64)).join(" ")}`;
      if (!known.has(name)) {
        known.set(name, places.length / 3);
        places.push(...vertices.subarray(3 * vertex, 3 * vertex + 3));
        directions.push(...normal);
      }
      corners[3 * face + corner] = known.get(name);
    }
  }
  return { vertices: new Float32Array(places), normals: new Float32Array(directions), corners };
}

function faceNormal(vertices, faces, face) {
  const [a, b, c] = [0, 1, 2].map((corner) => 3 * faces[3 * face + corner]);
  const u = [0, 1, 2].map((axis) => vertices[b + axis] - vertices[a + axis]);
  const v = [0, 1, 2].map((axis) => vertices[c + axis] - vertices[a + axis]);
  return cross(u, v);
}

/** The same mesh with the vertices of each cell of a grid merged into one: enough for a body of few pixels. */
export function coarse(vertices, faces, cells = 9) {
  const cell = new Map(), sums = [], into = new Uint32Array(vertices.length / 3);
  for (let vertex = 0; vertex < into.length; vertex++) {
    const place = vertices.subarray(3 * vertex, 3 * vertex + 3);
    const name = Array.from(place, (value) => Math.floor((value + 0.5) * cells)).join(" ");
    if (!cell.has(name)) {
      cell.set(name, sums.length);
      sums.push([0, 0, 0, 0]);
    }
    into[vertex] = cell.get(name);
    const sum = sums[into[vertex]];
    for (let axis = 0; axis < 3; axis++) sum[axis] += place[axis];
    sum[3] += 1;
  }
  const kept = [];
  for (let face = 0; face < faces.length; face += 3) {
    const [a, b, c] = [into[faces[face]], into[faces[face + 1]], into[faces[face + 2]]];
    if (a !== b && b !== c && c !== a) kept.push(a, b, c);
  }
  return { vertices: new Float32Array(sums.flatMap(([x, y, z, n]) => [x / n, y / n, z / n])), faces: new Uint32Array(kept) };
}

/** A sphere of diameter 1: an icosahedron whose edges are halved `halvings` times. */
export function sphere(halvings) {
  const t = (1 + Math.sqrt(5)) / 2;
  const points = [[-1, t, 0], [1, t, 0], [-1, -t, 0], [1, -t, 0], [0, -1, t], [0, 1, t], [0, -1, -t], [0, 1, -t],
    [t, 0, -1], [t, 0, 1], [-t, 0, -1], [-t, 0, 1]].map(onSphere);
  let faces = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
    [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]];
  for (let halving = 0; halving < halvings; halving++) {
    const middles = new Map();
    const middle = (a, b) => {
      const name = a < b ? `${a} ${b}` : `${b} ${a}`;
      if (!middles.has(name)) {
        middles.set(name, points.length);
        points.push(onSphere([0, 1, 2].map((axis) => points[a][axis] + points[b][axis])));
      }
      return middles.get(name);
    };
    faces = faces.flatMap(([a, b, c]) => {
      const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
      return [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]];
    });
  }
  const vertices = new Float32Array(points.flat());
  return { vertices, normals: vertices.map((value) => 2 * value), corners: new Uint32Array(faces.flat()) };
}

function onSphere(point) {
  const length = 2 * Math.hypot(...point);
  return point.map((value) => value / length);
}
