// The shader programs: lit bodies, transparent spheres, lines of some width, and the faces of the box.

const TURN = `
vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.yzw, cross(q.yzw, v) + q.x * v); }
`;

export const BODY = {
  vertex: `#version 300 es
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 place;      // centre, size
layout(location = 3) in vec4 quaternion; // w x y z
layout(location = 4) in vec3 mark;       // just hit a body, just hit a wall, chosen
uniform mat4 camera;
out vec3 across;
out vec3 spot;
flat out vec3 marked;
${TURN}
void main() {
  across = turned(quaternion, normal);
  spot = place.xyz + place.w * turned(quaternion, vertex);
  marked = mark;
  gl_Position = camera * vec4(spot, 1.0);
}`,
  fragment: `#version 300 es
precision highp float;
in vec3 across;
in vec3 spot;
flat in vec3 marked;
uniform vec3 eye, right, up, forward, plain, met, wall, chosen, page;
uniform vec2 fog;                       // distance at which it begins, and one over its depth
out vec4 colour;
void main() {
  vec3 n = normalize(across), seen = normalize(eye - spot);
  if (!gl_FrontFacing) n = -n;           // an open mesh shows its inside
  vec3 key = normalize(-0.75 * right + 1.0 * up - 0.9 * forward);
  vec3 base = mix(plain, wall, marked.y);
  base = mix(base, met, marked.x);
  base = mix(base, chosen, marked.z);
  float direct = max(dot(n, key), 0.0), above = 0.5 + 0.5 * dot(n, up);
  float shine = pow(max(dot(n, normalize(key + seen)), 0.0), 42.0);
  float rim = pow(1.0 - max(dot(n, seen), 0.0), 3.0);
  vec3 lit = base * (0.3 + 0.24 * above + 0.66 * direct) + 0.16 * shine;
  lit = mix(lit, lit * 0.72, rim) + base * 0.35 * max(marked.x, marked.z) * rim;
  float far = clamp((distance(eye, spot) - fog.x) * fog.y, 0.0, 1.0);
  colour = vec4(mix(lit, page, 0.42 * far), 1.0);
}`,
};

export const HALO = {
  vertex: `#version 300 es
layout(location = 0) in vec3 vertex;
layout(location = 2) in vec4 place;
uniform mat4 camera;
uniform vec3 eye;
out float edge;
void main() {
  vec3 spot = place.xyz + place.w * vertex;
  edge = 1.0 - abs(dot(normalize(vertex), normalize(eye - spot)));
  gl_Position = camera * vec4(spot, 1.0);
}`,
  fragment: `#version 300 es
precision highp float;
in float edge;
uniform vec3 tint;
uniform float strength;
out vec4 colour;
void main() {
  colour = vec4(tint, strength * (0.07 + 0.75 * smoothstep(0.55, 1.0, edge)));
}`,
};

export const LINE = {
  vertex: `#version 300 es
layout(location = 2) in vec3 from;
layout(location = 3) in vec3 to;
layout(location = 4) in vec4 ink;
uniform mat4 camera;
uniform vec2 picture;                    // its size in pixels
uniform float width;
out vec4 tint;
void main() {
  vec4 a = camera * vec4(from, 1.0), b = camera * vec4(to, 1.0);
  vec2 along = normalize((b.xy / b.w - a.xy / a.w) * picture + 1e-6);
  vec4 end = gl_VertexID < 2 ? a : b;
  float side = gl_VertexID % 2 == 0 ? 1.0 : -1.0;
  end.xy += vec2(-along.y, along.x) * side * width / picture * end.w;
  end.z -= 1e-4 * end.w;
  tint = ink;
  gl_Position = end;
}`,
  fragment: `#version 300 es
precision highp float;
in vec4 tint;
out vec4 colour;
void main() { colour = tint; }`,
};

export const ROOM = {
  vertex: `#version 300 es
layout(location = 0) in vec3 vertex;
uniform mat4 camera;
uniform vec3 half_box;
out vec3 spot;
void main() {
  spot = vertex * 2.0;
  gl_Position = camera * vec4(spot * half_box, 1.0);
}`,
  fragment: `#version 300 es
precision highp float;
in vec3 spot;
uniform vec3 panel;
uniform vec3 up;
out vec4 colour;
void main() {
  float corner = length(spot) - 1.0;
  colour = vec4(panel * (1.0 - 0.05 * corner), 1.0);
}`,
};

/** A linked program with the places of its uniforms. */
export function program(gl, { vertex, fragment }) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) || "no program");
  const uniforms = {};
  for (let place = 0; place < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); place++) {
    const { name } = gl.getActiveUniform(made, place);
    uniforms[name] = gl.getUniformLocation(made, name);
  }
  return { use: () => gl.useProgram(made), uniforms };
}
