// npm.mjs - tests of the installed package, for tests/test_web.py: node --expose-gc npm.mjs ANSWERS.json
//
// ANSWERS has a mesh, and what native code says of it.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { Answer, HeatError, Surface, memory, ready, supported } from "heatdiff";
import { Surface as WorkerSurface, HeatError as WorkerError } from "heatdiff/worker";
import { GeometrySurface, attributeFrom, weld } from "heatdiff/three";

const given = JSON.parse(readFileSync(process.argv[2], "utf8"));
const OCTAHEDRON = Float32Array.of(1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1);
const FACES = Uint16Array.of(0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5);
const tests = [];
const test = (name, f) => tests.push([name, f]);

// ---- numbers ----

function mesh(Positions = Float32Array, Indices = Uint32Array) {
  return [Indices.from(given.indices), Positions.from(given.positions), given.stride];
}

function near(have, want, tolerance, what) {
  assert.equal(have.length, want.length, what);
  const most = want.reduce((a, x) => (Math.abs(x) < Infinity ? Math.max(a, Math.abs(x)) : a), 1e-300);
  want.forEach((x, i) =>
    assert.ok(
      have[i] === x || Math.abs(have[i] - x) <= tolerance * most,
      `${what}, ${i}: ${have[i]} and not ${x}`,
    ),
  );
}

test("before it is ready, surfaces say so", () => {
  const code = 'import { Surface } from "heatdiff"; new Surface(null, new Float32Array(9));';
  assert.throws(
    () => execFileSync(process.execPath, ["--input-type=module", "-e", code], { stdio: "pipe" }),
    /await ready/,
  );
});

test("numbers of native code", () => {
  const s = new Surface(...mesh());
  assert.equal(s.h, given.h);
  near(s.times("auto:3"), given.times, 1e-14, "times");
  for (const { op, args, values } of given.answers) {
    const a = s[op](...args);
    near(op === "sample" ? a.vertices : a.values, values, 1e-12, op);
    assert.equal(a.report.status, "HD_OK");
    if (op !== "geodesic")
      assert.ok(a.report.bound > 0 && a.report.bound < 1e-5 && a.report.evidence !== "none", op);
  }
  assert.deepEqual(new Set(s.components()), new Set([0]));
  s.dispose();
});

test("all kinds of arrays, and points", () => {
  const want = new Surface(...mesh()).columns(3, "10h2").values;
  for (const other of [mesh(Float32Array, Uint16Array), mesh(Float32Array, Int32Array)])
    near(new Surface(...other).columns(3, "10h2").values, want, 0, "indices");
  near(new Surface(...mesh(Float64Array)).columns(3, "10h2").values, want, 1e-5, "doubles");
  const buffer = new Float32Array([7, ...given.positions]).subarray(1); // begins within its buffer
  near(new Surface(mesh()[0], buffer, given.stride).columns(3, "10h2").values, want, 0, "a part of a buffer");
  const points = new Surface(null, mesh()[1], given.stride, { triangulation: "tufted" });
  assert.equal(points.info.faces > 0 && points.columns(3, "10h2").report.bound < 1e-5, true);
  assert.ok(points.geodesic(3).values[3] === 0);
});

test("columns of several sources and times", () => {
  const s = new Surface(FACES, OCTAHEDRON, 3, { kind: "cot" });
  const a = s.columns([0, 4], [0.7, "2h2"]);
  assert.ok(a instanceof Answer);
  assert.equal(a.values.length, 24);
  near(a.column(1, 0), s.columns(4, 0.7, { method: "krylov" }).values, 1e-6, "source 4 at 0.7");
  near(a.column(0, 1), s.columns(0, 2 * s.h ** 2).values, 1e-6, "source 0 at 2h2");
  assert.throws(() => a.column(2, 0), RangeError);
  // L = w (4 I - A), w = 1/sqrt(3), B = I: the truth, and the bound holds
  const [slow, fast] = [Math.exp(-2.8 / Math.sqrt(3)), Math.exp(-4.2 / Math.sqrt(3))];
  const truth = [(1 + 3 * slow + 2 * fast) / 6, (1 - 3 * slow + 2 * fast) / 6, (1 - fast) / 6];
  const u = s.columns(0, 0.7);
  truth.forEach((x, i) => assert.ok(Math.abs(u.values[i] - x) <= u.report.bound * truth[0]));
  assert.ok(u.report.bound < 1e-7);
  const k = s.columns(0, 0.7, { kernel: "symmetric" }).values;
  near(k, u.values, 1e-12, "B is the identity");
  const f = s.apply(Float32Array.of(1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0), 0.7);
  near(f.column(0), s.columns(0, 0.7).values, 1e-6, "a field");
  near(f.column(1), s.columns(4, 0.7).values, 1e-6, "another field");
  near([s.signature(0.7, { kernel: "operator" }).trace[0]], [6 * truth[0]], 1e-7, "trace");
});

