// Heat on surfaces. Vertices are numbered from 0; t is a length squared; `h` is the mean edge length.

/** Resolves when surfaces can be made; rejects where there is no WebAssembly with SIMD. */
export const ready: Promise<void>;
/** Whether WebAssembly with 128-bit SIMD is there. */
export const supported: boolean;
/** Surfaces that are not disposed of, and the bytes that the module holds for them. */
export function memory(): { surfaces: number; reserved: number };

export type Indices = Uint32Array | Uint16Array | Int32Array;
export type Floats = Float32Array | Float64Array;
/** A vertex, or a list of them: a column of the answer for each. */
export type Vertices = number | readonly number[] | Indices;
/** A number, "10h2" (times h squared), "auto:8" (eight times that suit the surface), or a list of numbers and such words. */
export type Times = number | string | readonly (number | string)[] | Floats;
export type Kind = "default" | "fem" | "voronoi-cot" | "cot" | "voronoi-exp" | "exp";
export type Method = "auto" | "iterative" | "direct" | "krylov" | "local";
export type Kernel = "operator" | "symmetric";
export type Distance = "classical" | "weighted" | "commute" | "biharmonic";
export type Evidence = "none" | "proven" | "measured" | "estimated";
export type Query =
  | "fields"
  | "columns"
  | "pairs"
  | "diagonal"
  | "diagonal-operator"
  | "trace"
  | "distance"
  | "distance-weighted"
  | "distance-commute"
  | "distance-biharmonic"
  | "spectrum";
/** Called now and then, with a stage and how much of it is done (0 to 1). false cancels: HD_ERR_CANCELLED. */
export type Progress = (stage: string, done: number) => boolean | void;

export interface SurfaceOptions {
  /** The Laplacian: fem for triangles, voronoi-exp for points. */
  kind?: Kind;
  /** delaunay: edges are flipped, for thin triangles. tufted: also for soups and borders; for points the fastest. */
  triangulation?: "given" | "delaunay" | "tufted";
  border?: "natural" | "dirichlet";
  /** Vertices held at zero. */
  held?: Vertices | null;
  /** The default of queries. */
  method?: Method;
  /** Bytes of matrices and factors; where one way would exceed it, another is tried. 0: no limit. */
  memoryLimit?: number;
  progress?: Progress | null;
}

/** What was found in a mesh; nothing here is an error. */
export interface SurfaceInfo {
  n: number;
  active: number;
  components: number;
  held: number;
  h: number;
  area: number;
  kind: string;
  faces: number;
  facesUsed: number;
  repeatedCorner: number;
  zeroArea: number;
  repeatedFace: number;
  edges: number;
  boundaryEdges: number;
  nonManifoldEdges: number;
  misorientedEdges: number;
  boundaryLoops: number;
  inert: number;
  negativeWeights: number;
  smallestAngle: number;
  coincident: number;
  notFlat: number;
}

/** How an answer was computed, and how large its error can be. The worst of its columns. */
export interface Report {
  status: "HD_OK" | "HD_WARN_ACCURACY";
  /** Bound on the largest error of any value, relative to the largest value; the sum of the next four. */
  bound: number;
  rational: number;
  solver: number;
  rounding: number;
  /** What method local leaves out. */
  local: number;
  /** How the least certain part of the bound is known. */
  evidence: Evidence;
  evidenceRational: Evidence;
  evidenceSolver: Evidence;
  evidenceRounding: Evidence;
  evidenceLocal: Evidence;
  /** Signatures and distances: bound relative to each value itself; else Infinity. */
  boundRelative: number;
  /** Distances with at most about one sure digit. */
  lost: number;
  smallest: number;
  massDrift: number;
  residual: number;
  method: Method;
  reason: string;
  degree: number;
  iterations: number;
  factorNonZeros: number;
  factorFlops: number;
  /** Vertices of the largest part of the mesh that method local worked on. */
  touched: number;
}

