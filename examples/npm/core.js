// core.js - surfaces in WebAssembly: checks what it is given, calls module.c, copies answers out
//
// All surfaces share one instance of the module. When the last of them is disposed of, the instance and all of its
// memory go, because the memory of an instance never shrinks.

// ---- words ----

// In the order of the enums in heatdiff.h, whose names they are.
export const WORDS = {
  hd_laplacian_kind: ["default", "fem", "voronoi-cot", "cot", "polygon", "voronoi-exp", "exp"],
  hd_triangulation: ["given", "delaunay", "tufted"],
  hd_border: ["natural", "dirichlet"],
  hd_method: ["auto", "iterative", "direct", "krylov", "local"],
  hd_kernel: ["operator", "symmetric"],
  hd_distance_kind: ["classical", "weighted", "commute", "biharmonic"],
  hd_evidence: ["none", "proven", "measured", "estimated"],
  hd_query: [
    "fields",
    "columns",
    "pairs",
    "diagonal",
    "diagonal-operator",
    "trace",
    "distance",
    "distance-weighted",
    "distance-commute",
    "distance-biharmonic",
    "spectrum",
  ],
};

// Facts, in the order of module.c.
const SURFACE_FACTS = [
  "n",
  "active",
  "components",
  "held",
  "h",
  "area",
  "kind",
  "faces",
  "facesUsed",
  "repeatedCorner",
  "zeroArea",
  "repeatedFace",
  "edges",
  "boundaryEdges",
  "nonManifoldEdges",
  "misorientedEdges",
  "boundaryLoops",
  "inert",
  "negativeWeights",
  "smallestAngle",
  "coincident",
  "notFlat",
];
const REPORT_FACTS = [
  "bound",
  "rational",
  "solver",
  "rounding",
  "local",
  "evidenceRational",
  "evidenceSolver",
  "evidenceRounding",
  "evidenceLocal",
  "boundRelative",
  "lost",
  "smallest",
  "massDrift",
  "residual",
  "method",
  "degree",
  "iterations",
  "factorNonZeros",
  "factorFlops",
  "touched",
];
const GEODESIC_FACTS = ["t", "h", "residualHeat", "residualDistance", "stages", "factorNonZeros"];
const ESTIMATE_FACTS = ["method", "fits", "seconds", "bytes", "bytesMost", "flops", "analysed"];

const named = (names, facts) => Object.fromEntries(names.map((name, i) => [name, facts[i]]));

// ---- errors ----

// What the library refused or could not do. Places that do not apply are undefined.
export class HeatError extends Error {
  constructor(status, text, where = {}) {
    const places = Object.entries(where).filter(([name, at]) => name !== "value" && at >= 0);
    super(text + (places.length ? ` (${places.map((p) => p.join(" ")).join(", ")})` : ""));
    this.name = "HeatError";
    this.status = status;
    for (const [name, at] of places) this[name] = at;
    if (where.value) this.value = where.value;
  }
}

const tag = (x) => Object.prototype.toString.call(x).slice(8, -1);
const isOne = (x, kinds) => kinds.includes(tag(x));
const FLOATS = ["Float32Array", "Float64Array"],
  INTEGERS = ["Uint32Array", "Uint16Array", "Int32Array"];
const LARGEST = 2 ** 31 - 1;

function what(x) {
  if (x === null || x === undefined) return String(x);
  if (typeof x === "string") return JSON.stringify(x);
  return typeof x === "object" || typeof x === "function" ? `of type ${tag(x)}` : String(x);
}

const wrong = (name, x, wanted) => new TypeError(`${name} is ${what(x)}, wanted is ${wanted}`);

function integer(name, x, least, most = LARGEST) {
  if (typeof x !== "number" || !Number.isInteger(x)) throw wrong(name, x, "an integer");
  if (x < least || x > most) throw new RangeError(`${name} is ${x}, wanted is ${least} to ${most}`);
  return x;
}

function choice(name, x, list) {
  const words = WORDS[list],
    at = words.indexOf(x);
  if (at < 0) throw new RangeError(`${name} is ${what(x)}, wanted is one of ${words.join(", ")}`);
  return at;
}

// The options given, over the defaults; names that nobody reads are refused.
function options(given, defaults) {
  if (given === undefined || given === null) return defaults;
  if (tag(given) !== "Object") throw wrong("options", given, "an object");
  for (const name of Object.keys(given))
    if (!(name in defaults))
      throw new TypeError(`there is no option ${name}, only ${Object.keys(defaults).join(", ")}`);
  const set = Object.fromEntries(Object.entries(given).filter(([, x]) => x !== undefined));
  return { ...defaults, ...set };
}

