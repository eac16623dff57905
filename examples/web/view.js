// view.js - draws one surface with raw WebGL2: colours by value, isolines, edges, a mark at the source, light and a shadow on
// the ground; picks vertices. Colours, light and shadow are those of tools/picture.h.
"use strict";

// The map ember: lightness, chroma and hue of equally spaced colours in OKLab (Björn Ottosson 2020), joined by a smooth
// curve. Lightness is linear from end to end; colours outside sRGB lose chroma.
const EMBER = [
  [0.425, 0.135, 272],
  [0.53, 0.185, 303],
  [0.635, 0.205, 352],
  [0.74, 0.172, 40],
  [0.845, 0.148, 75],
  [0.95, 0.085, 103],
];

function oklabToLinear(l, a, b) {
  const [p, q, r] = [
    l + 0.3963377774 * a + 0.2158037573 * b,
    l - 0.1055613458 * a - 0.0638541728 * b,
    l - 0.0894841775 * a - 1.291485548 * b,
  ].map((x) => x ** 3);
  return [
    4.0767416621 * p - 3.3077115913 * q + 0.2309699292 * r,
    -1.2684380046 * p + 2.6097574011 * q - 0.3413193965 * r,
    -0.0041960863 * p - 0.7034186147 * q + 1.707614701 * r,
  ];
}

// Catmull-Rom; at the ends the curve continues straight.
function along(values, i, t) {
  const b = values[i],
    c = values[i + 1],
    a = i > 0 ? values[i - 1] : 2 * b - c,
    d = i + 2 < values.length ? values[i + 2] : 2 * c - b;
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

const clamp = (x, lo, hi) => Math.max(lo, Math.min(hi, x));

// The colour of s in [0, 1], as three bytes of sRGB.
function colourOf(s) {
  const u = clamp(s, 0, 1) * (EMBER.length - 1),
    i = Math.min(EMBER.length - 2, Math.floor(u)),
    t = u - i;
  const hue = (f) => EMBER.map(([, c, h]) => c * f((h * Math.PI) / 180));
  const l = EMBER[i][0] + t * (EMBER[i + 1][0] - EMBER[i][0]),
    a = along(hue(Math.cos), i, t),
    b = along(hue(Math.sin), i, t);
  let rgb;
  for (let keep = 1; keep > 0; keep -= 1 / 64) {
    rgb = oklabToLinear(l, a * keep, b * keep);
    if (Math.min(...rgb) >= -1e-4 && Math.max(...rgb) <= 1.0001) break;
  }
  return rgb.map((x) => {
    const v = clamp(x, 0, 1);
    return Math.floor(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055) + 0.5);
  });
}

// The paper at the top and at the bottom, in sRGB.
const PAPER = {
  light: [
    [0.984, 0.984, 0.978],
    [0.902, 0.912, 0.925],
  ],
  dark: [
    [0.155, 0.165, 0.18],
    [0.085, 0.09, 0.1],
  ],
};

// The plane that the surface stands on: a map of CELLS by CELLS over [-HALF, HALF]^2.
const CELLS = 160,
  HALF = 1.5;

