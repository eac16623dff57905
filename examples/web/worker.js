// worker.js - one session of web.c behind messages {id, op, ...}; answers {id, ms, status, text, facts, out, mesh}
"use strict";
let wasm,
  compiled,
  current = 0,
  told = 0;

const bytes = () => new Uint8Array(wasm.memory.buffer);

function text(p) {
  const u = bytes();
  let end = p;
  while (u[end]) end++;
  return new TextDecoder().decode(u.slice(p, end));
}

function put(data) {
  const p = wasm.page_alloc(data.length + 1);
  if (!p) throw new Error("no memory");
  bytes().set(data, p);
  bytes()[p + data.length] = 0;
  return p;
}

const doubles = (p, n) => new Float64Array(wasm.memory.buffer, p, n).slice();

function progress(stage, done) {
  const now = performance.now();
  if (now - told < 40) return;
  told = now;
  postMessage({ id: current, stage: text(stage), done });
}

// A decimal number in memory that ends where its digits do, as strtod reads it; and a number for a message.
const number = (p) => parseFloat(new TextDecoder().decode(bytes().slice(p, p + 1200)));

function digits(x, to, room) {
  const s = String(Number(x.toPrecision(6))).slice(0, room);
  for (let i = 0; i < s.length; i++) bytes()[to + i] = s.charCodeAt(i);
  return s.length;
}

function start() {
  wasm = new WebAssembly.Instance(compiled, { page: { progress, number, digits } }).exports;
  wasm._initialize();
}

function mesh() {
  const n = wasm.page_n(),
    nTri = wasm.page_n_tri();
  const tri = nTri
    ? new Int32Array(wasm.memory.buffer, wasm.page_tri(), 3 * nTri).slice()
    : new Int32Array(0);
  return {
    n,
    nFaces: wasm.page_n_faces(),
    tri,
    xyz: doubles(wasm.page_xyz(), 3 * n),
    format: text(wasm.page_format()),
  };
}

function withTimes(t, ask) {
  const p = put(new Uint8Array(Float64Array.from(t).buffer));
  const status = ask(t.length, p);
  wasm.page_free(p);
  return status;
}

// Each returns [status, number of doubles at page_out()].
const ops = {
  shape: (m) => [wasm.page_shape(m.which, m.n), 0],
  file(m) {
    const data = put(new Uint8Array(m.data)),
      name = put(new TextEncoder().encode(m.name));
    const status = wasm.page_file(data, m.data.byteLength, name);
    wasm.page_free(name);
    return [status, 0];
  },
  begin: (m) => [wasm.page_begin(m.mend ? 1 : 0, m.limit || 0), 0],
  columns: (m) => [
    withTimes(m.t, (k, t) => wasm.page_columns(m.method, k, t, m.source)),
    wasm.page_n() * m.t.length,
  ],
  signature: (m) => [withTimes(m.t, (k, t) => wasm.page_signature(k, t)), wasm.page_n() * m.t.length],
  smooth: (m) => [withTimes(m.t, (k, t) => wasm.page_smooth(k, t)), 3 * wasm.page_n() * m.t.length],
  geodesic: (m) => [wasm.page_geodesic(m.source), wasm.page_n()],
};

onmessage = ({ data: m }) => {
  if (m.op === "start") {
    compiled = m.module;
    start();
    return;
  }
  const begin = performance.now(),
    answer = { id: m.id, status: 0, text: "" },
    give = [];
  current = m.id;
  told = begin;
  try {
    const [status, count] = ops[m.op](m);
    answer.status = status;
    if (status < 0) {
      answer.text = text(wasm.page_text());
    } else if (m.op === "shape" || m.op === "file") {
      answer.mesh = mesh();
      give.push(answer.mesh.xyz.buffer, answer.mesh.tri.buffer);
    } else {
      answer.facts = doubles(wasm.page_facts(), 10);
      if (count) give.push((answer.out = doubles(wasm.page_out(), count)).buffer);
    }
  } catch (e) {
    // a trap: only memory can do that; the module begins anew
    answer.status = -2;
    answer.text = "out of memory: this surface is too large for the browser";
    answer.restarted = true;
    start();
  }
  answer.ms = performance.now() - begin;
  postMessage(answer, give);
};
