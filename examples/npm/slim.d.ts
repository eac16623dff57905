export * from "./index.js";
/** Begins: a URL of heatdiff.wasm, its bytes, or a WebAssembly.Module. Default: the file beside this module. */
export function init(
  source?: string | URL | ArrayBuffer | ArrayBufferView | WebAssembly.Module,
): Promise<void>;
