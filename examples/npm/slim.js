// slim.js - the module beside: `await init()` fetches heatdiff.wasm, or takes what you have
import { start } from "./core.js";
export { Surface, Answer, HeatError, supported, memory } from "./core.js";

let settle;
export const ready = new Promise((done) => (settle = done));

async function bytesOf(url) {
  if (url.protocol === "file:" && typeof process === "object") {
    const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ "node:fs/promises");
    return readFile(url);
  }
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
  return answer.arrayBuffer();
}

// source: a URL of heatdiff.wasm (text or URL), its bytes, or a WebAssembly.Module; by default the file beside this one.
export async function init(source = new URL("./heatdiff.wasm", import.meta.url)) {
  const isUrl = typeof source === "string" || source instanceof URL;
  if (
    !isUrl &&
    !(source instanceof WebAssembly.Module || source instanceof ArrayBuffer || ArrayBuffer.isView(source))
  )
    throw new TypeError("init: wanted is a URL, bytes or a WebAssembly.Module");
  const base = typeof location === "object" ? location.href : import.meta.url;
  await start(isUrl ? await bytesOf(new URL(source, base)) : source);
  settle();
}
