// page.js - what is asked for, what is known already, and what the two workers do next
"use strict";

// Two workers hold the same surface. The first one answers clicks: it keeps the factors for the time on the slider, so that
// a column costs some milliseconds. The second one works ahead: columns, signatures or smoothed surfaces for ten times at
// once, the times near the slider first. Everything that is shown is an answer of the library at exactly the slider's time.

const $ = (id) => document.getElementById(id);
const DIRECT = 2,
  KRYLOV = 3; // hd_method
const CHUNK = 10; // times of one call: ten make a decade
const EVIDENCE = ["", "proven", "measured", "estimated"];
const NAMES = {
  kernel: "Heat kernel from the source (per area)",
  distance: "Diffusion distance to the source",
  geodesic: "Distance along the surface",
  signature: "Heat kernel signature (per area)",
  smooth: "Displacement of the surface",
};
const MODES = {
  kernel: "heat kernel",
  distance: "diffusion distance",
  geodesic: "geodesic distance",
  signature: "signature",
  smooth: "smoothing",
};
const ABOUT = {
  kernel: "How much heat is at each place after the time t, if all of it began at one vertex.",
  distance:
    "How differently heat spreads from here and from the source. Noise and thin bridges hardly change it.",
  geodesic: "The length of the shortest way along the surface to the source.",
  signature:
    "How much heat stays where it was put: tips keep it, flat places lose it. Bending hardly changes it.",
  smooth: "The surface itself after the time t. Noise goes first, shapes later.",
};
const STAGES = {
  neighbours: "finding neighbours",
  assemble: "assembling",
  "flip edges": "flipping edges",
  order: "ordering",
  analyse: "analysing",
  factor: "factorising",
  invert: "inverting",
  precondition: "preparing",
  solve: "solving",
};

const state = {
  mesh: null,
  name: "",
  generation: 0,
  source: 0,
  mode: "kernel",
  at: 0,
  times: [],
  facts: null,
  columns: [],
  signature: [],
  smooth: [],
  geodesic: null, // by time: { values, bound, evidence, how, ms }
  factored: -1,
  shown: null,
  asked: 0,
  failed: new Map(), // what could not be computed on this surface, and why
  log: { kernel: false, signature: true },
  limit: 1e6 * Number((/memory=(\d+)/.exec(location.hash) || [])[1] || 0), // #memory=500: most megabytes of a worker
  settled: 0,
  answers: 0,
};
window.heatdiff = state; // for the console, and for the tests

let view;

// ---- workers ----

const workers = [];

async function startWorkers() {
  const packed = atob($("module").textContent.trim()),
    bytes = Uint8Array.from(packed, (c) => c.charCodeAt(0));
  const module = await WebAssembly.compile(bytes);
  const url = URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" }));
  for (let k = 0; k < 2; k++) {
    const w = {
      thread: new Worker(url),
      job: null,
      queue: [],
      id: 0,
      role: k ? "ahead" : "first",
      progress: null,
    };
    w.thread.onmessage = (e) => hear(w, e.data);
    w.thread.onerror = (e) => say("The computation stopped", e.message || "the worker could not start");
    w.thread.postMessage({ op: "start", module });
    workers.push(w);
  }
}

function give(w, job) {
  w.job = { ...job, id: ++w.id, generation: state.generation, begun: performance.now() };
  w.progress = null;
  const { done, ...plain } = w.job;
  w.thread.postMessage(plain);
}

function hear(w, m) {
  if (m.stage) {
    w.progress = { stage: m.stage, done: m.done };
    showBusy();
    return;
  }
  const job = w.job;
  w.job = w.progress = null;
  if (job.generation === state.generation) {
    const loading = job.op === "shape" || job.op === "file" || job.op === "begin";
    if (m.restarted && !loading) order(w, state.last.order);
    job.done(m);
  }
  step();
}

// A job for each idle worker: what was ordered, else what is wanted most.
function step() {
  for (const w of workers) {
    if (w.job) continue;
    const job = w.queue.shift() || (state.times.length ? wanted(w) : null);
    if (job) give(w, job);
  }
  showBusy();
}

// ---- a new surface ----

// The old shape goes at once, so that nothing is shown under another's name; again: it is the same shape.
function load(surface, name, again = false) {
  state.generation++;
  Object.assign(state, { times: [], failed: new Map(), factored: -1 });
  forgetAnswers();
  hideAlert();
  if (!again) {
    view.clear();
    showNoNumbers();
    $("mesh").textContent = `reading ${name} …`;
  }
  for (const w of workers) w.queue = [];
  order(workers[0], surface, (m) => loaded(m, name), ready);
  order(workers[1], surface);
  step();
}

