import {
  Answer,
  Distance,
  GeodesicReport,
  Kernel,
  Method,
  Progress,
  SignatureAnswer,
  Surface,
  SurfaceInfo,
  SurfaceOptions,
  Times,
  Vertices,
} from "./index.js";

/** A BufferGeometry of three.js, as far as it is looked at. */
export interface Geometry {
  readonly isBufferGeometry: true;
  readonly attributes: Record<string, any>;
  readonly index: { readonly array: ArrayLike<number> } | null;
}
/** Of the class of the geometry's position attribute: for geometry.setAttribute. */
export type Attribute = any;
export type WithAttributes<A> = A & {
  readonly attribute: Attribute;
  /** One for each source, for each time. */
  readonly attributes: Attribute[];
};

export interface Welded {
  positions: Float32Array | Float64Array;
  indices: Uint32Array;
  /** The place of each vertex of the geometry. */
  place: Uint32Array;
  /** The first vertex at each place. */
  vertex: Uint32Array;
  /** How many vertices stand where another one does. */
  merged: number;
  message: string;
}

/**
 * Makes vertices at one place one. tolerance: their coordinates are rounded to multiples of it first; default: not at all.
 * With /worker: Surface.create of what weld returns, then attributeFrom.
 */
export function weld(geometry: Geometry, tolerance?: number): Welded;
export function attributeFrom(
  geometry: Geometry,
  column: ArrayLike<number>,
  place: Uint32Array,
  itemSize?: number,
): Attribute;

/** A geometry as a surface; vertices are numbered as in the geometry. */
export class GeometrySurface {
  constructor(
    geometry: Geometry,
    options?: SurfaceOptions & { tolerance?: number; say?: ((text: string) => void) | null },
  );
  readonly geometry: Geometry;
  readonly surface: Surface;
  readonly welded: Welded;
  readonly h: number;
  readonly area: number;
  readonly info: SurfaceInfo;
  dispose(): void;
  times(t: Times): Float64Array;
  columns(
    sources: Vertices,
    t: Times,
    options?: { kernel?: Kernel; method?: Method; progress?: Progress | null },
  ): WithAttributes<Answer>;
  distance(
    sources: Vertices,
    t?: Times | null,
    options?: { kind?: Distance; progress?: Progress | null },
  ): WithAttributes<Answer>;
  geodesic(
    sources: Vertices,
    options?: { nearest?: boolean; progress?: Progress | null },
  ): WithAttributes<Answer<GeodesicReport>>;
  signature(
    t?: Times,
    options?: { kernel?: Kernel; progress?: Progress | null },
  ): WithAttributes<SignatureAnswer>;
  smooth(t: Times, options?: { method?: Method; progress?: Progress | null }): WithAttributes<Answer>;
}
