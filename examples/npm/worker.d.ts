import {
  Answer,
  Distance,
  Estimate,
  Floats,
  GeodesicReport,
  Indices,
  Kernel,
  Method,
  Progress,
  Query,
  SampleAnswer,
  SignatureAnswer,
  SurfaceInfo,
  SurfaceOptions,
  Times,
  Vertices,
} from "./index.js";
export { Answer, HeatError, supported } from "./index.js";

/** Only needed to take the module from elsewhere, see /slim; by default it is the one inside the package. */
export function init(
  source?: string | URL | ArrayBuffer | ArrayBufferView | WebAssembly.Module,
): Promise<void>;

/**
 * signal: cancels, with the status HD_ERR_CANCELLED. In node, and on pages that are cross-origin isolated, the surface
 * stays as it is. Elsewhere its worker is ended, and the next question makes it anew.
 */
export interface Listening {
  progress?: Progress | null;
  signal?: AbortSignal | null;
}

/** The surface of the main entry, in a worker of its own. Questions are answered in the order they are asked. */
export class Surface {
  private constructor();
  static create(
    indices: Indices | null,
    positions: Floats,
    stride?: number,
    options?: SurfaceOptions & Listening,
  ): Promise<Surface>;
  readonly n: number;
  readonly h: number;
  readonly area: number;
  readonly info: SurfaceInfo;
  readonly method: Method;
  readonly disposed: boolean;
  /** Ends the worker; what is not answered yet fails. */
  dispose(): void;
  times(t: Times): Promise<Float64Array>;
  components(): Promise<Int32Array>;
  columns(
    sources: Vertices,
    t: Times,
    options?: { kernel?: Kernel; method?: Method } & Listening,
  ): Promise<Answer>;
  apply(field: Floats, t: Times, options?: { method?: Method } & Listening): Promise<Answer>;
  smooth(t: Times, options?: { method?: Method } & Listening): Promise<Answer>;
  signature(t?: Times, options?: { kernel?: Kernel } & Listening): Promise<SignatureAnswer>;
  distance(sources: Vertices, t?: Times | null, options?: { kind?: Distance } & Listening): Promise<Answer>;
  sample(
    count: number,
    t?: Times | null,
    options?: { kind?: Distance; given?: Vertices | null } & Listening,
  ): Promise<SampleAnswer>;
  geodesic(sources: Vertices, options?: { nearest?: boolean } & Listening): Promise<Answer<GeodesicReport>>;
  estimate(
    query: Query,
    t?: Times | null,
    count?: number,
    options?: { method?: Method } & Listening,
  ): Promise<Estimate>;
}