// ---- the instance ----

let compiled = null, // WebAssembly.Module
  home = null, // the instance that new surfaces go to
  listener = null,
  thrown = null; // what a progress function threw

// Whether WebAssembly with 128-bit SIMD is there.
export const supported =
  typeof WebAssembly === "object" &&
  WebAssembly.validate(
    Uint8Array.of(
      0,
      97,
      115,
      109,
      1,
      0,
      0,
      0,
      1,
      5,
      1,
      96,
      0,
      1,
      123,
      3,
      2,
      1,
      0,
      10,
      10,
      1,
      8,
      0,
      65,
      0,
      253,
      15,
      253,
      98,
      11,
    ),
  );

export const compiledModule = () => compiled;

export async function start(source) {
  if (compiled) return;
  if (!supported) throw new Error("heatdiff needs WebAssembly with SIMD, which is not there");
  const module = source instanceof WebAssembly.Module ? source : await WebAssembly.compile(source);
  compiled = compiled || module;
}

function instance() {
  if (!compiled) throw new Error("heatdiff is not ready: await ready (or init) first");
  if (home) return home;
  const text = (p) => {
    const u = new Uint8Array(it.wasm.memory.buffer);
    return String.fromCharCode(...u.subarray(p, u.indexOf(0, p))); // ASCII
  };
  const progress = (stage, done) => {
    if (!listener) return 0;
    try {
      return listener(text(stage), done) === false ? 1 : 0;
    } catch (e) {
      thrown = { e };
      return 1;
    }
  };
  const it = {
    wasm: new WebAssembly.Instance(compiled, { heatdiff: { progress } }).exports,
    surfaces: 0,
    text,
  };
  it.wasm._initialize();
  return (home = it);
}

// Surfaces, their bytes in use, and the bytes of the instance's memory.
export function memory() {
  return {
    surfaces: home ? home.surfaces : 0,
    reserved: home ? home.wasm.memory.buffer.byteLength : 0,
  };
}

// Blocks of the instance's memory that are freed at the end.
class Scope {
  constructor(it) {
    this.it = it;
    this.blocks = [];
  }
  room(bytes) {
    const p = bytes <= 0xffffffff ? this.it.wasm.module_alloc(bytes) >>> 0 : 0;
    if (!p) throw new HeatError("HD_ERR_MEMORY", `not enough memory for ${bytes} bytes`);
    this.blocks.push(p);
    return p;
  }
  put(array) {
    const p = this.room(array.byteLength),
      bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
    new Uint8Array(this.it.wasm.memory.buffer, p, array.byteLength).set(bytes);
    return p;
  }
  get(Kind, p, count) {
    return new Kind(this.it.wasm.memory.buffer, p, count).slice();
  }
  keep() {
    this.blocks = [];
  }
  end() {
    for (const p of this.blocks) this.it.wasm.module_free(p);
  }
}

// Runs f with a scope and a progress function. A trap leaves an instance that nobody may enter again.
function run(it, progress, f) {
  if (progress !== undefined && progress !== null && typeof progress !== "function")
    throw wrong("progress", progress, "a function");
  if (listener) throw new Error("heatdiff is at work: a progress function cannot ask it for more");
  const scope = new Scope(it);
  listener = progress || null;
  try {
    return f(scope);
  } catch (e) {
    if (!(e instanceof WebAssembly.RuntimeError)) throw e;
    it.broken = true;
    if (home === it) home = null;
    throw new HeatError("HD_ERR_MEMORY", `the module stopped (${e.message}); its surfaces are lost`);
  } finally {
    listener = null;
    if (!it.broken) scope.end();
  }
}

const facts = (it) => new Float64Array(it.wasm.memory.buffer, it.wasm.module_facts(), 24).slice();

function refuse(it) {
  if (thrown) {
    const { e } = thrown;
    thrown = null;
    throw e;
  }
  const [status, face, vertex, row, column, value] = facts(it);
  const name = it.text(it.wasm.module_status_name(status));
  throw new HeatError(name, it.text(it.wasm.module_text()), { face, vertex, row, column, value });
}

// ---- answers ----

// values: one column of n (or 3 n) numbers after another: for each source or field, for each time.
export class Answer {
  constructor(values, length, times, report, more = {}) {
    this.values = values;
    this.length = length;
    this.times = times;
    this.report = report;
    Object.assign(this, more);
  }
  // Column of a source (or field) and a time, by their places in the lists asked for; a view.
  column(source = 0, time = 0) {
    const many = Math.max(1, this.times.length),
      at = (source * many + time) * this.length;
    if (!(time >= 0 && time < many && source >= 0 && at + this.length <= this.values.length))
      throw new RangeError(`there is no column of source ${source} and time ${time}`);
    return this.values.subarray(at, at + this.length);
  }
}

