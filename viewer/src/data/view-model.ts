/** The data of a page about something other than clashes: a pair of meshes, a hierarchy, or a robot. */
import { around } from "./boxes";
import { readBlock, readJson } from "./blocks";
import { ByteReader } from "./byte-reader";
import { placed, readGeometry, readVector, type Box, type PlacedPart, type Vector } from "./geometry";
import type { Model } from "./model";
import type { Axis } from "./report";

/** The facts of every page. See `crates/impinge-report/src/html/about.rs`. */
interface CommonFacts {
  readonly title: string;
  readonly heading: string;
  readonly rows: readonly (readonly [name: string, value: string])[];
  readonly version: string;
  readonly up: Axis;
  readonly unit?: string;
  readonly meters?: number;
  readonly parts: readonly (readonly [name: string, type: string])[];
  readonly boxes: number;
  readonly max_triangles: number;
  readonly rounding: number;
}

export interface PairFacts extends CommonFacts {
  readonly kind: "pair";
  readonly nearest?: readonly [Vector, Vector];
  readonly has_faces: boolean;
  readonly has_curves: boolean;
}

export interface HierarchyFacts extends CommonFacts {
  readonly kind: "hierarchy";
  readonly levels: number;
  readonly max_boxes: number;
}

export interface RobotStep {
  readonly name: string;
  readonly text: string;
  readonly verdict: "free" | "collides" | "open";
  readonly pair?: readonly [number, number];
}

export interface RobotFacts extends CommonFacts {
  readonly kind: "robot";
  readonly slider: string;
  readonly moving: number;
  readonly steps: readonly RobotStep[];
}

export type ViewFacts = PairFacts | HierarchyFacts | RobotFacts;

/** Largest coordinate of a corner. */
const LAST_STEP = 65535;

/** Reads the facts and the geometry. Parts that are drawn beside the model are apart from it. */
export async function readViewModel(): Promise<{ facts: ViewFacts; model: Model; beside: readonly PlacedPart[] }> {
  const [facts, bytes] = await Promise.all([readJson<ViewFacts>("answer"), readBlock("geometry")]);
  const geometry = readGeometry(bytes);
  const parts = facts.parts.map(([name, type]) => ({ scene: "", name, type }));
  const beside = geometry.parts.splice(parts.length);
  return { facts, model: { geometry, parts, findings: [], up: facts.up }, beside };
}

/** Reads the boxes of each level, six numbers a box: the lower and the upper corner. */
export async function readLevels(): Promise<Float64Array[]> {
  const reader = new ByteReader(await readBlock("levels"));
  const count = reader.integer();
  if (count === 0) return [];
  const low = readVector(reader);
  const size = readVector(reader);
  return Array.from({ length: count }, () => {
    const steps = reader.points(2 * reader.integer());
    return Float64Array.from(steps, (step, at) => low[at % 3] + (size[at % 3] * step) / LAST_STEP);
  });
}

/** Reads the places of the parts that move, for each step. */
export async function readPlaces({ moving, steps }: RobotFacts, { geometry }: Model): Promise<PlacedPart[][]> {
  const reader = new ByteReader(await readBlock("poses"));
  return steps.map(() =>
    Array.from({ length: moving }, (_, place) => {
      const pose = Array.from({ length: 12 }, () => reader.rounded());
      const { mesh } = geometry.parts[place];
      // A part that is drawn as its box stays where the first step has it.
      return mesh === undefined ? geometry.parts[place] : placed(mesh, geometry.meshes[mesh], pose);
    }),
  );
}

/** Returns the box of everything that is in sight at any step. */
export function extentOf(places: readonly (readonly PlacedPart[])[], { geometry }: Model): Box | undefined {
  const corners = [...places.flat(), ...geometry.parts].flatMap(({ box }) => box ?? []);
  return corners.length === 0 ? undefined : around(corners);
}

/** Returns the box that two boxes share, or the box between them. */
export function between(a: Box | undefined, b: Box | undefined): Box | undefined {
  if (a === undefined || b === undefined) return undefined;
  const ends = ([0, 1, 2] as const).map((axis) => {
    const [from, to] = [Math.max(a[0][axis], b[0][axis]), Math.min(a[1][axis], b[1][axis])];
    return [Math.min(from, to), Math.max(from, to)];
  });
  return [0, 1].map((end) => ends.map((pair) => pair[end])) as unknown as Box;
}