// A surface and its Laplacian for one worker. What it answers counts once, so mostly nobody listens.
function order(w, surface, whenLoaded = () => {}, whenReady = () => {}) {
  if (!surface) return;
  const copy = surface.data ? { ...surface, data: surface.data.slice(0) } : surface;
  w.queue.unshift(
    { ...copy, done: whenLoaded },
    { op: "begin", mend: $("mend").checked, limit: state.limit, done: whenReady },
  );
}

function loaded(m, name) {
  if (m.status < 0) return refuse(`Could not read ${name}`, m.text);
  Object.assign(state, { next: m.mesh, name });
  view.source = -1;
  view.setMesh(m.mesh.xyz, m.mesh.tri, 0);
  if (m.mesh.tri.length) showBare(m.mesh);
  else view.clear(); // the size of the dots is not known yet
  $("mesh").textContent = `${m.mesh.n.toLocaleString("en")} vertices …`;
}

// A surface that cannot be used leaves the page as it is, but for the message: the last surface is loaded again.
function refuse(title, text) {
  for (const w of workers) w.queue = [];
  const again = state.last;
  if (again && again.order !== state.order) {
    state.order = again.order;
    $("shape").value = again.choice;
    load(again.order, again.name);
    fileOption();
  }
  say(title, text);
}

function ready(m) {
  if (m.status < 0) return refuse(`Cannot compute on ${state.name}`, m.text);
  const keep = state.mesh === null ? -1 : state.keepSource ? state.source : -1;
  const [h, area, active, components, border, nonmanifold, leftOut, , , start] = m.facts;
  const mesh = (state.mesh = state.next || state.mesh);
  state.facts = { h, area, active, components, border, nonmanifold, leftOut };
  state.last = { order: state.order, name: state.name, choice: $("shape").value };
  if (state.order.op === "file") state.fileOrder = state.order;
  state.keepSource = false;
  const count = Math.max(12, Math.ceil(3 * Math.log2(area / (h * h))) + 1);
  const ahead = state.times.length ? 0 : 3;
  state.shownCount = count;
  state.times = Array.from({ length: count + ahead }, (_, i) => ((h * h) / 2) * 2 ** (i / 3));
  const slider = $("time"),
    was = Number(slider.value) / Math.max(1, Number(slider.max));
  slider.max = count - 1;
  state.at = state.everShown ? Math.round(was * (count - 1)) : Math.round(0.62 * (count - 1));
  state.everShown = true;
  slider.value = state.at;
  state.source = keep >= 0 && keep < mesh.n ? keep : start;
  $("source").max = mesh.n - 1;
  view.setMesh(mesh.xyz, mesh.tri, h);
  showNothingYet();
  describeMesh();
  state.asked = performance.now();
  for (const input of document.querySelectorAll("[value=geodesic]")) input.disabled = mesh.tri.length === 0;
  if (!mesh.tri.length && state.mode === "geodesic") setMode("kernel");
  show();
}

function forgetAnswers() {
  Object.assign(state, { columns: [], signature: [], smooth: [], geodesic: null, shown: null });
}

function describeMesh() {
  const { mesh, facts } = state,
    k = (x) => x.toLocaleString("en");
  const parts = [`${k(mesh.n)} vertices`, mesh.nFaces ? `${k(mesh.nFaces)} faces` : "no faces: points"];
  if (facts.components > 1) parts.push(`${k(facts.components)} pieces`);
  if (facts.border && mesh.nFaces) parts.push(`${k(facts.border)} border edges`);
  if (facts.nonmanifold && mesh.nFaces) parts.push(`${k(facts.nonmanifold)} edges with three faces or more`);
  if (facts.leftOut && mesh.nFaces) parts.push(`${k(facts.leftOut)} bad faces left out`);
  if (mesh.n > facts.active) parts.push(`${k(mesh.n - facts.active)} vertices without area`);
  $("mesh").textContent = parts.join(", ");
}

// ---- what is wanted ----

const usesSource = () => state.mode !== "signature" && state.mode !== "smooth";

// The diffusion distance at t stands on the kernel at 2t, three steps up.
const needed = () => state.at + (state.mode === "distance" ? 3 : 0);
const chunkOf = (i) => Math.floor(i / CHUNK);
const chunkTimes = (c) => state.times.slice(CHUNK * c, CHUNK * (c + 1));