test("geodesic to the nearest, and components", () => {
  const two = new Surface(
    Uint32Array.from([...FACES, ...FACES.map((i) => i + 6)]),
    Float32Array.from([...OCTAHEDRON, ...OCTAHEDRON.map((x) => x + 9)]),
  );
  assert.deepEqual([...two.components()], [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
  assert.equal(two.info.components, 2);
  assert.equal(two.geodesic(0).values[7], Infinity);
  assert.ok(two.geodesic([0, 6], { nearest: true }).values.every((d) => d < 5));
  assert.equal(two.geodesic(0).report.bound, null);
  assert.equal(two.geodesic(0).report.error, two.h);
});

test("estimates", () => {
  const s = new Surface(...mesh());
  const e = s.estimate("columns", "10h2", 100);
  assert.ok(e.fits && e.seconds > 0 && e.bytes > 1000 && e.method === "direct" && e.reason.length > 5);
  assert.equal(s.estimate("columns", "10h2", 1, { method: "krylov" }).method, "krylov");
  const small = new Surface(...mesh(), { memoryLimit: s.bytes });
  assert.equal(small.estimate("diagonal", "10h2").fits, false);
  assert.throws(() => small.signature("10h2"), { status: "HD_ERR_MEMORY_LIMIT" });
});

// ---- misuse ----

const bad = (change, at = 0) => Float32Array.from(OCTAHEDRON, (x, i) => (i === at ? change : x));
const s = () => new Surface(FACES, OCTAHEDRON);
const MISUSE = [
  [() => new Surface([0, 1, 2], OCTAHEDRON), TypeError, /indices is of type Array, wanted is a Uint32Array/],
  [() => new Surface(new Float32Array(3), OCTAHEDRON), TypeError, /indices is of type Float32Array/],
  [() => new Surface(undefined, OCTAHEDRON), TypeError, /indices is undefined.*null for points/],
  [
    () => new Surface(FACES.subarray(1), OCTAHEDRON),
    RangeError,
    /indices has length 23, wanted is a multiple of three/,
  ],
  [() => new Surface(FACES, [...OCTAHEDRON]), TypeError, /positions is of type Array/],
  [() => new Surface(FACES, new Uint8Array(18)), TypeError, /positions is of type Uint8Array/],
  [() => new Surface(FACES), TypeError, /positions is undefined/],
  [() => new Surface(FACES, OCTAHEDRON, 2), RangeError, /stride is 2/],
  [() => new Surface(FACES, OCTAHEDRON, 3.5), TypeError, /stride is 3.5, wanted is an integer/],
  [() => new Surface(FACES, OCTAHEDRON, 4), RangeError, /length 18, wanted is a multiple of the stride 4/],
  [() => new Surface(FACES, OCTAHEDRON, 3, "fem"), TypeError, /options is "fem"/],
  [
    () => new Surface(FACES, OCTAHEDRON, 3, { metod: "direct" }),
    TypeError,
    /no option metod, only kind.*method/,
  ],
  [
    () => new Surface(FACES, OCTAHEDRON, 3, { kind: "cotan" }),
    RangeError,
    /kind is "cotan", wanted is one of default, fem/,
  ],
  [() => new Surface(FACES, OCTAHEDRON, 3, { held: [6] }), HeatError, /held: there is no such vertex/],
  [() => new Surface(FACES, OCTAHEDRON, 3, { memoryLimit: "1G" }), TypeError, /memoryLimit is "1G"/],
  [
    () => new Surface(FACES, OCTAHEDRON, 3, { progress: 1 }),
    TypeError,
    /progress is 1, wanted is a function/,
  ],
  [
    () => new Surface(FACES, bad(NaN, 7)),
    HeatError,
    /not finite \(vertex 2\)/,
    { status: "HD_ERR_NOT_FINITE", vertex: 2 },
  ],
  [() => new Surface(FACES, bad(Infinity, 3)), HeatError, /not finite/, { vertex: 1 }],
  [
    () => new Surface(Uint32Array.of(0, 1, 2, 0, 1, 6), OCTAHEDRON),
    HeatError,
    /does not exist \(face 1\)/,
    { status: "HD_ERR_INDEX", face: 1, value: 6 },
  ],
  [() => new Surface(Uint32Array.of(0, 1, 4e9), OCTAHEDRON), HeatError, /does not exist \(face 0\)/],
  [() => new Surface(Uint32Array.of(0, 0, 1), OCTAHEDRON), HeatError, /./, { status: "HD_ERR_EMPTY" }],
  [() => new Surface(null, new Float32Array(0)), HeatError, /./],
  [
    () => s().columns(6, 1),
    HeatError,
    /sources: there is no such vertex/,
    { status: "HD_ERR_INDEX", vertex: 6 },
  ],
  [() => s().columns(-1, 1), HeatError, /no such vertex/],
  [() => s().columns(2 ** 32, 1), HeatError, /no such vertex/],
  [() => s().columns(0.5, 1), TypeError, /sources is 0.5, wanted is an integer/],
  [() => s().columns("0", 1), TypeError, /sources is "0"/],
  [() => s().columns([], 1), RangeError, /sources is empty/],
  [() => s().columns(0), TypeError, /t is undefined/],
  [() => s().columns(0, -1), RangeError, /t is -1/],
  [() => s().columns(0, NaN), RangeError, /t is NaN/],
  [() => s().columns(0, "10 h2"), TypeError, /t is "10 h2", wanted is a number, "10h2"/],
  [() => s().columns(0, []), TypeError, /at least one time/],
  [
    () => s().columns(0, 1, { kernel: "both" }),
    RangeError,
    /kernel is "both", wanted is one of operator, symmetric/,
  ],
  [() => s().apply(new Float64Array(7), 1), RangeError, /field has length 7, wanted is a multiple of the 6/],
  [
    () => s().apply(Float64Array.of(0, 0, NaN, 0, 0, 0), 1),
    HeatError,
    /./,
    { status: "HD_ERR_NOT_FINITE", row: 2 },
  ],
  [() => s().signature(0), HeatError, /./, { status: "HD_ERR_ARGUMENT" }],
  [() => s().distance(0, 1, { kind: "biharmonic" }), TypeError, /biharmonic has no time/],
  [() => s().distance(0, 1, { kind: "eucl" }), RangeError, /kind is "eucl"/],
  [() => s().geodesic(0, { nearest: 1 }), TypeError, /nearest is 1/],
  [() => s().sample(7, 1), RangeError, /count is 7, wanted is 1 to 6/],
  [() => s().estimate("column", 1), RangeError, /query is "column", wanted is one of fields, columns/],
];

test("misuse", () => {
  for (const [f, Kind, text, fields] of MISUSE)
    assert.throws(f, (e) => {
      assert.ok(e instanceof Kind && e.constructor === Kind, `${f}: ${e.stack}`);
      assert.match(e.message, text, String(f));
      for (const [name, x] of Object.entries(fields || {})) assert.equal(e[name], x, `${f}: ${name}`);
      return true;
    });
  assert.ok(MISUSE.length >= 40);
});

// ---- memory, progress, cancelling ----

// Garbage is cleared in a later turn; earlier tests leave some.
async function collected() {
  for (let k = 0; k < 50 && memory().surfaces; k++) {
    gc();
    await new Promise((done) => setTimeout(done, 5));
  }
}

test("memory comes back", async () => {
  await collected();
  assert.deepEqual(memory(), { surfaces: 0, reserved: 0 }, "surfaces that are forgotten go with the garbage");
  const stays = new Surface(FACES, OCTAHEDRON);
  let most = 0;
  for (let k = 0; k < 12; k++) {
    const one = new Surface(...mesh());
    one.signature(["5h2", "50h2"]);
    one.geodesic(1);
    assert.ok(one.bytes > 100000);
    assert.equal(memory().surfaces, 2);
    one.dispose();
    one.dispose();
    assert.ok(one.disposed && one.bytes === 0);
    assert.throws(() => one.columns(0, 1), /disposed/);
    for (let bad = 0; bad < 4; bad++)
      assert.throws(() => new Surface(Uint32Array.of(0, 1, 99), OCTAHEDRON), HeatError);
    if (k === 2) most = memory().reserved;
    if (k > 2) assert.equal(memory().reserved, most, "the same work takes no more memory");
  }
  stays.dispose();
  assert.deepEqual(memory(), { surfaces: 0, reserved: 0 });
});

test("progress, and cancelling", () => {
  const stages = new Set();
  const one = new Surface(...mesh(), {
    progress: (stage, done) => void stages.add(stage) || (done >= 0 && done <= 1),
  });
  one.columns(0, "7h2", { progress: (stage) => void stages.add(stage) });
  assert.ok(stages.has("assemble") && stages.has("solve"), [...stages].join());
  assert.throws(() => one.columns(0, "9h2", { progress: () => false }), { status: "HD_ERR_CANCELLED" });
  const own = new Error("mine");
  const thrower = () => {
    throw own;
  };
  assert.throws(
    () => one.columns(0, "9h2", { progress: thrower }),
    (e) => e === own,
  );
  assert.throws(() => one.columns(0, "9h2", { progress: () => one.columns(1, 1) }), /is at work/);
  near(one.columns(0, "9h2").values, new Surface(...mesh()).columns(0, "9h2").values, 1e-7, "it works on");
  assert.throws(() => new Surface(...mesh(), { progress: () => false }), { status: "HD_ERR_CANCELLED" });
});

test("a trap ends the instance, and others can be made", () => {
  const one = new Surface(...mesh()),
    other = new Surface(FACES, OCTAHEDRON);
  const trap = () => {
    throw new WebAssembly.RuntimeError("unreachable");
  };
  assert.throws(() => one.columns(0, "9h2", { progress: trap }), /the module stopped.*unreachable.*lost/);
  assert.ok(one.disposed && other.disposed);
  assert.throws(() => other.columns(0, 1), /disposed/);
  one.dispose();
  assert.equal(new Surface(FACES, OCTAHEDRON).columns(0, 1).values.length, 6);
});

// ---- slim ----

function slim(source, then = "") {
  const code = `import { readFileSync } from "node:fs";
    import { init, ready, Surface } from "heatdiff/slim";
    import { pathToFileURL } from "node:url";
    const url = pathToFileURL("node_modules/heatdiff/heatdiff.wasm");
    ${source}; await ready;
    console.log(new Surface(null, new Float32Array(90).map((x, i) => Math.sin(i * i))).n); ${then}`;
  return execFileSync(process.execPath, ["--input-type=module", "-e", code], { stdio: "pipe" })
    .toString()
    .trim();
}

test("slim, from a URL, bytes or a module", () => {
  assert.equal(slim("await init()"), "30");
  assert.equal(slim("await init(url)"), "30");
  assert.equal(slim("await init(String(url))"), "30");
  assert.equal(slim("await init(readFileSync(url))"), "30");
  assert.equal(slim("await init(await WebAssembly.compile(readFileSync(url)))"), "30");
  assert.throws(() => slim("await init(7)"), /wanted is a URL, bytes or a WebAssembly.Module/);
  assert.throws(
    () => slim("init(readFileSync(url)).then(() => {}); new Surface(null, new Float32Array(9))"),
    /not ready/,
  );
});

// ---- workers ----

test("a worker gives the same numbers, and hears", async () => {
  const one = await WorkerSurface.create(...mesh());
  assert.equal(one.h, given.h);
  for (const { op, args, values } of given.answers) {
    const a = await one[op](...args);
    assert.ok(a instanceof Answer && a.report.status === "HD_OK");
    near(op === "sample" ? a.vertices : a.values, values, 1e-12, op);
  }
  near(await one.times("auto:3"), given.times, 1e-14, "times");
  assert.equal((await one.components()).length, one.n);
  const order = [];
  await Promise.all(["1h2", "2h2"].map((t) => one.columns(0, t).then(() => order.push(t))));
  assert.deepEqual(order, ["1h2", "2h2"]);
  await assert.rejects(
    one.columns(one.n, 1),
    (e) => e instanceof WorkerError && e.vertex === one.n && e.status === "HD_ERR_INDEX",
  );
  await assert.rejects(one.columns(0, "soon"), TypeError);
  await assert.rejects(one.columns(0, 1, { metod: 1 }), /no option metod/);
  await assert.rejects(WorkerSurface.create(FACES, bad(NaN)), { status: "HD_ERR_NOT_FINITE" });
  assert.throws(() => new WorkerSurface(FACES, OCTAHEDRON), /Surface.create/);
  const lost = one.signature("auto:16");
  one.dispose();
  await assert.rejects(lost, /disposed/);
  await assert.rejects(one.columns(0, 1), /disposed/);
});

async function cancelling(shared) {
  const one = await WorkerSurface.create(...mesh());
  const want = (await one.columns(5, "3h2", { method: "krylov" })).values;
  const stop = new AbortController();
  const work = one.signature(
    Array.from({ length: 40 }, (_, k) => `${1.3 ** k}h2`),
    { signal: stop.signal },
  );
  const next = one.columns(5, "3h2", { method: "krylov" });
  const never = assert.rejects(one.columns(6, "3h2", { signal: stop.signal }), {
    status: "HD_ERR_CANCELLED",
  });
  setTimeout(() => stop.abort(), 60);
  await assert.rejects(work, (e) => e instanceof WorkerError && e.status === "HD_ERR_CANCELLED");
  await never;
  near((await next).values, want, 1e-9, "what was asked after it is answered");
  await assert.rejects(one.columns(6, 1, { signal: stop.signal }), { status: "HD_ERR_CANCELLED" });
  let heard = 0;
  if (shared)
    await assert.rejects(
      one.signature(
        Array.from({ length: 40 }, (_, k) => `${1.3 ** k}h2`),
        { progress: () => (heard++, false) },
      ),
      { status: "HD_ERR_CANCELLED" },
    );
  assert.equal(heard, shared ? 1 : 0);
  const thrower = () => {
    throw new Error("mine");
  };
  await assert.rejects(
    one.signature(
      Array.from({ length: 40 }, (_, k) => `${1.3 ** k}h2`),
      { progress: thrower },
    ),
    /^Error: mine$/,
  );
  near((await one.columns(5, "3h2", { method: "krylov" })).values, want, 1e-9, "it works on");
  one.dispose();
}

test("cancelling in a worker", () => cancelling(true));
test("cancelling where memory cannot be shared", async () => {
  globalThis.crossOriginIsolated = false;
  try {
    await cancelling(false);
  } finally {
    delete globalThis.crossOriginIsolated;
  }
});
test("a worker that is not disposed of lets node end", async () => {
  await WorkerSurface.create(FACES, OCTAHEDRON);
});

// ---- three ----

class Attribute {
  constructor(array, itemSize, more = {}) {
    Object.assign(
      this,
      { isBufferAttribute: true, array, itemSize, count: array.length / itemSize, normalized: false },
      more,
    );
  }
}
// A box as three makes it: 24 vertices, four for each side.
function box(more = {}) {
  const xyz = [],
    index = [];
  for (let axis = 0; axis < 3; axis++)
    for (const side of [-1, 1]) {
      const at = xyz.length / 3;
      for (const [u, v] of [
        [-1, -1],
        [1, -1],
        [1, 1],
        [-1, 1],
      ]) {
        const p = [0, 0, 0];
        p[axis] = side;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v * side;
        xyz.push(...p.map((x) => (x === 0 ? -0 : x)));
      }
      index.push(at, at + 1, at + 2, at, at + 2, at + 3);
    }
  const position = new Attribute(new Float32Array(xyz), 3);
  return {
    isBufferGeometry: true,
    attributes: { position },
    index: { array: Uint16Array.from(index) },
    ...more,
  };
}

test("a geometry: seams are welded, and said", () => {
  const told = [],
    geometry = box(),
    one = new GeometrySurface(geometry, { say: (text) => told.push(text), kind: "fem" });
  assert.deepEqual(told, ["heatdiff: 24 vertices stand at 8 places; those at one place share their heat"]);
  assert.equal(one.welded.merged, 16);
  assert.equal(one.info.boundaryEdges, 0);
  const { attribute, attributes, report } = one.columns([3, 23], ["1h2", "2h2", "3h2"]);
  assert.ok(
    attribute instanceof Attribute && attribute.array instanceof Float32Array && attribute.itemSize === 1,
  );
  assert.equal(attributes.length, 6);
  assert.ok(report.bound < 1e-5);
  const { place } = one.welded,
    hottest = attribute.array.indexOf(Math.max(...attribute.array));
  assert.equal(place[hottest], place[3]);
  place.forEach((p, v) => assert.equal(attribute.array[v], attribute.array[place.indexOf(p)]));
  assert.equal(attributes[3].array.indexOf(Math.max(...attributes[3].array)), place.indexOf(place[23]));
  const smooth = one.smooth("0.1h2").attribute;
  assert.equal(smooth.itemSize, 3);
  assert.ok(Math.abs(smooth.array[0]) < 1 && smooth.array.length === 72);
  assert.ok(
    one.geodesic(0).attribute.array[0] === 0 &&
      one.distance(0, "1h2").attribute &&
      one.signature("1h2").attribute,
  );
  assert.throws(() => one.columns(24, 1), /no vertex 24, only 0 to 23/);
  one.dispose();
  const plain = {
    ...geometry,
    index: null,
    attributes: { position: new Attribute(Float32Array.from(OCTAHEDRON), 3) },
  };
  const silent = new GeometrySurface(plain, { say: () => assert.fail("there is no seam") });
  assert.equal(silent.welded.message, "");
  const loose = box();
  loose.attributes.position.array[0] += 1e-5;
  assert.equal(weld(loose).merged, 15);
  assert.equal(weld(loose, 1e-3).merged, 16);
  assert.equal(attributeFrom(loose, new Float64Array(8).fill(2), weld(box()).place).array[23], 2);
});

test("geometries that are refused", () => {
  const position = box().attributes.position;
  const of = (p) => ({ ...box(), attributes: { position: p } });
  for (const [geometry, text] of [
    [{}, /wanted is a BufferGeometry/],
    [null, /wanted is a BufferGeometry/],
    [{ ...box(), attributes: {} }, /no attribute position/],
    [
      of({ isInterleavedBufferAttribute: true, itemSize: 3 }),
      /position is interleaved.*deinterleaveGeometry/,
    ],
    [of(new Attribute(new Int16Array(72), 3, { normalized: true })), /position is quantised \(Int16Array\)/],
    [of(new Attribute(position.array, 2)), /itemSize 2, wanted is 3/],
    [
      { ...box(), index: { array: Uint16Array.of(0, 1, 24) } },
      /names vertex 24, but there are only 24 \(face 0\)/,
    ],
    [{ ...box(), index: { array: Uint16Array.of(0, 1) } }, /2 corners, wanted is a multiple of three/],
  ])
    assert.throws(() => new GeometrySurface(geometry, { say: null }), text);
  assert.throws(() => weld(box(), -1), /tolerance is -1/);
});

// ---- run ----

assert.ok(supported);
await ready;
let failed = 0;
for (const [name, f] of tests) {
  try {
    await f();
    console.log(`ok: ${name}`);
  } catch (e) {
    failed++;
    console.log(`FAILED: ${name}\n${e.stack}`);
  }
}
process.exitCode = failed ? 1 : 0;
