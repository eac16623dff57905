// three.js - heat on a BufferGeometry of three.js: a geometry in, attributes out
//
// It looks at the fields of what it is given and imports nothing of three. Attributes that it makes have the class of
// the geometry's own position attribute.
import { Surface } from "./core.js";

const isArrayOf = (x, name) => Object.prototype.toString.call(x) === `[object ${name}]`;

function attributeOf(geometry, name, itemSize) {
  const a = geometry.attributes[name];
  if (!a) throw new TypeError(`the geometry has no attribute ${name}`);
  if (a.isInterleavedBufferAttribute)
    throw new TypeError(
      `the attribute ${name} is interleaved; make it one of its own first: BufferGeometryUtils.deinterleaveGeometry(geometry)`,
    );
  if (!a.isBufferAttribute) throw new TypeError(`the attribute ${name} is no BufferAttribute`);
  if (a.itemSize !== itemSize)
    throw new TypeError(`the attribute ${name} has itemSize ${a.itemSize}, wanted is ${itemSize}`);
  if (a.normalized || !(isArrayOf(a.array, "Float32Array") || isArrayOf(a.array, "Float64Array")))
    throw new TypeError(
      `the attribute ${name} is quantised (${a.array.constructor.name}); make it a Float32Array first, by getX, getY and getZ`,
    );
  return a;
}

// Vertices at exactly the same place become one; with a tolerance (a length) those whose coordinates round to the same
// multiples of it. Renderers repeat a vertex along seams of normals or texture coordinates, and no heat would cross such
// a seam.
// place[v] is the place of vertex v; positions and indices are those of the places.
export function weld(geometry, tolerance = 0) {
  if (!geometry || !geometry.isBufferGeometry) throw new TypeError("wanted is a BufferGeometry of three.js");
  if (!(tolerance >= 0 && tolerance < Infinity))
    throw new RangeError(`tolerance is ${tolerance}, wanted is a length from 0 on`);
  const from = attributeOf(geometry, "position", 3),
    n = from.count,
    xyz = from.array;
  const place = new Uint32Array(n),
    at = new Map(),
    kept = [];
  const cell = (x) => (tolerance ? Math.round(x / tolerance) : x);
  for (let v = 0; v < n; v++) {
    const key = `${cell(xyz[3 * v])},${cell(xyz[3 * v + 1])},${cell(xyz[3 * v + 2])}`;
    let p = at.get(key);
    if (p === undefined) {
      at.set(key, (p = kept.length));
      kept.push(v);
    }
    place[v] = p;
  }
  const positions = new xyz.constructor(3 * kept.length);
  kept.forEach((v, p) => positions.set(xyz.subarray(3 * v, 3 * v + 3), 3 * p));
  const index = geometry.index ? geometry.index.array : null,
    corners = index ? index.length : n;
  if (corners % 3)
    throw new RangeError(`the geometry has ${corners} corners, wanted is a multiple of three: triangles`);
  const indices = new Uint32Array(corners);
  for (let c = 0; c < corners; c++) {
    const v = index ? index[c] : c;
    if (!(v >= 0 && v < n))
      throw new RangeError(
        `the index names vertex ${v}, but there are only ${n} (face ${Math.floor(c / 3)})`,
      );
    indices[c] = place[v];
  }
  const merged = n - kept.length;
  const message = merged
    ? `heatdiff: ${n} vertices stand at ${kept.length} places; those at one place share their heat`
    : "";
  return { positions, indices, place, vertex: Uint32Array.from(kept), merged, message };
}

// A column of numbers at places, as an attribute of the geometry: itemSize 1, or 3 for positions.
export function attributeFrom(geometry, column, place, itemSize = 1) {
  const array = new Float32Array(itemSize * place.length),
    Kind = geometry.attributes.position.constructor;
  for (let v = 0; v < place.length; v++)
    for (let c = 0; c < itemSize; c++) array[itemSize * v + c] = column[itemSize * place[v] + c];
  return new Kind(array, itemSize);
}

// A geometry as a surface. Vertices are numbered as in the geometry, everywhere. Answers carry `attribute`, the first of
// `attributes`: one for each source and time, as answer.column has them.
export class GeometrySurface {
  // options: those of Surface, and tolerance (of welding), say (told about seams; default console.info; null: nobody)
  constructor(geometry, { tolerance = 0, say = console.info, ...options } = {}) {
    this.welded = weld(geometry, tolerance);
    if (this.welded.message && say) say(this.welded.message);
    this.geometry = geometry;
    this.surface = new Surface(this.welded.indices, this.welded.positions, 3, options);
    for (const name of ["h", "area", "info"]) this[name] = this.surface[name];
  }

  dispose() {
    this.surface.dispose();
  }

  times(t) {
    return this.surface.times(t);
  }

  #places(sources) {
    const { place } = this.welded,
      one = (v) => {
        if (!Number.isInteger(v) || v < 0 || v >= place.length)
          throw new RangeError(`there is no vertex ${v}, only 0 to ${place.length - 1}`);
        return place[v];
      };
    if (typeof sources === "number") return one(sources);
    if (!Array.isArray(sources) && !ArrayBuffer.isView(sources))
      throw new TypeError("sources: wanted is a vertex or a list of vertices");
    return Array.from(sources, one);
  }

  #with(answer, itemSize = 1) {
    const { place } = this.welded,
      many = Math.max(1, answer.times.length),
      count = answer.values.length / answer.length;
    answer.attributes = Array.from({ length: count }, (_, q) =>
      attributeFrom(this.geometry, answer.column(Math.floor(q / many), q % many), place, itemSize),
    );
    answer.attribute = answer.attributes[0];
    return answer;
  }

  columns(sources, t, options) {
    return this.#with(this.surface.columns(this.#places(sources), t, options));
  }

  distance(sources, t, options) {
    return this.#with(this.surface.distance(this.#places(sources), t, options));
  }

  geodesic(sources, options) {
    return this.#with(this.surface.geodesic(this.#places(sources), options));
  }

  signature(t, options) {
    return this.#with(this.surface.signature(t, options));
  }

  // A position attribute: vertices along seams move together.
  smooth(t, options) {
    return this.#with(this.surface.smooth(t, options), 3);
  }
}