// The chunk nearest to time index i in which something is missing; -1: none.
function missing(store, i, onlyHere) {
  const last = chunkOf(state.times.length - 1),
    here = chunkOf(i),
    ahead = i % CHUNK >= CHUNK / 2 ? 1 : -1;
  const order = [here];
  for (let d = 1; d <= last && !onlyHere; d++) order.push(here + ahead * d, here - ahead * d);
  for (const c of order) {
    if (c < 0 || c > last) continue;
    for (let k = CHUNK * c; k < Math.min(state.times.length, CHUNK * (c + 1)); k++)
      if (!store[k] || store[k].quick) return c;
  }
  return -1;
}

const busyWith = (op, c) =>
  workers.some(
    (w) =>
      w.job &&
      w.job.op === op &&
      w.job.chunk === c &&
      w.job.generation === state.generation &&
      (op !== "columns" || w.job.source === state.source),
  );

function chunkJob(op, c) {
  if (c < 0 || state.failed.has(op) || busyWith(op, c)) return null;
  const source = state.source;
  return {
    op,
    chunk: c,
    t: chunkTimes(c),
    method: KRYLOV,
    source,
    done: (m) => {
      if (m.status < 0) return fail(m, op);
      if (op === "columns" && source !== state.source) return;
      const n = state.mesh.n,
        k = m.facts,
        count = chunkTimes(c).length;
      for (let q = 0; q < count; q++) {
        const values = op === "smooth" ? coordinates(m.out, n, count, q) : m.out.subarray(n * q, n * (q + 1));
        state[op][CHUNK * c + q] = { values, bound: k[0], evidence: k[1], ms: m.ms, many: count };
      }
      arrived(op, m);
    },
  };
}

function coordinates(out, n, count, q) {
  const xyz = new Float32Array(3 * n);
  for (let c = 0; c < 3; c++) {
    const from = out.subarray(n * (c * count + q), n * (c * count + q + 1));
    for (let i = 0; i < n; i++) xyz[3 * i + c] = from[i];
  }
  return xyz;
}

function columnJob(i, only_prepare) {
  const source = state.source;
  if (state.failed.has("direct")) return null;
  return {
    op: "columns",
    chunk: -1,
    t: [state.times[i]],
    method: DIRECT,
    source,
    quiet: only_prepare,
    done: (m) => {
      if (m.status < 0) return fail(m, "direct");
      state.factored = i;
      if (source !== state.source || state.columns[i]) return;
      state.columns[i] = {
        values: m.out,
        bound: m.facts[0],
        evidence: m.facts[1],
        ms: m.ms,
        many: 1,
        quick: true,
      };
      arrived("columns", m);
    },
  };
}

function geodesicJob() {
  const source = state.source;
  if (state.failed.has("geodesic")) return null;
  return {
    op: "geodesic",
    source,
    done: (m) => {
      if (m.status < 0) return fail(m, "geodesic");
      if (source !== state.source) return;
      state.geodesic = { values: m.out, residual: m.facts[6], ms: m.ms, many: 1 };
      arrived("geodesic", m);
    },
  };
}

function wanted(w) {
  const { mode } = state,
    i = needed(),
    onColumns = mode === "kernel" || mode === "distance";
  if (w.role === "first") {
    if (mode === "geodesic") return state.geodesic ? null : geodesicJob();
    if (!onColumns) return null;
    if (!state.columns[i] && state.factored === i) return columnJob(i);
    if (!state.columns[i] && workers[1].job && workers[1].job.op !== "columns")
      return chunkJob("columns", missing(state.columns, i, true));
    if (state.factored !== i && (state.factored < 0 || performance.now() - state.settled > 250))
      return columnJob(i, true);
    return null;
  }
  if (mode === "signature") return chunkJob("signature", missing(state.signature, i));
  if (mode === "smooth") return chunkJob("smooth", missing(state.smooth, i));
  if (mode === "geodesic") return null;
  const here = chunkJob("columns", missing(state.columns, i, true));
  if (here || mode === "kernel") return here || chunkJob("columns", missing(state.columns, i));
  // The difference of two kernels asks for both at 2t: the signature there, once for all sources.
  return (
    chunkJob("signature", missing(state.signature, i, true)) ||
    chunkJob("columns", missing(state.columns, i)) ||
    chunkJob("signature", missing(state.signature, i))
  );
}

// Most likely memory: the rest of the page goes on without this kind of answer, and another way may still answer.
function fail(m, what) {
  state.failed.set(what, m.text);
  if (what === "direct") state.factored = -1;
  showFailure();
}

