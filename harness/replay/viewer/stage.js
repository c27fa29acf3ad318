// Draws the scene of one moment: every body with one instanced call for those near and one for those small.

import { project } from "./matrix.js";
import { BODY, HALO, LINE, ROOM, program } from "./shaders.js";
import { coarse, sphere, surface } from "./surface.js";

const SMALL = 34; // pixels on the screen below which a body is drawn with the coarse mesh
const INSTANCE = 11; // numbers a body: centre, size, quaternion, marks
const FEW_FACES = 400; // a mesh with no more needs no coarse form
const CUBE = [[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [1, 1, -1], [-1, -1, 1], [1, -1, 1], [-1, 1, 1], [1, 1, 1]];
const EDGES = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
const SIDES = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

export class Stage {
  /** On a canvas; throws where there is no WebGL2. */
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, powerPreference: "high-performance" });
    if (!gl) throw new Error("no WebGL2");
    this.gl = gl;
    this.body = program(gl, BODY);
    this.halo = program(gl, HALO);
    this.line = program(gl, LINE);
    this.room = program(gl, ROOM);
    this.ball = this._form(sphere(2));
    this.cube = this._form({
      vertices: new Float32Array(CUBE.flat().map((value) => value / 2)), normals: new Float32Array(24),
      corners: new Uint32Array(SIDES.flatMap(([a, b, c, d]) => [a, b, c, a, c, d])),
    });
    this.strokes = this._strokes();
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Prepare to draw the bodies of a recording. */
  load(recording) {
    this.recording = recording;
    this.positions = new Float64Array(3 * recording.count);
    this.quaternions = new Float64Array(4 * recording.count);
    this.marks = new Float32Array(3 * recording.count);
    this.instances = new Float32Array(INSTANCE * recording.count);
    for (const { near, far } of this.forms || []) [near, far].forEach((form) => this._drop(form));
    this.forms = recording.meshes.map((mesh) => {
      const rough = mesh.faces.length > 3 * FEW_FACES ? coarse(mesh.vertices, mesh.faces) : mesh;
      return {
        near: this._form(surface(mesh.vertices, mesh.faces)),
        far: this._form(surface(rough.vertices, rough.faces)),
      };
    });
    if (!this.forms.length) this.forms = [{ near: this._form(sphere(3)), far: this._form(sphere(1)) }];
  }

  /** Fit the picture to its place on the page; whether it changed. */
  fit() {
    const { canvas } = this, scale = Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((length) => Math.max(1, Math.round(length * scale)));
    if (canvas.width === width && canvas.height === height) return false;
    [canvas.width, canvas.height] = [width, height];
    return true;
  }

  /** Draw what `positions`, `quaternions` and `marks` say, and spheres and lines given as lists. */
  draw(view, colours, { halos, ghosts, lines }) {
    const { gl, canvas } = this;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...colours.page, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this._drawRoom(view, colours);
    this._drawBodies(view, colours);
    gl.enable(gl.BLEND);
    this._drawLines(view, this._edges(view, colours));
    gl.depthMask(false);
    if (halos) this._drawSpheres(view, colours.halo, this._spheres(), 0.6);
    gl.disable(gl.DEPTH_TEST); // paths and the chosen body are shown even behind other bodies
    this._drawLines(view, lines);
    this._drawSpheres(view, colours.chosen, new Float32Array(ghosts.flat()), 1);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  _drawRoom(view, colours) {
    const { gl, room } = this;
    room.use();
    gl.uniformMatrix4fv(room.uniforms.camera, false, view.matrix);
    gl.uniform3fv(room.uniforms.half_box, this.recording.halfBox);
    gl.uniform3fv(room.uniforms.panel, colours.panel);
    gl.enable(gl.CULL_FACE); // the far sides alone, from inside
    gl.cullFace(gl.BACK);
    gl.depthMask(false);
    gl.bindVertexArray(this.cube.array);
    gl.drawElements(gl.TRIANGLES, this.cube.count, gl.UNSIGNED_INT, 0);
    gl.depthMask(true);
    gl.disable(gl.CULL_FACE);
  }

  _drawBodies(view, colours) {
    const { gl, body, recording } = this;
    const scale = this.canvas.height / view.tanHalfField / 2;
    const drawn = this.forms.map(() => ({ near: [], far: [] }));
    for (let i = 0; i < recording.count; i++) {
      const w = project(view.matrix, ...this.positions.subarray(3 * i, 3 * i + 3))[3];
      const { near, far } = drawn[recording.meshes.length ? recording.mesh_of[i] : 0];
      (recording.sizes[i] * scale > SMALL * w ? near : far).push(i);
    }
    body.use();
    gl.uniformMatrix4fv(body.uniforms.camera, false, view.matrix);
    for (const name of ["eye", "right", "up", "forward"]) gl.uniform3fv(body.uniforms[name], view[name]);
    for (const name of ["plain", "met", "wall", "chosen", "page"]) gl.uniform3fv(body.uniforms[name], colours[name]);
    gl.uniform2f(body.uniforms.fog, view.distance - 0.5 * view.radius, 1 / (1.5 * view.radius));
    const groups = drawn.flatMap(({ near, far }, mesh) => [[this.forms[mesh].near, near], [this.forms[mesh].far, far]]);
    for (const [form, bodies] of groups) {
      bodies.forEach((i, place) => {
        const at = INSTANCE * place;
        this.instances.set(this.positions.subarray(3 * i, 3 * i + 3), at);
        this.instances[at + 3] = recording.sizes[i];
        this.instances.set(this.quaternions.subarray(4 * i, 4 * i + 4), at + 4);
        this.instances.set(this.marks.subarray(3 * i, 3 * i + 3), at + 8);
      });
      this._drawForm(form, this.instances.subarray(0, INSTANCE * bodies.length), bodies.length, [[2, 4], [3, 4], [4, 3]]);
    }
  }

  _drawSpheres(view, tint, spheres, strength) {
    const { gl, halo } = this;
    halo.use();
    gl.uniformMatrix4fv(halo.uniforms.camera, false, view.matrix);
    gl.uniform3fv(halo.uniforms.eye, view.eye);
    gl.uniform3fv(halo.uniforms.tint, tint);
    gl.uniform1f(halo.uniforms.strength, strength);
    this._drawForm(this.ball, spheres, spheres.length / 4, [[2, 4]]);
  }

  _drawLines(view, lines) {
    const { gl, line, strokes, canvas } = this;
    line.use();
    gl.uniformMatrix4fv(line.uniforms.camera, false, view.matrix);
    gl.uniform2f(line.uniforms.picture, canvas.width, canvas.height);
    gl.uniform1f(line.uniforms.width, 1.6 * Math.min(2, window.devicePixelRatio || 1));
    gl.bindVertexArray(strokes.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, strokes.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(lines.flat()), gl.STREAM_DRAW);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, lines.length);
  }

  /** The edges of the box; those in front of the bodies are fainter. */
  _edges(view, colours) {
    const half = this.recording.halfBox;
    const corners = CUBE.map((corner) => corner.map((sign, axis) => sign * half[axis]));
    return EDGES.map(([a, b]) => {
      const middle = [0, 1, 2].map((axis) => (corners[a][axis] + corners[b][axis]) / 2);
      const front = middle.some((value, axis) => value && Math.sign(value) === Math.sign(view.eye[axis]) && Math.abs(view.eye[axis]) > half[axis]);
      return [...corners[a], ...corners[b], ...colours.edge, front ? 0.55 : 0.9];
    });
  }

  _spheres() {
    const { positions, recording } = this, spheres = new Float32Array(4 * recording.count);
    for (let i = 0; i < recording.count; i++) {
      spheres.set(positions.subarray(3 * i, 3 * i + 3), 4 * i);
      spheres[4 * i + 3] = recording.sizes[i];
    }
    return spheres;
  }

  _drawForm(form, instances, count, fields) {
    const { gl } = this, stride = 4 * fields.reduce((sum, [, numbers]) => sum + numbers, 0);
    if (!count) return;
    gl.bindVertexArray(form.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, form.instances);
    gl.bufferData(gl.ARRAY_BUFFER, instances, gl.STREAM_DRAW);
    let offset = 0;
    for (const [place, numbers] of fields) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, numbers, gl.FLOAT, false, stride, offset);
      gl.vertexAttribDivisor(place, 1);
      offset += 4 * numbers;
    }
    gl.drawElementsInstanced(gl.TRIANGLES, form.count, gl.UNSIGNED_INT, 0, count);
  }

  _form({ vertices, normals, corners }) {
    const { gl } = this, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = [vertices, normals].map((values, place) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
      return buffer;
    });
    const elements = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, elements);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    return { array, count: corners.length, instances: gl.createBuffer(), buffers: [...buffers, elements] };
  }

  _drop(form) {
    if (!form) return;
    for (const buffer of [...form.buffers, form.instances]) this.gl.deleteBuffer(buffer);
    this.gl.deleteVertexArray(form.array);
  }

  _strokes() {
    const { gl } = this, array = gl.createVertexArray(), buffer = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (const [place, numbers, offset] of [[2, 3, 0], [3, 3, 12], [4, 4, 24]]) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, numbers, gl.FLOAT, false, 40, offset);
      gl.vertexAttribDivisor(place, 1);
    }
    return { array, buffer };
  }
}