// How much of the shape stands over each place of the ground, low parts more; blurred. at: within the unit ball.
function shadowOf(at, tri, height) {
  const dark = new Float32Array(CELLS * CELLS),
    cell = (2 * HALF) / CELLS,
    drop = (x, y, z) => {
      const i = Math.floor((x / HALF / 2 + 0.5) * CELLS),
        j = Math.floor((z / HALF / 2 + 0.5) * CELLS);
      if (i < 0 || j < 0 || i >= CELLS || j >= CELLS) return;
      const v = Math.exp(-2.6 * (y - height));
      if (v > dark[j * CELLS + i]) dark[j * CELLS + i] = v;
    };
  const every = 3 * Math.ceil(tri.length / 600000); // of large meshes some triangles will do
  for (let f = 0; f < tri.length; f += every) {
    const [a, b, c] = [3 * tri[f], 3 * tri[f + 1], 3 * tri[f + 2]];
    let size = 0;
    for (let k = 0; k < 3; k++)
      size = Math.max(
        size,
        Math.abs(at[a + k] - at[b + k]),
        Math.abs(at[b + k] - at[c + k]),
        Math.abs(at[c + k] - at[a + k]),
      );
    const n = 1 + Math.floor(size / cell);
    for (let i = 0; i <= n; i++)
      for (let j = 0; j <= n - i; j++) {
        const u = i / n,
          v = j / n,
          w = 1 - u - v;
        drop(
          u * at[a] + v * at[b] + w * at[c],
          u * at[a + 1] + v * at[b + 1] + w * at[c + 1],
          u * at[a + 2] + v * at[b + 2] + w * at[c + 2],
        );
      }
  }
  if (!tri.length) for (let i = 0; i < at.length; i += 3) drop(at[i], at[i + 1], at[i + 2]);
  // A running mean along the rows, written transposed: two of them blur both ways.
  const blur = (from) => {
    const to = new Float32Array(CELLS * CELLS),
      reach = 4;
    for (let y = 0; y < CELLS; y++) {
      let sum = 0;
      for (let x = -reach; x < CELLS; x++) {
        if (x + reach < CELLS) sum += from[y * CELLS + x + reach];
        if (x - reach - 1 >= 0) sum -= from[y * CELLS + x - reach - 1];
        if (x >= 0) to[x * CELLS + y] = sum / (2 * reach + 1);
      }
    }
    return to;
  };
  let soft = dark;
  for (let pass = 0; pass < 6; pass++) soft = blur(soft);
  return Uint8Array.from(soft, (x) => Math.round(255 * clamp(x, 0, 1)));
}

// Which way is up in the file: what x, y and z of the picture are.
const UP = {
  x: (x, y, z) => [-y, x, z],
  y: (x, y, z) => [x, y, z],
  z: (x, y, z) => [x, z, -y],
};

const SURFACE_VERTEX = `#version 300 es
layout(location = 0) in vec3 at;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
uniform mat4 camera;
uniform mat3 turn;
uniform float dot_size;
out vec3 n;
out vec3 eye;
out float s;
void main() {
  n = turn * normal;
  eye = turn * at;
  s = value;
  gl_Position = camera * vec4(at, 1.0);
  gl_PointSize = max(1.5, dot_size / gl_Position.w);
}`;

const COLOURS = `
vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
vec3 toSrgb(vec3 c) { c = clamp(c, 0.0, 1.0); return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
`;