// What must fail before a mode has no answer: all of one of these lists.
const WAYS = {
  kernel: [["columns", "direct"]],
  distance: [["columns", "direct"], ["signature"]],
  geodesic: [["geodesic"]],
  signature: [["signature"]],
  smooth: [["smooth"]],
};

// Said only while it keeps what is asked from being answered.
function showFailure() {
  const { failed, mode } = state,
    stuck = !answerNow() && WAYS[mode].find((ways) => ways.every((way) => failed.has(way)));
  if (stuck) say(`No ${MODES[mode]} for this surface`, failed.get(stuck[0]), "failure");
  else if ($("alert").dataset.kind === "failure") hideAlert();
}

function arrived(op, m) {
  state.answers++;
  if (!state.shown) show();
  else showReady();
}

// ---- what is shown ----

function distanceAt(i) {
  const c = state.columns[i],
    d = state.signature[i],
    n = state.mesh.n,
    s = state.source;
  if (!c || !d) return null;
  const values = new Float64Array(n);
  let most = 0,
    top = 0,
    peak = 0,
    lost = 0;
  for (let j = 0; j < n; j++) {
    const square = d.values[s] - 2 * c.values[j] + d.values[j];
    values[j] = j === s || square < 0 ? 0 : Math.sqrt(square);
    if (values[j] > most) most = values[j];
    if (d.values[j] > top) top = d.values[j];
    if (Math.abs(c.values[j]) > peak) peak = Math.abs(c.values[j]);
  }
  const square = 2 * (d.bound * top + c.bound * peak); // bound on the error of d^2
  for (let j = 0; j < n; j++) if (j !== s && values[j] * values[j] < 10 * square) lost++;
  const bound = (Math.sqrt(most * most + square) - most) / most;
  return { values, bound, evidence: Math.max(c.evidence, d.evidence), lost, ms: c.ms, many: c.many };
}

function displacement(answer) {
  const a = state.mesh.xyz,
    b = answer.values,
    values = new Float64Array(state.mesh.n);
  for (let i = 0; i < values.length; i++)
    values[i] = Math.hypot(b[3 * i] - a[3 * i], b[3 * i + 1] - a[3 * i + 1], b[3 * i + 2] - a[3 * i + 2]);
  return { ...answer, values, xyz: b };
}

// The answer to what is asked now, or null while it is not known.
function answerNow() {
  const { mode } = state,
    i = needed();
  if (mode === "geodesic") return state.geodesic;
  if (mode === "distance") return distanceAt(i);
  if (mode === "smooth") return state.smooth[i] ? displacement(state.smooth[i]) : null;
  return (mode === "signature" ? state.signature : state.columns)[i] || null;
}

// Positions on the colour scale, the isolines' rule and the ticks.
function scaleOf(values, log) {
  let lo = Infinity,
    hi = -Infinity;
  for (let i = 0; i < values.length; i++) {
    const v = values[i];
    if (v < Infinity && v > -Infinity) {
      if (v < lo) lo = v;
      if (v > hi) hi = v;
    }
  }
  if (!(lo <= hi)) lo = hi = 0;
  if (log && hi > 0) {
    const top = Math.log10(hi),
      bottom = Math.max(top - 8, Math.log10(Math.max(lo, 1e-300)));
    lo = bottom < top - 1e-9 ? bottom : top - 1;
    hi = top;
  } else {
    log = false;
    if (
      state.mode === "kernel" ||
      state.mode === "distance" ||
      state.mode === "geodesic" ||
      state.mode === "smooth"
    )
      lo = Math.min(0, lo);
    if (!(hi - lo > 1e-9 * Math.abs(hi))) {
      const mid = (hi + lo) / 2;
      lo = mid - 0.5 * (Math.abs(mid) || 1);
      hi = mid + 0.5 * (Math.abs(mid) || 1);
    }
  }
  const span = hi - lo,
    raw = span / (log ? 7 : 8),
    ten = 10 ** Math.floor(Math.log10(raw));
  const stepOf = (x) => (x < 1.5 ? 1 : x < 3.5 ? 2 : x < 7.5 ? 5 : 10);
  const line = stepOf(raw / ten) * ten,
    s = new Float32Array(values.length);
  for (let i = 0; i < s.length; i++) {
    const v = values[i];
    if (!(v < Infinity)) s[i] = -1;
    else s[i] = log ? Math.max(0, ((v > 0 ? Math.log10(v) : lo) - lo) / span) : (v - lo) / span;
  }
  const ticks = [],
    every = line * Math.max(1, Math.ceil(span / line / 5 - 0.2));
  for (let k = Math.ceil(lo / every - 1e-6); k * every <= hi + 1e-6 * span; k++)
    ticks.push([(k * every - lo) / span, k * every]);
  return { s, lo, hi, line, log, ticks, rule: [span / line, lo / line] };
}

