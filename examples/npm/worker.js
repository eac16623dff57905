// worker.js - the same surfaces, each in a worker of its own: every answer is a promise
//
// A worker hears nothing while it computes. Where memory can be shared (node, pages that are cross-origin isolated), a
// cancelled question ends in the worker and the surface stays. Elsewhere the worker is ended, and the next question
// begins a new one with the same surface.
import { Answer, HeatError, compiledModule, start } from "./core.js";
export { Answer, HeatError, supported } from "./core.js";

const canShare = () => typeof SharedArrayBuffer === "function" && globalThis.crossOriginIsolated !== false;

// For pages that have the module already, from the URL, bytes or WebAssembly.Module that /slim takes too.
export async function init(source) {
  await (await import("./slim.js")).init(source);
}

async function module() {
  if (!compiledModule()) {
    const { default: base64 } = await import("./inline.js");
    await start(Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)));
  }
  return compiledModule();
}

async function thread() {
  const url = new URL("./thread.js", import.meta.url);
  if (typeof Worker === "function") {
    const worker = new Worker(new URL("./thread.js", import.meta.url), { type: "module" });
    return {
      worker,
      listen: (hear, fail) => {
        worker.onmessage = (e) => hear(e.data);
        worker.onerror = (e) => fail(e.message || "the worker could not start");
      },
      busy() {},
    };
  }
  const { Worker: Thread } = await import(/* webpackIgnore: true */ /* @vite-ignore */ "node:worker_threads");
  const worker = new Thread(url);
  return {
    worker,
    listen: (hear, fail) => worker.on("message", hear).on("error", (e) => fail(e.message)),
    busy: (yes) => (yes ? worker.ref() : worker.unref()), // a program may end while nothing is asked
  };
}

const cancelled = (signal) =>
  signal.reason instanceof HeatError
    ? signal.reason
    : new HeatError("HD_ERR_CANCELLED", "cancelled by its signal");

function unpack(value) {
  if (!value || !value.isAnswer) return value;
  const { values, length, times, report, more } = value;
  return new Answer(values, length, times, report, more);
}

export class Surface {
  #mesh;
  #thread = null;
  #flag = null;
  #running = null;
  #queue = [];
  #disposed = false;

  constructor(key, mesh) {
    if (key !== Surface.#key)
      throw new TypeError("await Surface.create(indices, positions, stride, options)");
    this.#mesh = mesh;
  }
  static #key = {};

  // As new Surface of the main entry; options also take a signal (AbortSignal).
  static async create(indices, positions, stride = 3, options = {}) {
    const { progress, signal, ...plain } = options;
    const keep = (x) => (x && !canShare() ? x.slice() : x); // to begin anew
    const it = new Surface(Surface.#key, [keep(indices), keep(positions), stride, plain]);
    try {
      Object.assign(it, await it.#ask("begin", [indices, positions, stride, plain], { progress, signal }));
    } catch (e) {
      it.dispose();
      throw e;
    }
    if (canShare()) it.#mesh = null;
    return it;
  }

  #ask(op, args, { progress = null, signal = null } = {}) {
    if (progress !== null && typeof progress !== "function") throw new TypeError("progress is no function");
    return new Promise((done, fail) => {
      if (this.#disposed) return fail(new Error("this surface has been disposed of"));
      if (signal && signal.aborted) return fail(cancelled(signal));
      const job = { op, args, progress, signal, done, fail };
      job.stop = () => this.#stop(job);
      if (signal) signal.addEventListener("abort", job.stop);
      this.#queue.push(job);
      this.#step();
    });
  }

  async #step() {
    if (this.#running || !this.#queue.length) return;
    const job = (this.#running = this.#queue.shift());
    try {
      if (!this.#thread) await this.#begin(job);
      if (this.#running !== job) return; // stopped meanwhile
      this.#thread.busy(true);
      if (this.#flag) Atomics.store(this.#flag, 0, 0);
      this.#thread.worker.postMessage({ op: job.op, args: job.args, progress: Boolean(job.progress) });
    } catch (e) {
      if (this.#running === job) this.#end(job, () => job.fail(e));
    }
  }

  async #begin(job) {
    const compiled = await module(),
      made = await thread();
    if (this.#running !== job) return made.worker.terminate();
    this.#thread = made;
    this.#flag = canShare() ? new Int32Array(new SharedArrayBuffer(4)) : null;
    made.listen(
      (m) => this.#hear(m),
      (text) => {
        this.#thread = null;
        if (this.#running) this.#end(this.#running, () => this.#running.fail(new Error(text)));
      },
    );
    made.worker.postMessage({ op: "start", compiled, flag: this.#flag });
    if (job.op !== "begin") made.worker.postMessage({ op: "again", args: this.#mesh });
  }

  #hear(m) {
    const job = this.#running;
    if (!job) return;
    if (m.stage !== undefined) {
      try {
        if (job.progress && job.progress(m.stage, m.done) === false) job.stop();
      } catch (e) {
        job.thrown = e;
        job.stop();
      }
      return;
    }
    this.#end(job, () => {
      if (!m.error) return job.done(unpack(m.value));
      if (job.thrown) return job.fail(job.thrown);
      const { name, message, ...fields } = m.error;
      const kinds = { TypeError, RangeError },
        e = name === "HeatError" ? Object.create(HeatError.prototype) : new (kinds[name] || Error)(message);
      if (name === "HeatError") Error.captureStackTrace?.(e);
      Object.defineProperty(e, "message", { value: message, configurable: true });
      job.fail(Object.assign(e, name === "HeatError" ? { name, ...fields } : {}));
    });
  }

  #end(job, answer) {
    if (job.signal) job.signal.removeEventListener("abort", job.stop);
    answer();
    this.#running = null;
    if (this.#thread && !this.#queue.length) this.#thread.busy(false);
    this.#step();
  }

  #stop(job) {
    const e = job.thrown || cancelled(job.signal || { reason: null });
    if (job !== this.#running) {
      this.#queue = this.#queue.filter((other) => other !== job);
      return job.fail(e);
    }
    if (this.#flag && this.#thread) return Atomics.store(this.#flag, 0, 1); // the worker answers HD_ERR_CANCELLED
    if (this.#thread) this.#thread.worker.terminate();
    this.#thread = null;
    this.#end(job, () => job.fail(e));
  }

  // Ends the worker, and with it everything it holds. What is asked and not answered fails.
  dispose() {
    if (this.#disposed) return;
    this.#disposed = true;
    const jobs = [this.#running, ...this.#queue].filter(Boolean);
    if (this.#thread) this.#thread.worker.terminate();
    this.#thread = this.#mesh = this.#running = null;
    this.#queue = [];
    for (const job of jobs) job.fail(new Error("this surface has been disposed of"));
  }

  get disposed() {
    return this.#disposed;
  }

  static {
    for (const op of [
      "times",
      "components",
      "columns",
      "apply",
      "smooth",
      "signature",
      "distance",
      "sample",
      "geodesic",
      "estimate",
    ])
      Surface.prototype[op] = async function (...args) {
        const last = args.at(-1),
          isOptions = Object.prototype.toString.call(last) === "[object Object]";
        const { progress, signal, ...plain } = isOptions ? last : {};
        return this.#ask(op, isOptions ? [...args.slice(0, -1), plain] : args, { progress, signal });
      };
  }
}