function report(it, status) {
  const all = named(REPORT_FACTS, facts(it)),
    parts = ["evidenceRational", "evidenceSolver", "evidenceRounding", "evidenceLocal"],
    worst = Math.max(...parts.map((name) => all[name]));
  for (const name of parts) all[name] = WORDS.hd_evidence[all[name]];
  return {
    ...all,
    status: it.text(it.wasm.module_status_name(status)),
    evidence: WORDS.hd_evidence[worst],
    method: WORDS.hd_method[all.method],
    reason: it.text(it.wasm.module_text()),
  };
}

// ---- surfaces ----

const forgotten = typeof FinalizationRegistry === "function" ? new FinalizationRegistry(drop) : null;

function drop(held) {
  if (!held.p || held.it.broken) return;
  held.it.wasm.module_dispose(held.p);
  held.p = 0;
  held.it.surfaces--;
  if (!held.it.surfaces && home === held.it) home = null;
}

function checkMesh(indices, positions, stride) {
  if (!isOne(positions, FLOATS)) throw wrong("positions", positions, "a Float32Array or Float64Array");
  integer("stride", stride, 3);
  if (positions.length % stride)
    throw new RangeError(
      `positions has length ${positions.length}, wanted is a multiple of the stride ${stride}`,
    );
  if (positions.length / stride > LARGEST) throw new RangeError("positions has too many vertices");
  if (indices === null) return;
  if (!isOne(indices, INTEGERS))
    throw wrong("indices", indices, "a Uint32Array or Uint16Array, or null for points");
  if (indices.length % 3)
    throw new RangeError(`indices has length ${indices.length}, wanted is a multiple of three`);
}

export class Surface {
  #held;