function number(v, digits = 3) {
  if (v === 0 || Math.abs(v) < 1e-300) return "0";
  if (!isFinite(v)) return "no path";
  return Math.abs(v) >= 1e-3 && Math.abs(v) < 1e5
    ? String(Number(v.toPrecision(digits)))
    : v
        .toExponential(digits - 1)
        .replace("e+", "e")
        .replace("-", "−");
}

function show() {
  const answer = answerNow(),
    { mode } = state;
  showControls();
  showFailure();
  if (!answer) {
    state.shown = null;
    step();
    return showReady();
  }
  const scale = scaleOf(answer.values, Boolean(state.log[mode]));
  if (answer.xyz) view.setPositions(answer.xyz);
  else if (view.moved) view.setPositions(state.mesh.xyz);
  view.moved = Boolean(answer.xyz);
  view.source = usesSource() ? state.source : -1;
  view.setValues(scale.s, scale.rule, scale.log);
  state.shown = { mode, at: state.at, source: state.source, scale, ...answer };
  drawLegend(scale, mode);
  showFacts(answer);
  step();
  showReady();
}

// The bare surface, until there is an answer of another kind.
function showNothingYet() {
  view.setPositions(state.mesh.xyz);
  view.moved = false;
  view.source = usesSource() ? state.source : -1;
  showBare(state.mesh);
  showNoNumbers();
}

const showBare = (mesh) => view.setValues(new Float32Array(mesh.n).fill(-1), [0, 0.5], false);

function showNoNumbers() {
  $("legend").hidden = true;
  for (const id of ["fact-bound", "fact-time", "fact-ready"]) $(id).textContent = "–";
  $("note").textContent = "";
}

function showControls() {
  const { mode, times, facts } = state;
  $("about").textContent = ABOUT[mode];
  if (!facts || !times.length) return;
  const t = times[state.at],
    noTime = mode === "geodesic",
    noSource = !usesSource(),
    h2 = facts.h ** 2;
  $("time").disabled = noTime;
  $("time-text").textContent = noTime ? "not used" : `t = ${number(t)} = ${number(t / h2)} h²`;
  $("time").setAttribute("aria-valuetext", `${number(t / h2)} squared edge lengths`);
  $("source").disabled = noSource;
  $("source").value = state.source;
  $("hint").textContent = noSource ? "Not used here." : "Click the surface to move it.";
  $("log").checked = Boolean(state.log[mode]);
  $("log-label").style.visibility = mode === "kernel" || mode === "signature" ? "visible" : "hidden";
  $("mend-label").hidden = !state.mesh.tri.length;
}

function drawLegend(scale, mode) {
  const bar = $("bar"),
    g = bar.getContext("2d");
  for (let x = 0; x < bar.width; x++) {
    g.fillStyle = `rgb(${colourOf(x / (bar.width - 1))})`;
    g.fillRect(x, 0, 1, bar.height);
  }
  if (view.lines && state.mesh.tri.length)
    for (let k = Math.ceil(scale.lo / scale.line); k * scale.line <= scale.hi; k++) {
      const s = (k * scale.line - scale.lo) / (scale.hi - scale.lo);
      if (s <= 0.004 || s >= 0.996) continue;
      g.fillStyle = "rgba(0,0,0,0.6)";
      g.fillRect(Math.round(s * bar.width) - 1, 0, 2, bar.height);
    }
  $("legend-name").textContent = NAMES[mode] + (scale.log ? ", logarithmic" : "");
  const places = Math.max(0, -Math.floor(Math.log10(scale.line) + 1e-9));
  $("ticks").replaceChildren(
    ...scale.ticks.map(([s, v]) => {
      const tick = document.createElement("span");
      tick.style.left = `${100 * s}%`;
      tick.textContent = scale.log
        ? number(10 ** v, 2)
        : places <= 4 && Math.abs(scale.hi) < 1e5
          ? v.toFixed(places).replace("-", "−")
          : number(v);
      return tick;
    }),
  );
  $("legend").hidden = false;
}

