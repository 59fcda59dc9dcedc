/** The geometry of the page: meshes, the look of each part, and intersection curves. */
import { ByteReader } from "./byte-reader";

export type Vector = readonly [number, number, number];

/** A box in the world, from its lower to its upper corner. */
export type Box = readonly [Vector, Vector];

/** A mesh whose positions are steps of a box, from 0 to 65535. */
export interface QuantizedMesh {
  readonly low: Vector;
  readonly size: Vector;
  readonly isClosed: boolean;
  readonly positions: Uint16Array;
  readonly corners: Uint32Array;
}

/** A part in its place. A part without a mesh is drawn as its box, and one without a box not at all. */
export interface PlacedPart {
  readonly mesh: number | undefined;
  /** The map from the unit cube to the world: the columns of a matrix, and the image of its corner. */
  readonly columns: readonly [Vector, Vector, Vector];
  readonly corner: Vector;
  readonly box: Box | undefined;
}

/** A polyline in the world: x, y, z of each point. */
export type Polyline = Float64Array;

export interface Geometry {
  readonly meshes: QuantizedMesh[];
  readonly parts: PlacedPart[];
  /** Curves by the index of the clash. */
  readonly curves: Map<number, Polyline[]>;
}

/** Largest coordinate of a position. */
const LAST_STEP = 65535;

/** Codes of the looks of parts; meshes have the codes from FIRST_MESH. */
const NOTHING = 0;
const BOX = 1;
const FIRST_MESH = 2;

/** Reads the block that `crates/impinge-report/src/html/geometry.rs` writes. */
export function readGeometry(bytes: Uint8Array): Geometry {
  const reader = new ByteReader(bytes);
  const meshes = Array.from({ length: reader.integer() }, () => readMesh(reader));
  const parts = Array.from({ length: reader.integer() }, () => readPart(reader, meshes));
  return { meshes, parts, curves: readCurves(reader) };
}

function readMesh(reader: ByteReader): QuantizedMesh {
  const low = readVector(reader);
  const size = readVector(reader);
  const isClosed = reader.integer() === 1;
  const pointCount = reader.integer();
  const faceCount = reader.integer();
  const positions = reader.points(pointCount);
  return { low, size, isClosed, positions, corners: reader.corners(3 * faceCount) };
}

function readPart(reader: ByteReader, meshes: QuantizedMesh[]): PlacedPart {
  const code = reader.integer();
  if (code === NOTHING) {
    return { mesh: undefined, columns: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], corner: [0, 0, 0], box: undefined };
  }
  if (code === BOX) {
    const low = readVector(reader);
    const high = readVector(reader);
    const size = thickened([high[0] - low[0], high[1] - low[1], high[2] - low[2]]);
    return { mesh: undefined, columns: [[size[0], 0, 0], [0, size[1], 0], [0, 0, size[2]]], corner: low, box: [low, high] };
  }
  const number = code - FIRST_MESH;
  return placed(number, meshes[number], reader.numbers(12));
}

/** Returns a mesh in its place: three rows of a matrix, then a translation. */
export function placed(number: number, { low, size }: QuantizedMesh, pose: readonly number[]): PlacedPart {
  const row = (at: number): Vector => [pose[3 * at], pose[3 * at + 1], pose[3 * at + 2]];
  const rows = [row(0), row(1), row(2)] as const;
  const translation = row(3);
  const extent = thickened(size);
  const column = (axis: number): Vector => [rows[0][axis] * extent[axis], rows[1][axis] * extent[axis], rows[2][axis] * extent[axis]];
  const columns = [column(0), column(1), column(2)] as const;
  const corner = translation.map((x, axis) => x + dot(rows[axis], low)) as unknown as Vector;
  return { mesh: number, columns, corner, box: boxOf(columns, corner) };
}

/** Gives flat boxes a thickness, so that the map has an inverse. All positions of a flat box are 0 along that axis. */
function thickened(size: Vector): Vector {
  const least = 1e-9 * Math.max(...size) || 1e-9;
  return size.map((extent) => Math.max(extent, least)) as unknown as Vector;
}

function boxOf(columns: PlacedPart["columns"], corner: Vector): Box {
  const ends = [0, 1, 2].map((axis) => {
    const reaches = columns.map((column) => column[axis]);
    const below = reaches.reduce((sum, reach) => sum + Math.min(reach, 0), 0);
    const above = reaches.reduce((sum, reach) => sum + Math.max(reach, 0), 0);
    return [corner[axis] + below, corner[axis] + above];
  });
  return [0, 1].map((end) => ends.map((pair) => pair[end])) as unknown as Box;
}

function readCurves(reader: ByteReader): Map<number, Polyline[]> {
  const curves = new Map<number, Polyline[]>();
  const count = reader.integer();
  for (let at = 0; at < count; at++) {
    const clash = reader.integer();
    const low = readVector(reader);
    const size = readVector(reader);
    const lines = Array.from({ length: reader.integer() }, () => {
      const steps = reader.points(reader.integer());
      return Float64Array.from(steps, (step, place) => low[place % 3] + (size[place % 3] * step) / LAST_STEP);
    });
    curves.set(clash, lines);
  }
  return curves;
}

export function readVector(reader: ByteReader): Vector {
  return reader.numbers(3) as unknown as Vector;
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
