// view.js - draws one surface with raw WebGL2: colours by value, isolines, edges, a mark at the source; picks vertices
"use strict";

// Viridis as a polynomial of degree six (coefficients of the public domain, fitted by Matt Zucker).
const VIRIDIS = [
  [0.2777273272, 0.0054073445, 0.3340998053],
  [0.1050930431, 1.4046135299, 1.3845901626],
  [-0.3308618287, 0.2148475595, 0.095095163],
  [-4.634230499, -5.7991009734, -19.3324409563],
  [6.2282699363, 14.1799333668, 56.6905526007],
  [4.7763849977, -13.7451453777, -65.3530326334],
  [-5.4354558559, 4.6458526122, 26.3124352496],
];

function viridis(s) {
  return [0, 1, 2].map((c) => {
    let v = 0;
    for (let k = 6; k >= 0; k--) v = v * s + VIRIDIS[k][c];
    return Math.max(0, Math.min(255, Math.round(255 * v)));
  });
}

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
out vec4 colour;
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
  vec3 base = s < -0.5 ? vec3(0.62) : texture(map, vec2(clamp(s, 0.002, 0.998), 0.5)).rgb;
  if (flat_colour > 0.5) { colour = vec4(0.06, 0.07, 0.09, 0.28); return; }
  float key = max(0.0, dot(m, normalize(vec3(-0.45, 0.65, 0.65)))), fill = 0.5 + 0.5 * m.y;
  float shine = pow(max(0.0, dot(m, normalize(vec3(-0.3, 0.5, 1.0)))), 40.0);
  vec3 lit = base * (0.6 + 0.16 * fill + 0.4 * key) + vec3(0.03, 0.035, 0.045) * (0.4 + fill + key) + 0.06 * shine;
  float luma = dot(base, vec3(0.3, 0.59, 0.11));
  vec3 line = luma > 0.3 ? lit * 0.35 : lit + vec3(0.34);
  colour = vec4(mix(lit, line, 0.75 * ink), 1.0);
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
    this.mark = this.program(MARK_VERTEX, MARK_FRAGMENT);
    this.buffers = {
      at: gl.createBuffer(),
      normal: gl.createBuffer(),
      value: gl.createBuffer(),
      tri: gl.createBuffer(),
      edge: gl.createBuffer(),
    };
    this.map = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    const ramp = new Uint8Array(1024);
    for (let i = 0; i < 256; i++) ramp.set([...viridis(i / 255), 255], 4 * i);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, ramp);
    for (const [k, v] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
    ])
      gl.texParameteri(gl.TEXTURE_2D, k, v);
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
    for (let i = 0; i < 3 * n; i++) at[i] = (xyz[i] - mid[i % 3]) / this.radius;
    this.at = at;
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
    gl.clearColor(0.933, 0.929, 0.914, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.n) return;
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(surface.p);
    gl.uniformMatrix4fv(surface.camera, false, camera);
    gl.uniformMatrix3fv(surface.turn, false, turn);
    gl.uniform2f(surface.rule, ...this.rule);
    gl.uniform1f(surface.lines, this.lines && this.tri.length ? 1 : 0);
    gl.uniform1f(surface.zero, this.zero ? 1 : 0);
    gl.uniform1f(surface.points, this.tri.length ? 0 : 1);
    gl.uniform1f(surface.flat_colour, 0);
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
    this.frames++;
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