function showFacts(a) {
  const bound = a.bound === undefined ? null : a.bound;
  $("fact-bound").textContent =
    bound === null
      ? `residual ${number(a.residual, 2)}`
      : bound < 1e-2
        ? `${number(bound, 2)} (${EVIDENCE[a.evidence]})`
        : "says little here";
  const took = performance.now() - state.asked;
  $("fact-time").textContent = `${took < 10 ? took.toFixed(1) : Math.round(took)} ms`;
  $("fact-time").title = `${a.many > 1 ? `${a.many} times` : "one time"} computed in ${a.ms.toFixed(1)} ms`;
  const notes = {
    kernel: "The bound is relative to the largest value.",
    geodesic: "The heat method is itself off by about the edge length: one to a few percent.",
    signature: "The bound is relative to the largest value.",
    distance: "The bound is relative to the largest distance.",
    smooth: "Drawn at one size; the saved surface shrinks as it really does.",
  };
  $("note").textContent =
    notes[state.mode] +
    (state.failed.has("direct") && usesSource() && state.mode !== "geodesic"
      ? " Factors for quick clicks do not fit in the memory here, so each click takes longer."
      : "") +
    (a.lost ? ` ${a.lost.toLocaleString("en")} distances are too small to be sure of.` : "");
  state.took = took;
}

// How many of the slider's times are known for what is shown.
function showReady() {
  const { mode, times, shownCount } = state;
  if (!times.length) return;
  let known = 0;
  for (let i = 0; i < shownCount; i++) {
    const ok =
      mode === "distance"
        ? state.columns[i + 3] && state.signature[i + 3]
        : mode === "signature"
          ? state.signature[i]
          : mode === "smooth"
            ? state.smooth[i]
            : state.columns[i];
    if (ok) known++;
  }
  state.known = known;
  $("fact-ready").textContent =
    mode === "geodesic" ? (state.geodesic ? "yes" : "–") : `${known} of ${shownCount} times`;
}

// Only what takes longer than a blink is announced.
function showBusy() {
  const now = performance.now();
  const slow = workers.filter((w) => w.job && now - w.job.begun > 150 && !w.job.quiet);
  const waiting = slow.find((w) => !state.shown && w.progress) || slow.find((w) => w.progress);
  $("busy").hidden = !waiting;
  if (waiting) {
    const what =
      { signature: "Signatures: ", smooth: "Smoothing: ", columns: "Heat: ", geodesic: "Distances: " }[
        waiting.job.op
      ] || "Surface: ";
    $("busy-text").textContent = what + (STAGES[waiting.progress.stage] || waiting.progress.stage);
    $("busy-bar").value = waiting.progress.done;
  }
  const idle = workers.every((w) => !w.job && !w.queue.length);
  document.body.dataset.idle = idle ? "yes" : "no";
}

function say(title, text, kind = "news") {
  $("alert").dataset.kind = kind;
  $("alert-title").textContent = title;
  $("alert-text").textContent = text;
  $("alert").hidden = false;
}

const hideAlert = () => {
  $("alert").hidden = true;
};

// ---- input ----

function setSource(i) {
  const { mesh } = state;
  if (!mesh || !(i >= 0 && i < mesh.n) || !state.times.length) return;
  state.source = i;
  state.asked = performance.now();
  Object.assign(state, { columns: [], geodesic: null });
  show();
}

function setTime(i) {
  state.at = i;
  state.asked = state.settled = performance.now();
  show();
  clearTimeout(setTime.later);
  setTime.later = setTimeout(step, 300);
}

function setMode(mode) {
  state.mode = mode;
  document.querySelector(`[name=mode][value=${mode}]`).checked = true;
  state.asked = performance.now();
  if (!state.times.length) return;
  if (!answerNow()) showNothingYet();
  show();
}

function setTheme(theme) {
  document.documentElement.dataset.theme = view.theme = theme;
  $("dark").checked = theme === "dark";
  view.draw();
}

// Another axis of the file points up.
function setUp(axis) {
  view.up = axis;
  if (state.mesh && view.n) view.setPositions((state.shown && state.shown.xyz) || state.mesh.xyz);
}

// The list offers the last file that could be read.
function fileOption() {
  const option = document.querySelector("#shape [value=file]");
  option.hidden = !state.fileOrder;
  if (state.fileOrder) option.textContent = state.fileOrder.name;
}

async function loadFile(file) {
  if (!file) return;
  state.order = { op: "file", name: file.name, data: await file.arrayBuffer() };
  const option = document.querySelector("#shape [value=file]");
  option.textContent = file.name;
  option.hidden = false;
  $("shape").value = "file";
  load(state.order, file.name);
}

