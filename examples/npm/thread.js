// thread.js - what runs in a worker: one surface, asked by messages of worker.js
import { Answer, Surface, start } from "./core.js";

const inPage = typeof globalThis.postMessage === "function";
const port = inPage
  ? globalThis
  : (await import(/* webpackIgnore: true */ /* @vite-ignore */ "node:worker_threads")).parentPort;

let surface = null,
  flag = null,
  told = 0;

function tell(stage, done) {
  const now = performance.now();
  if (now - told >= 40) {
    told = now;
    port.postMessage({ stage, done });
  }
  return !(flag && Atomics.load(flag, 0));
}

// A function for progress only if somebody listens, or may cancel.
function begin([indices, positions, stride, options], wanted) {
  surface = new Surface(indices, positions, stride, { ...options, ...listening(wanted) });
  const { n, h, area, info, method } = surface;
  return { n, h, area, info, method };
}

const listening = (wanted) =>
  wanted || flag ? { progress: wanted ? tell : () => !Atomics.load(flag, 0) } : {};

const QUIET = ["times", "components"]; // without options
// How many arguments stand before the options.
const BEFORE = {
  columns: 2,
  apply: 2,
  smooth: 1,
  signature: 1,
  distance: 2,
  sample: 2,
  geodesic: 1,
  estimate: 3,
};

function ask(op, args, wanted) {
  if (QUIET.includes(op)) return surface[op](...args);
  const all = Array.from({ length: BEFORE[op] + 1 }, (_, i) => args[i]);
  all[BEFORE[op]] = { ...all[BEFORE[op]], ...listening(wanted) };
  return surface[op](...all);
}

function pack(value) {
  if (!(value instanceof Answer)) return [value, []];
  const { values, length, times, report, ...more } = value;
  return [{ isAnswer: true, values, length, times, report, more }, [values.buffer]];
}

async function hear({ op, args, progress, compiled, flag: shared }) {
  told = performance.now();
  try {
    if (op === "start") {
      flag = shared;
      await start(compiled);
      return;
    }
    if (op === "again") return void begin(args, false);
    const [value, give] = pack(op === "begin" ? begin(args, progress) : ask(op, args, progress));
    port.postMessage({ value }, give);
  } catch (e) {
    port.postMessage({ error: { name: e.name, message: e.message, ...e } });
  }
}

// One after the other: the first message compiles.
let turn = Promise.resolve();
const listen = (data) => (turn = turn.then(() => hear(data)));
if (inPage) globalThis.onmessage = (e) => listen(e.data);
else port.on("message", listen);
