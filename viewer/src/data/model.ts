/** Everything that a page shows in its view: parts, geometry and findings. A report of clashes has more. */
import { around } from "./boxes";
import { readBlock, readJson } from "./blocks";
import { readGeometry, type Box, type Geometry, type Polyline, type Vector } from "./geometry";
import type { Axis, ClashRow, DuplicateRow, Facts, Interval, Kind, Part, Report, Status } from "./report";

/** A clash or a set of duplicates, as the list shows it. */
export interface Finding {
  /** Place in the list of all findings: duplicates first, then clashes, the worst first. */
  readonly index: number;
  readonly id: string;
  readonly kind: Kind;
  readonly sentence: string;
  readonly parts: readonly Part[];
  /** Places of the parts in the list of all parts. */
  readonly places: readonly number[];
  /** The place of the part that contains the other, if the kind is "contained". */
  readonly outer: number | undefined;
  readonly rule: string | undefined;
  readonly severity: string | undefined;
  readonly depth: Interval | undefined;
  readonly gap: Interval | undefined;
  readonly point: Vector | undefined;
  readonly box: Box | undefined;
  /** The box of what there is to see: of the curves, or else the box of the report. */
  readonly extent: Box | undefined;
  readonly proved: boolean;
  readonly why: string | undefined;
  readonly curves: readonly Polyline[];
  /** Everything that a search looks at, in lower case. */
  readonly text: string;
  /** The row of the report, which people edit. */
  readonly row: { status: Status; note?: string; accepted?: number };
}

/** A part as the view names it. */
export interface NamedPart {
  readonly scene: string;
  readonly name: string;
  readonly type: string;
}

export interface Model {
  readonly geometry: Geometry;
  readonly parts: readonly NamedPart[];
  readonly findings: readonly Finding[];
  readonly up: Axis;
  /** The box of everything that is ever in sight; that of all parts in their first places if it is undefined. */
  readonly extent?: Box | undefined;
}

/** A report of clashes. */
export interface ClashModel extends Model {
  readonly report: Report;
  readonly facts: Facts;
  readonly byId: ReadonlyMap<string, Finding>;
}

/** Reads the data of a report of clashes. */
export async function readClashModel(): Promise<ClashModel> {
  const [report, facts, bytes] = await Promise.all([
    readJson<Report>("report"),
    readJson<Facts>("facts"),
    readBlock("geometry"),
  ]);
  const geometry = readGeometry(bytes);
  const parts = facts.scenes.flatMap(({ label, parts }) => parts.map(([name, type]) => ({ scene: label, name, type })));
  const firsts = new Map<string, number>();
  let next = 0;
  for (const { label, parts } of facts.scenes) {
    firsts.set(label, next);
    next += parts.length;
  }
  const place = (part: Part) => (firsts.get(part.scene) ?? 0) + part.part;
  const clashCount = report.clashes.length;
  const sets = report.duplicates.map((row, at) => {
    const box = geometry.parts[place(row.parts[0])]?.box;
    return finding(row, row.parts, { index: at, kind: "duplicate", sentence: facts.sentences[clashCount + at], box }, row.parts.map(place));
  });
  const clashes = report.clashes.map((row, at) => {
    const outer = row.inner === "a" ? place(row.b) : row.inner === "b" ? place(row.a) : undefined;
    const curves = geometry.curves.get(at) ?? [];
    const own = { index: sets.length + at, kind: row.kind, sentence: facts.sentences[at], box: row.box, outer, curves };
    return finding(row, [row.a, row.b], own, [place(row.a), place(row.b)]);
  });
  const findings = [...sets, ...clashes];
  return { report, facts, geometry, parts, findings, up: facts.up, byId: new Map(findings.map((each) => [each.id, each])) };
}

type Own = Pick<Finding, "index" | "kind" | "sentence" | "box"> & Partial<Pick<Finding, "outer" | "curves">>;

function finding(row: ClashRow | DuplicateRow, parts: Part[], own: Own, places: readonly number[]): Finding {
  const clash = "kind" in row ? row : undefined;
  const words = parts.slice(0, 4).flatMap(({ scene, key, type, name, path }) => [scene, key, type ?? "", name, ...(path ?? [])]);
  return {
    ...own,
    outer: own.outer,
    curves: own.curves ?? [],
    extent: extentOf(own, clash?.point),
    id: row.id,
    parts,
    places,
    rule: row.rule,
    severity: row.severity,
    depth: clash?.depth,
    gap: clash?.gap,
    point: clash?.point,
    proved: clash?.proved ?? true,
    why: clash?.why,
    text: [row.id, own.kind, row.rule ?? "", row.severity ?? "", own.sentence, ...words].join("\n").toLowerCase(),
    row,
  };
}

/** Returns a finding about two parts that no report states. */
export function pairOf(places: readonly number[], sentence: string, own: Partial<Pick<Finding, "box" | "curves">>): Finding {
  const about: Own = { index: 0, kind: "clash", sentence, box: undefined, ...own };
  return finding({ id: "pair", status: "new", parts: [] }, [], about, places);
}

function extentOf({ kind, box, curves = [] }: Own, point: Vector | undefined): Box | undefined {
  // The curves of a part inside another show only where it touches the other from inside.
  if (kind === "contained" || curves.length === 0) return box;
  const points = curves.flatMap((line) => Array.from({ length: line.length / 3 }, (_, at) => [...line.subarray(3 * at, 3 * at + 3)] as unknown as Vector));
  return around(point === undefined ? points : [...points, point]);
}