function loadShape() {
  const choice = $("shape").value;
  if (choice === "file") {
    state.order = state.fileOrder;
    return load(state.order, state.order.name);
  }
  const [which, n] = choice.split(":").map(Number);
  state.order = { op: "shape", which, n };
  load(state.order, $("shape").selectedOptions[0].textContent);
}

function listenToCanvas() {
  const canvas = $("view"),
    touches = new Map();
  let start = null,
    apart = 0;
  const place = (e) => {
    const r = canvas.getBoundingClientRect();
    return [e.clientX - r.left, e.clientY - r.top];
  };
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    touches.set(e.pointerId, place(e));
    start = touches.size === 1 ? { at: place(e), moved: false } : null;
    apart = 0;
    $("hover").hidden = true;
  });
  canvas.addEventListener("pointermove", (e) => {
    if (!touches.has(e.pointerId)) return hover(place(e), e);
    const was = touches.get(e.pointerId),
      now = place(e);
    touches.set(e.pointerId, now);
    if (touches.size === 2) {
      const [a, b] = [...touches.values()],
        d = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (apart) zoom(d / apart);
      apart = d;
    } else if (start) {
      if (Math.hypot(now[0] - start.at[0], now[1] - start.at[1]) > (e.pointerType === "touch" ? 9 : 4))
        start.moved = true;
      if (start.moved) {
        canvas.classList.add("turning");
        turn((now[0] - was[0]) * 0.008, (now[1] - was[1]) * 0.008);
      }
    }
  });
  const end = (e) => {
    touches.delete(e.pointerId);
    canvas.classList.remove("turning");
    if (start && !start.moved && e.type === "pointerup") click(place(e));
    start = null;
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("pointerleave", () => {
    $("hover").hidden = true;
  });
  canvas.addEventListener(
    "wheel",
    (e) => {
      e.preventDefault();
      zoom(Math.exp(-e.deltaY * 0.0012));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (e) => {
    const key = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[
      e.key
    ];
    if (key) turn(...key);
    else if (e.key === "+" || e.key === "=") zoom(1.15);
    else if (e.key === "-") zoom(1 / 1.15);
    else return;
    e.preventDefault();
  });
}

function click(at) {
  if (!state.mesh || !usesSource()) return;
  const i = view.pick(...at);
  if (i >= 0) setSource(i);
}

let hoverLater = 0;
function hover(at, e) {
  if (e.pointerType === "touch" || hoverLater) return;
  hoverLater = requestAnimationFrame(() => {
    hoverLater = 0;
    const label = $("hover"),
      shown = state.shown;
    const i = shown && state.mesh.n <= 300000 ? view.pick(...at) : -1;
    label.hidden = i < 0;
    if (i < 0) return;
    label.textContent = `${i}: ${number(shown.values[i], 4)}`;
    label.style.transform = `translate(${Math.min(at[0] + 14, $("view").clientWidth - 130)}px, ${Math.max(4, at[1] - 30)}px)`;
  });
}

function turn(dx, dy) {
  view.yaw += dx;
  view.pitch = Math.max(-1.5, Math.min(1.5, view.pitch + dy));
  view.draw();
}

function zoom(by) {
  view.zoom = Math.max(0.4, Math.min(12, view.zoom * by));
  view.draw();
}

// ---- saving ----

function save(blob, name) {
  const a = document.createElement("a");
  a.href = URL.createObjectURL(blob);
  a.download = name;
  a.click();
  setTimeout(() => URL.revokeObjectURL(a.href), 60000);
}

const fileName = (ending) =>
  `${state.name
    .replace(/\.[^.]*$/, "")
    .replace(/[^\w-]+/g, "-")
    .toLowerCase()}-${state.mode}.${ending}`;

// The surface and its legend in one picture.
function picture() {
  view.drawNow();
  const gl = $("view"),
    out = document.createElement("canvas"),
    g = out.getContext("2d"),
    ratio = gl.width / gl.clientWidth;
  out.width = gl.width;
  out.height = gl.height;
  g.drawImage(gl, 0, 0);
  const frame = gl.getBoundingClientRect(),
    box = $("bar").getBoundingClientRect();
  const x = (box.left - frame.left) * ratio,
    y = (box.top - frame.top) * ratio,
    w = box.width * ratio,
    h = box.height * ratio;
  g.drawImage($("bar"), x, y, w, h);
  g.fillStyle = getComputedStyle($("ticks")).color;
  g.font = `${12 * ratio}px system-ui, sans-serif`;
  g.fillText($("legend-name").textContent, x, y - 7 * ratio);
  g.textAlign = "center";
  for (const tick of $("ticks").children)
    g.fillText(tick.textContent, x + (w * parseFloat(tick.style.left)) / 100, y + h + 16 * ratio);
  return out;
}

// Binary PLY: coordinates, the values shown, their colours, triangles.
function ply() {
  const { mesh, shown } = state,
    n = mesh.n,
    f = mesh.tri.length / 3,
    xyz = shown.xyz || mesh.xyz;
  const head = new TextEncoder().encode(
    `ply\nformat binary_little_endian 1.0\ncomment heatdiff: ${NAMES[shown.mode]}, t = ${state.times[shown.at]}, source ${shown.source}\n` +
      `element vertex ${n}\nproperty double x\nproperty double y\nproperty double z\nproperty double quality\n` +
      "property uchar red\nproperty uchar green\nproperty uchar blue\n" +
      `element face ${f}\nproperty list uchar int vertex_indices\nend_header\n`,
  );
  const body = new DataView(new ArrayBuffer(35 * n + 13 * f));
  let p = 0;
  for (let i = 0; i < n; i++) {
    for (let c = 0; c < 3; c++, p += 8) body.setFloat64(p, xyz[3 * i + c], true);
    body.setFloat64(p, shown.values[i], true);
    p += 8;
    for (const c of shown.scale.s[i] < 0 ? [158, 158, 158] : colourOf(shown.scale.s[i]))
      body.setUint8(p++, c);
  }
  for (let k = 0; k < f; k++) {
    body.setUint8(p++, 3);
    for (let c = 0; c < 3; c++, p += 4) body.setInt32(p, mesh.tri[3 * k + c], true);
  }
  return new Blob([head, body.buffer], { type: "application/octet-stream" });
}

// ---- begin ----

function listen() {
  listenToCanvas();
  $("shape").onchange = loadShape;
  $("open").onclick = () => $("file").click();
  $("file").onchange = (e) => {
    loadFile(e.target.files[0]);
    e.target.value = "";
  };
  $("mend").onchange = () => {
    state.keepSource = true;
    if (state.order) load(state.order, state.name, true);
  };
  for (const input of document.querySelectorAll("[name=mode]")) input.onchange = () => setMode(input.value);
  $("time").oninput = (e) => setTime(Number(e.target.value));
  $("source").onchange = (e) =>
    setSource(Math.min(state.mesh.n - 1, Math.max(0, Math.round(Number(e.target.value) || 0))));
  $("lines").onchange = (e) => {
    view.lines = e.target.checked;
    view.draw();
    if (state.shown) drawLegend(state.shown.scale, state.mode);
  };
  $("edges").onchange = (e) => {
    view.edges = e.target.checked;
    view.draw();
  };
  $("log").onchange = (e) => {
    state.log[state.mode] = e.target.checked;
    show();
  };
  $("up").onchange = (e) => setUp(e.target.value);
  const system = matchMedia("(prefers-color-scheme: dark)");
  setTheme(system.matches ? "dark" : "light");
  system.onchange = (e) => setTheme(e.matches ? "dark" : "light");
  $("dark").onchange = (e) => setTheme(e.target.checked ? "dark" : "light");
  $("alert-close").onclick = hideAlert;
  $("save-png").onclick = () =>
    state.shown && picture().toBlob((blob) => save(blob, fileName("png")), "image/png");
  $("save-ply").onclick = () => state.shown && save(ply(), fileName("ply"));
  let depth = 0;
  const isFile = (e) => e.dataTransfer && [...e.dataTransfer.types].includes("Files");
  addEventListener("dragenter", (e) => {
    if (isFile(e)) {
      depth++;
      $("drop").hidden = false;
      e.preventDefault();
    }
  });
  addEventListener("dragover", (e) => {
    if (isFile(e)) e.preventDefault();
  });
  addEventListener("dragleave", (e) => {
    if (isFile(e) && --depth <= 0) {
      depth = 0;
      $("drop").hidden = true;
    }
  });
  addEventListener("drop", (e) => {
    if (!isFile(e)) return;
    e.preventDefault();
    depth = 0;
    $("drop").hidden = true;
    loadFile(e.dataTransfer.files[0]);
  });
}

async function main() {
  try {
    view = new View($("view"));
    $("legend").hidden = true;
    listen();
    await startWorkers();
    loadShape();
  } catch (e) {
    say("This page cannot run here", String(e.message || e));
  }
}

main();