  constructor(indices, positions, stride = 3, given = undefined) {
    checkMesh(indices, positions, stride);
    const o = options(given, {
      kind: "default",
      triangulation: "given",
      border: "natural",
      held: null,
      method: "auto",
      memoryLimit: 0,
      progress: null,
    });
    const kind = choice("kind", o.kind, "hd_laplacian_kind"),
      triangulation = choice("triangulation", o.triangulation, "hd_triangulation"),
      border = choice("border", o.border, "hd_border");
    choice("method", o.method, "hd_method");
    if (typeof o.memoryLimit !== "number" || !(o.memoryLimit >= 0))
      throw wrong("memoryLimit", o.memoryLimit, "bytes");
    const n = positions.length / stride,
      held = o.held === null ? new Int32Array(0) : vertices("held", o.held, n);
    const it = instance(),
      size = positions.BYTES_PER_ELEMENT;
    const p = run(it, o.progress, (scope) => {
      const fixed = scope.put(held),
        xyz = scope.put(positions),
        corner = indices ? scope.put(indices) : 0;
      scope.keep(); // the surface takes them over
      scope.blocks.push(fixed);
      return it.wasm.module_create(
        n,
        xyz,
        8 * size,
        stride * size,
        indices ? indices.length / 3 : 0,
        corner,
        indices ? 8 * indices.BYTES_PER_ELEMENT : 32,
        kind,
        triangulation,
        border,
        held.length,
        fixed,
        o.memoryLimit,
      );
    });
    if (!p) refuse(it);
    it.surfaces++;
    this.#held = { it, p };
    if (forgotten) forgotten.register(this, this.#held, this.#held);
    this.info = named(SURFACE_FACTS, facts(it));
    this.info.kind = WORDS.hd_laplacian_kind[this.info.kind];
    for (const name of ["n", "h", "area"]) this[name] = this.info[name];
    this.method = o.method;
  }

  // Frees everything; questions after it are errors. Again: nothing happens.
  dispose() {
    if (forgotten) forgotten.unregister(this.#held);
    drop(this.#held);
  }

  get disposed() {
    return !this.#held.p || Boolean(this.#held.it.broken);
  }

  // Bytes in use for matrices, factors and work, without the copy of the mesh.
  get bytes() {
    return this.disposed ? 0 : this.#held.it.wasm.module_bytes(this.#held.p);
  }

  // call(wasm, p, scope) returns [status, makes the answer]
  #ask(progress, call) {
    if (this.disposed) throw new Error("this surface has been disposed of");
    const { it, p } = this.#held;
    return run(it, progress, (scope) => {
      const [status, answer] = call(it.wasm, p, scope);
      if (status < 0) refuse(it);
      return answer(it, status);
    });
  }

  #columns(progress, length, count, times, call) {
    return this.#ask(progress, (wasm, p, scope) => {
      const many = Math.max(1, times.length) * count,
        out = scope.room(8 * length * many),
        t = scope.put(times);
      const more = {},
        status = call(wasm, p, scope, t, out, more);
      return [
        status,
        (it) =>
          new Answer(scope.get(Float64Array, out, length * many), length, times, report(it, status), more),
      ];
    });
  }

  // A time: a number, "10h2" (times h squared), "auto:8", or a list of numbers and such words.
  times(t) {
    if (typeof t === "string" && /^auto(:\d+)?$/.test(t)) {
      const count = integer("t", Number(t.slice(5) || 1), 1, 10000);
      return this.#ask(null, (wasm, p, scope) => {
        const at = scope.room(8 * count);
        return [wasm.module_times(p, count, at), () => scope.get(Float64Array, at, count)];
      });
    }
    const list = Array.isArray(t) || isOne(t, FLOATS) ? Array.from(t) : [t];
    if (!list.length) throw wrong("t", t, "at least one time");
    return Float64Array.from(list, (x) => {
      const word = typeof x === "string" ? /^(\d*\.?\d+(?:e[-+]?\d+)?)(h2)?$/.exec(x) : null;
      const number = word ? Number(word[1]) * (word[2] ? this.h ** 2 : 1) : x;
      if (typeof number !== "number") throw wrong("t", x, 'a number, "10h2", "auto:8", or a list of them');
      if (!Number.isFinite(number) || number < 0)
        throw new RangeError(`t is ${x}, wanted is a number from 0 on`);
      return number;
    });
  }

  // The component of each vertex; -1 where there is no mass.
  components() {
    return this.#ask(null, (wasm, p, scope) => {
      const out = scope.room(4 * this.n);
      wasm.module_components(p, out);
      return [0, () => scope.get(Int32Array, out, this.n)];
    });
  }

  // Heat from vertices: columns of K_t ("operator", the default) or k_t ("symmetric").
  columns(sources, t, given) {
    const o = options(given, { kernel: "operator", method: this.method, progress: null });
    const kernel = choice("kernel", o.kernel, "hd_kernel"),
      method = choice("method", o.method, "hd_method"),
      from = vertices("sources", sources, this.n),
      times = this.times(t);
    return this.#columns(o.progress, this.n, from.length, times, (wasm, p, scope, at, out) =>
      wasm.module_columns(p, method, kernel, times.length, at, from.length, scope.put(from), out),
    );
  }

  // A field of your own after the time t: field has n numbers, or several times n.
  apply(field, t, given) {
    const o = options(given, { method: this.method, progress: null });
    const method = choice("method", o.method, "hd_method"),
      times = this.times(t);
    if (!isOne(field, FLOATS)) throw wrong("field", field, "a Float32Array or Float64Array");
    if (!field.length || field.length % this.n)
      throw new RangeError(
        `field has length ${field.length}, wanted is a multiple of the ${this.n} vertices`,
      );
    const count = field.length / this.n,
      f = isOne(field, ["Float64Array"]) ? field : Float64Array.from(field);
    return this.#columns(o.progress, this.n, count, times, (wasm, p, scope, at, out) =>
      wasm.module_apply(p, method, times.length, at, count, scope.put(f), out),
    );
  }

  // The surface, smoothed: for each time a column of 3 n numbers, x y z of one vertex after another.
  smooth(t, given) {
    const o = options(given, { method: this.method, progress: null });
    const method = choice("method", o.method, "hd_method"),
      times = this.times(t),
      n = this.n,
      k = times.length;
    const flat = this.#columns(o.progress, n, 3, times, (wasm, p, scope, at, out) => {
      const xyz = scope.room(24 * n);
      wasm.module_coordinates(p, xyz);
      return wasm.module_apply(p, method, k, at, 3, xyz, out);
    });
    const values = new Float64Array(3 * n * k);
    for (let m = 0; m < k; m++)
      for (let c = 0; c < 3; c++) {
        const from = flat.column(c, m);
        for (let i = 0; i < n; i++) values[3 * (n * m + i) + c] = from[i];
      }
    return new Answer(values, 3 * n, times, flat.report);
  }

  // k_t(x, x) at every vertex, and the trace of K_t for each time.
  signature(t = "auto:16", given) {
    const o = options(given, { kernel: "symmetric", progress: null });
    const kernel = choice("kernel", o.kernel, "hd_kernel"),
      times = this.times(t);
    return this.#columns(o.progress, this.n, 1, times, (wasm, p, scope, at, out, more) => {
      const trace = scope.room(8 * times.length),
        status = wasm.module_signature(p, kernel, times.length, at, out, trace);
      more.trace = scope.get(Float64Array, trace, times.length);
      return status;
    });
  }

  // Diffusion distances from each source to every vertex. "commute" and "biharmonic" have no time.
  distance(sources, t, given) {
    const o = options(given, { kind: "classical", progress: null });
    const kind = choice("kind", o.kind, "hd_distance_kind"),
      from = vertices("sources", sources, this.n),
      times = this.#timeOf(kind, t);
    return this.#columns(o.progress, this.n, from.length, times, (wasm, p, scope, at, out) =>
      wasm.module_distance(p, kind, times.length, at, from.length, scope.put(from), out),
    );
  }

  // Vertices, each farthest from those before it and from those given: vertices is an Int32Array, values their distances.
  sample(count, t, given) {
    const o = options(given, { kind: "classical", given: null, progress: null });
    const kind = choice("kind", o.kind, "hd_distance_kind"),
      before = o.given === null ? new Int32Array(0) : vertices("given", o.given, this.n),
      times = this.#timeOf(kind, t);
    integer("count", count, 1, this.n);
    if (times.length > 1) throw new RangeError(`t has ${times.length} times, wanted is one`);
    return this.#columns(o.progress, count, 1, times, (wasm, p, scope, at, out, more) => {
      const list = scope.room(4 * count);
      const status = wasm.module_sample(
        p,
        kind,
        times[0] || 0,
        before.length,
        scope.put(before),
        count,
        list,
        out,
      );
      more.vertices = scope.get(Int32Array, list, count);
      return status;
    });
  }

  #timeOf(kind, t) {
    if (kind < 2) return this.times(t);
    if (t !== undefined && t !== null)
      throw wrong("t", t, `undefined: ${WORDS.hd_distance_kind[kind]} has no time`);
    return new Float64Array(0);
  }

  // Distances along the surface, from each source or, with nearest, from the nearest of them. Infinity: no path.
  geodesic(sources, given) {
    const o = options(given, { nearest: false, progress: null });
    if (typeof o.nearest !== "boolean") throw wrong("nearest", o.nearest, "true or false");
    const from = vertices("sources", sources, this.n),
      columns = o.nearest ? 1 : from.length;
    return this.#ask(o.progress, (wasm, p, scope) => {
      const out = scope.room(8 * this.n * columns);
      const status = wasm.module_geodesic(p, o.nearest ? 1 : 0, from.length, scope.put(from), out);
      return [
        status,
        (it) => {
          const all = named(GEODESIC_FACTS, facts(it));
          // The heat method's own error is about an edge length; there is no bound.
          const r = {
            ...all,
            status: it.text(it.wasm.module_status_name(status)),
            bound: null,
            error: all.h,
          };
          return new Answer(scope.get(Float64Array, out, this.n * columns), this.n, new Float64Array(0), r);
        },
      ];
    });
  }

  // What a query would take, without running it. count: fields, columns, sources, points or eigenpairs.
  estimate(query, t, count = 1, given) {
    const o = options(given, { method: this.method, progress: null });
    const which = choice("query", query, "hd_query"),
      method = choice("method", o.method, "hd_method"),
      times = t === undefined || t === null ? new Float64Array(0) : this.times(t);
    integer("count", count, 1);
    return this.#ask(o.progress, (wasm, p, scope) => {
      const status = wasm.module_estimate(p, which, method, times.length, scope.put(times), count);
      return [
        status,
        (it) => {
          const all = named(ESTIMATE_FACTS, facts(it));
          const flags = { fits: all.fits === 1, analysed: all.analysed === 1 };
          return {
            ...all,
            ...flags,
            method: WORDS.hd_method[all.method],
            reason: it.text(it.wasm.module_text()),
          };
        },
      ];
    });
  }
}

// One vertex or a list of them, as an Int32Array of ids that exist.
function vertices(name, x, n) {
  const list = typeof x === "number" ? [x] : x;
  if (!Array.isArray(list) && !isOne(list, INTEGERS)) throw wrong(name, x, "a vertex or a list of vertices");
  if (!list.length && name !== "held")
    throw new RangeError(`${name} is empty, wanted is at least one vertex`);
  return Int32Array.from(list, (v) => {
    if (typeof v !== "number" || !Number.isInteger(v)) throw wrong(name, v, "an integer");
    if (v < 0 || v >= n)
      throw new HeatError("HD_ERR_INDEX", `${name}: there is no such vertex, only 0 to ${n - 1}`, {
        vertex: Math.abs(v),
        value: v,
      });
    return v;
  });
}