const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 n;
in vec3 eye;
in float s;
uniform sampler2D map;
uniform vec2 rule;      // isolines where rule.x s + rule.y is an integer
uniform float lines;
uniform float zero;       // whether there is an isoline at zero
uniform float points;
uniform float flat_colour;
uniform vec3 up;
uniform float back;
out vec4 colour;
${COLOURS}
// A sky above, a key light from the upper left, a weak one from the right, a soft highlight, a darker rim.
vec3 shade(vec3 base, vec3 m) {
  const vec3 key = vec3(-0.4264, 0.6396, 0.6396), fill = vec3(0.8575, 0.0857, 0.5073), behind = vec3(0.2169, 0.5965, -0.7727);
  vec3 v = normalize(vec3(0.0, 0.0, back) - eye);
  float rim = 1.0 - clamp(dot(m, v), 0.0, 1.0), sky = 0.5 + 0.5 * dot(m, up);
  float light = 0.30 + 0.24 * sky + 0.15 * max(0.0, dot(m, fill)) + 0.62 * max(0.0, (dot(m, key) + 0.25) / 1.25);
  float shine = 0.07 * pow(max(0.0, dot(m, normalize(key + v))), 32.0);
  float streak = 0.30 * rim * rim * max(0.0, dot(m, behind) + 0.25);
  return base * (light * (1.0 - 0.30 * rim * rim * rim) + streak) + shine;
}
void main() {
  vec3 m = normalize(n);
  float ink = 0.0;
  if (points > 0.5) {
    vec2 p = 2.0 * gl_PointCoord - 1.0;
    float r = dot(p, p);
    if (r > 1.0) discard;
    m = vec3(p.x, -p.y, sqrt(1.0 - r));
  } else if (!gl_FrontFacing) m = -m;
  float u = rule.x * s + rule.y, w = max(fwidth(u), 1e-7);
  if (lines > 0.5) ink = (1.0 - smoothstep(0.5, 1.3, abs(fract(u - 0.5) - 0.5) / w)) * (1.0 - smoothstep(0.25, 0.6, w));
  if (zero < 0.5 && abs(u) < 0.5) ink = 0.0;
  vec3 base = s < -0.5 ? vec3(0.56, 0.60, 0.66) : toLinear(texture(map, vec2(clamp(s, 0.002, 0.998), 0.5)).rgb);
  if (flat_colour > 0.5) { colour = vec4(0.06, 0.07, 0.09, 0.28); return; }
  colour = vec4(toSrgb(shade(base, m) * (1.0 - 0.70 * ink)), 1.0);
}`;

const PAPER_VERTEX = `#version 300 es
out float below;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  below = 0.5 - 0.5 * p.y;
  gl_Position = vec4(p, 0.0, 1.0);
}`;

const PAPER_FRAGMENT = `#version 300 es
precision highp float;
in float below;
uniform vec3 top;
uniform vec3 bottom;
out vec4 colour;
void main() { colour = vec4(mix(top, bottom, smoothstep(0.0, 1.0, below)), 1.0); }`;

const GROUND_VERTEX = `#version 300 es
uniform mat4 camera;
uniform float height;
out vec2 place;
void main() {
  place = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec2 p = (2.0 * place - 1.0) * ${HALF.toFixed(1)};
  gl_Position = camera * vec4(p.x, height, p.y, 1.0);
}`;

const GROUND_FRAGMENT = `#version 300 es
precision highp float;
in vec2 place;
uniform sampler2D shadow;
out vec4 colour;
void main() {
  vec2 d = 2.0 * abs(place - 0.5);
  float fade = (1.0 - smoothstep(0.7, 1.0, d.x)) * (1.0 - smoothstep(0.7, 1.0, d.y));
  float dark = 0.50 * fade * texture(shadow, place).r;
  colour = vec4(0.0, 0.0, 0.0, 1.0 - pow(1.0 - dark, 1.0 / 2.4));
}`;

const MARK_VERTEX = `#version 300 es
uniform mat4 camera;
uniform vec3 at;
uniform float size;
void main() { gl_Position = camera * vec4(at, 1.0); gl_Position.z -= 0.012 * gl_Position.w; gl_PointSize = size; }`;

const MARK_FRAGMENT = `#version 300 es
precision highp float;
out vec4 colour;
void main() {
  float r = length(2.0 * gl_PointCoord - 1.0);
  if (r > 1.0) discard;
  colour = r > 0.62 ? vec4(0.1, 0.1, 0.12, 1.0) : vec4(1.0, 0.35, 0.21, 1.0);
}`;

class View {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = (this.gl = canvas.getContext("webgl2", { antialias: true, alpha: false }));
    if (!gl) throw new Error("This page draws with WebGL 2, which this browser does not offer.");
    this.surface = this.program(SURFACE_VERTEX, SURFACE_FRAGMENT);
    this.paper = this.program(PAPER_VERTEX, PAPER_FRAGMENT);
    this.ground = this.program(GROUND_VERTEX, GROUND_FRAGMENT);
    this.mark = this.program(MARK_VERTEX, MARK_FRAGMENT);
    this.buffers = {
      at: gl.createBuffer(),
      normal: gl.createBuffer(),
      value: gl.createBuffer(),
      tri: gl.createBuffer(),
      edge: gl.createBuffer(),
    };
    const ramp = new Uint8Array(1024);
    for (let i = 0; i < 256; i++) ramp.set([...colourOf(i / 255), 255], 4 * i);
    this.map = this.texture(gl.RGBA, 256, 1, ramp);
    this.shadow = this.texture(gl.RED, CELLS, CELLS, new Uint8Array(CELLS * CELLS));
    this.theme = "light";
    this.up = "y";
    this.height = 0;
    this.tri = new Int32Array(0);
    this.at = new Float32Array(0);
    this.yaw = -0.55;
    this.pitch = 0.32;
    this.zoom = 1;
    this.lines = true;
    this.edges = false;
    this.rule = [0, 0.5];
    this.zero = false;
    this.source = -1;
    this.n = 0;
    this.later = 0;
    this.frames = 0;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  texture(format, width, height, data) {
    const gl = this.gl,
      t = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, t);
    for (const [k, v] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ])
      gl.texParameteri(gl.TEXTURE_2D, k, v);
    const internal = format === gl.RED ? gl.R8 : format;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, gl.UNSIGNED_BYTE, data);
    return t;
  }

  program(vertex, fragment) {
    const gl = this.gl,
      p = gl.createProgram();
    for (const [kind, text] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(p, shader);
    }
    gl.linkProgram(p);
    if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
    const uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(p, gl.ACTIVE_UNIFORMS); i++) {
      const name = gl.getActiveUniform(p, i).name;
      uniforms[name] = gl.getUniformLocation(p, name);
    }
    return { p, ...uniforms };
  }

  upload(name, target, data) {
    this.gl.bindBuffer(target, this.buffers[name]);
    this.gl.bufferData(target, data, this.gl.DYNAMIC_DRAW);
  }

  // Nothing is shown but the paper.
  clear() {
    this.n = 0;
    this.tri = new Int32Array(0);
    this.at = new Float32Array(0);
    this.draw();
  }

  setMesh(xyz, tri, h) {
    const gl = this.gl;
    this.n = xyz.length / 3;
    this.tri = tri;
    this.h = h;
    this.upload("tri", gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(tri));
    this.edgeCount = 0;
    this.hasEdges = false;
    this.setPositions(xyz);
  }

  // Centred and scaled to one size, whatever the coordinates are: `radius` is the largest distance from the middle.
  setPositions(xyz) {
    const n = this.n,
      lo = [Infinity, Infinity, Infinity],
      hi = [-Infinity, -Infinity, -Infinity],
      at = new Float32Array(3 * n);
    for (let i = 0; i < 3 * n; i++) {
      const c = i % 3;
      if (xyz[i] < lo[c]) lo[c] = xyz[i];
      if (xyz[i] > hi[c]) hi[c] = xyz[i];
    }
    const mid = [0, 1, 2].map((c) => (lo[c] + hi[c]) / 2);
    let far = 0;
    for (let i = 0; i < n; i++)
      far = Math.max(far, Math.hypot(xyz[3 * i] - mid[0], xyz[3 * i + 1] - mid[1], xyz[3 * i + 2] - mid[2]));
    this.radius = far || 1;
    const turned = UP[this.up];
    let height = Infinity;
    for (let i = 0; i < 3 * n; i += 3) {
      const p = turned(
        (xyz[i] - mid[0]) / this.radius,
        (xyz[i + 1] - mid[1]) / this.radius,
        (xyz[i + 2] - mid[2]) / this.radius,
      );
      at.set(p, i);
      if (p[1] < height) height = p[1];
    }
    this.at = at;
    this.height = n ? height : 0;
    this.gl.deleteTexture(this.shadow);
    this.shadow = this.texture(this.gl.RED, CELLS, CELLS, shadowOf(at, this.tri, this.height));
    this.upload("at", this.gl.ARRAY_BUFFER, at);
    this.upload("normal", this.gl.ARRAY_BUFFER, this.normals());
    this.draw();
  }

  normals() {
    const a = this.at,
      t = this.tri,
      out = new Float32Array(a.length);
    for (let f = 0; f < t.length; f += 3) {
      const i = 3 * t[f],
        j = 3 * t[f + 1],
        k = 3 * t[f + 2];
      const ux = a[j] - a[i],
        uy = a[j + 1] - a[i + 1],
        uz = a[j + 2] - a[i + 2];
      const vx = a[k] - a[i],
        vy = a[k + 1] - a[i + 1],
        vz = a[k + 2] - a[i + 2];
      const x = uy * vz - uz * vy,
        y = uz * vx - ux * vz,
        z = ux * vy - uy * vx;
      for (const p of [i, j, k]) {
        out[p] += x;
        out[p + 1] += y;
        out[p + 2] += z;
      }
    }
    for (let i = 0; i < out.length; i += 3) {
      const len = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
      out[i] /= len;
      out[i + 1] /= len;
      out[i + 2] = (out[i + 2] || (len === 1 && !out[i] && !out[i + 1] ? 1 : 0)) / len;
    }
    return out;
  }

  setValues(s, rule, zero) {
    this.rule = rule;
    this.zero = zero;
    this.upload("value", this.gl.ARRAY_BUFFER, s);
    this.draw();
  }

  makeEdges() {
    const t = this.tri,
      seen = new Set(),
      out = [];
    for (let f = 0; f < t.length; f += 3)
      for (let c = 0; c < 3; c++) {
        const a = t[f + c],
          b = t[f + ((c + 1) % 3)],
          key = Math.min(a, b) * this.n + Math.max(a, b);
        if (!seen.has(key)) {
          seen.add(key);
          out.push(a, b);
        }
      }
    this.upload("edge", this.gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(out));
    this.edgeCount = out.length;
    this.hasEdges = true;
  }

  matrices() {
    const { canvas } = this,
      cy = Math.cos(this.yaw),
      sy = Math.sin(this.yaw),
      cp = Math.cos(this.pitch),
      sp = Math.sin(this.pitch);
    const turn = [cy, sp * sy, -cp * sy, 0, cp, sp, sy, -sp * cy, cp * cy]; // columns
    const aspect = canvas.width / canvas.height,
      f = 2.9 * this.zoom * Math.min(1, aspect),
      back = 3.1;
    const scale = [f / aspect, f],
      near = 0.5,
      far = 6;
    const m = new Float32Array(16);
    for (let c = 0; c < 3; c++) {
      m[4 * c] = scale[0] * turn[3 * c];
      m[4 * c + 1] = scale[1] * turn[3 * c + 1];
      m[4 * c + 2] = (-turn[3 * c + 2] * (far + near)) / (far - near);
      m[4 * c + 3] = -turn[3 * c + 2];
    }
    m[13] = 0.06 * back; // a little above the middle: the legend is below
    m[14] = (back * (far + near)) / (far - near) - (2 * far * near) / (far - near);
    m[15] = back;
    return { camera: m, turn: new Float32Array(turn) };
  }

  draw() {
    if (!this.later)
      this.later = requestAnimationFrame(() => {
        this.later = 0;
        this.drawNow();
      });
  }

  drawNow() {
    const { gl, canvas, surface } = this,
      ratio = Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio)),
      height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const { camera, turn } = this.matrices();
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.drawGround(camera);
    this.frames++;
    if (!this.n) return;
    gl.enable(gl.DEPTH_TEST);
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    gl.useProgram(surface.p);
    gl.uniformMatrix4fv(surface.camera, false, camera);
    gl.uniformMatrix3fv(surface.turn, false, turn);
    gl.uniform2f(surface.rule, ...this.rule);
    gl.uniform1f(surface.lines, this.lines && this.tri.length ? 1 : 0);
    gl.uniform1f(surface.zero, this.zero ? 1 : 0);
    gl.uniform1f(surface.points, this.tri.length ? 0 : 1);
    gl.uniform1f(surface.flat_colour, 0);
    gl.uniform3fv(surface.up, turn.subarray(3, 6));
    gl.uniform1f(surface.back, camera[15]);
    gl.uniform1f(
      surface.dot_size,
      (((((1.8 * this.h) / this.radius) * camera[5]) / Math.max(0.1, Math.cos(this.pitch))) * height) / 2,
    );
    for (const [k, name, size] of [
      [0, "at", 3],
      [1, "normal", 3],
      [2, "value", 1],
    ]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
      gl.enableVertexAttribArray(k);
      gl.vertexAttribPointer(k, size, gl.FLOAT, false, 0, 0);
    }
    if (this.tri.length) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.tri);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
      gl.drawElements(gl.TRIANGLES, this.tri.length, gl.UNSIGNED_INT, 0);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      if (this.edges) {
        if (!this.hasEdges) this.makeEdges();
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.edge);
        gl.uniform1f(surface.flat_colour, 1);
        gl.drawElements(gl.LINES, this.edgeCount, gl.UNSIGNED_INT, 0);
      }
    } else gl.drawArrays(gl.POINTS, 0, this.n);
    if (this.source >= 0) this.drawMark(camera, ratio);
  }

  // Paper, and the shadow where the ground is seen from above.
  drawGround(camera) {
    const { gl, paper, ground } = this,
      [top, bottom] = PAPER[this.theme];
    for (const k of [0, 1, 2]) gl.disableVertexAttribArray(k);
    gl.disable(gl.DEPTH_TEST);
    gl.useProgram(paper.p);
    gl.uniform3fv(paper.top, top);
    gl.uniform3fv(paper.bottom, bottom);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    if (!this.n || this.pitch < 0.08) return;
    gl.useProgram(ground.p);
    gl.uniformMatrix4fv(ground.camera, false, camera);
    gl.uniform1f(ground.height, this.height - 0.004);
    gl.bindTexture(gl.TEXTURE_2D, this.shadow);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  drawMark(camera, ratio) {
    const { gl, mark } = this;
    for (const k of [0, 1, 2]) gl.disableVertexAttribArray(k);
    gl.useProgram(mark.p);
    gl.uniformMatrix4fv(mark.camera, false, camera);
    gl.uniform3fv(mark.at, this.at.subarray(3 * this.source, 3 * this.source + 3));
    gl.uniform1f(mark.size, 13 * ratio);
    gl.drawArrays(gl.POINTS, 0, 1);
  }

  // The vertex nearest to where the ray through a pixel first meets the surface; -1: it misses. x, y in CSS pixels.
  pick(x, y) {
    const { camera: m } = this.matrices(),
      a = this.at,
      t = this.tri;
    const px = (2 * x) / this.canvas.clientWidth - 1,
      py = 1 - (2 * y) / this.canvas.clientHeight;
    const n = this.n,
      sx = new Float32Array(n),
      sy = new Float32Array(n),
      sw = new Float32Array(n);
    for (let i = 0; i < n; i++) {
      const u = a[3 * i],
        v = a[3 * i + 1],
        z = a[3 * i + 2],
        w = m[3] * u + m[7] * v + m[11] * z + m[15];
      sw[i] = w;
      sx[i] = (m[0] * u + m[4] * v + m[8] * z + m[12]) / w - px;
      sy[i] = (m[1] * u + m[5] * v + m[9] * z + m[13]) / w - py;
    }
    let best = -1,
      depth = Infinity;
    if (!t.length) {
      const reach = 0.05 ** 2,
        spot = ((1.2 * this.h) / this.radius) ** 2;
      let score = Infinity;
      for (let i = 0; i < n; i++) {
        const d = sx[i] * sx[i] + sy[i] * sy[i],
          rank = sw[i] + (d > spot ? 10 + d : 0);
        if (d < reach && rank < score) {
          score = rank;
          best = i;
        }
      }
      return best;
    }
    for (let f = 0; f < t.length; f += 3) {
      const i = t[f],
        j = t[f + 1],
        k = t[f + 2];
      const A = sx[j] * sy[k] - sx[k] * sy[j],
        B = sx[k] * sy[i] - sx[i] * sy[k],
        C = sx[i] * sy[j] - sx[j] * sy[i];
      if (!((A >= 0 && B >= 0 && C >= 0) || (A <= 0 && B <= 0 && C <= 0)) || A + B + C === 0) continue;
      const w = (A + B + C) / (A / sw[i] + B / sw[j] + C / sw[k]);
      if (w > 0 && w < depth) {
        depth = w;
        best = A * A >= B * B && A * A >= C * C ? i : B * B >= C * C ? j : k;
      }
    }
    return best;
  }

  // Where a vertex is drawn, in CSS pixels.
  where(i) {
    const { camera: m } = this.matrices(),
      [x, y, z] = this.at.subarray(3 * i, 3 * i + 3);
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    return [
      (((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) / 2) * this.canvas.clientWidth,
      ((1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) / 2) * this.canvas.clientHeight,
    ];
  }
}