/** Geodesic distances come from the heat method, whose own error is about `error`, an edge length: there is no bound. */
export interface GeodesicReport {
  status: "HD_OK" | "HD_WARN_ACCURACY";
  bound: null;
  error: number;
  t: number;
  h: number;
  residualHeat: number;
  residualDistance: number;
  stages: number;
  factorNonZeros: number;
}

export interface Estimate {
  method: Method;
  reason: string;
  fits: boolean;
  /** Of one idle core, native, within a factor of about two; WebAssembly takes up to twice as long. */
  seconds: number;
  bytes: number;
  bytesMost: number;
  flops: number;
  analysed: boolean;
}

/** Columns of `length` numbers, one after another: for each source or field, for each time. */
export class Answer<R = Report> {
  private constructor();
  readonly values: Float64Array;
  readonly length: number;
  readonly times: Float64Array;
  readonly report: R;
  /** A view of the column of a source (or field) and a time, by their places in what was asked. */
  column(source?: number, time?: number): Float64Array;
}
export interface SignatureAnswer extends Answer {
  /** tr K_t for each time. */
  readonly trace: Float64Array;
}
export interface SampleAnswer extends Answer {
  readonly vertices: Int32Array;
}

/** What the library refused or could not do, and where in the input. */
export class HeatError extends Error {
  constructor(status: string, text: string, where?: Record<string, number>);
  /** Such as "HD_ERR_INDEX"; heatdiff.h lists them. */
  readonly status: string;
  readonly face?: number;
  readonly vertex?: number;
  readonly row?: number;
  readonly column?: number;
  readonly value?: number;
}

/**
 * A triangle mesh, or with indices null a set of points. Arrays are copied. stride: numbers from one vertex to the next,
 * of which the first three are x, y and z.
 */
export class Surface {
  constructor(indices: Indices | null, positions: Floats, stride?: number, options?: SurfaceOptions);
  readonly n: number;
  readonly h: number;
  readonly area: number;
  readonly info: SurfaceInfo;
  readonly method: Method;
  readonly disposed: boolean;
  /** Bytes of matrices, factors and work. */
  readonly bytes: number;
  /** Frees everything. A surface that is forgotten is freed with the garbage, sooner or later. */
  dispose(): void;
  times(t: Times): Float64Array;
  /** The component of each vertex; -1 where there is no mass. */
  components(): Int32Array;
  /** Heat from vertices: columns of K_t ("operator", the default) or k_t ("symmetric"). */
  columns(
    sources: Vertices,
    t: Times,
    options?: { kernel?: Kernel; method?: Method; progress?: Progress | null },
  ): Answer;
  /** A field of your own after the time t: n numbers, or several times n. */
  apply(field: Floats, t: Times, options?: { method?: Method; progress?: Progress | null }): Answer;
  /** The surface, smoothed: columns of 3 n numbers, x y z of one vertex after another. */
  smooth(t: Times, options?: { method?: Method; progress?: Progress | null }): Answer;
  /** The heat kernel signature k_t(x, x), or with "operator" the diagonal of K_t. Default: "auto:16". */
  signature(t?: Times, options?: { kernel?: Kernel; progress?: Progress | null }): SignatureAnswer;
  /** Diffusion distances. "commute" and "biharmonic" have no time: t is undefined. */
  distance(
    sources: Vertices,
    t?: Times | null,
    options?: { kind?: Distance; progress?: Progress | null },
  ): Answer;
  /** Farthest points: `vertices`, each farthest from those before it and those given; `values` are their distances. */
  sample(
    count: number,
    t?: Times | null,
    options?: { kind?: Distance; given?: Vertices | null; progress?: Progress | null },
  ): SampleAnswer;
  /** Distances along the surface. nearest: one column, to the nearest source. Infinity: no path. */
  geodesic(
    sources: Vertices,
    options?: { nearest?: boolean; progress?: Progress | null },
  ): Answer<GeodesicReport>;
  /** What a query would take. count: fields, columns, sources, points or eigenpairs. */
  estimate(
    query: Query,
    t?: Times | null,
    count?: number,
    options?: { method?: Method; progress?: Progress | null },
  ): Estimate;
}
