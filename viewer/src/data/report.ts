/** The report as `impinge clash --json` writes it, and the facts that the page adds. */
import type { Box, Vector } from "./geometry";

export const STATUSES = ["new", "active", "reviewed", "approved", "resolved"] as const;
export type Status = (typeof STATUSES)[number];

export const KINDS = ["duplicate", "contained", "clash", "undecided", "contact", "clearance"] as const;
export type Kind = (typeof KINDS)[number];

export interface Part {
  scene: string;
  part: number;
  key: string;
  type?: string;
  name: string;
  path?: string[];
}

/** Lower and upper bound; the upper is null if it is not known. */
export type Interval = [number, number | null];

interface Labels {
  id: string;
  rule?: string;
  severity?: string;
  status: Status;
  accepted?: number;
  note?: string;
}

export interface ClashRow extends Labels {
  kind: Kind;
  inner?: "a" | "b";
  a: Part;
  b: Part;
  depth?: Interval;
  gap?: Interval;
  point?: Vector;
  box?: Box;
  proved: boolean;
  why?: string;
}

export interface DuplicateRow extends Labels {
  parts: Part[];
}

export interface GroupRow {
  sentence: string;
  clashes: string[];
}

export interface SceneRow {
  label: string;
  file?: string;
  unit?: string;
  parts: number;
  triangles: number;
  open: number;
  origin?: Vector;
}

export interface Report {
  schema: string;
  version: string;
  unit?: string;
  scenes: SceneRow[];
  asked: { tolerance: number; default_tolerance?: boolean; clearance?: number; sag?: number };
  counts: Record<string, number>;
  decades: { from: number; to: number; pairs: number }[];
  duplicates: DuplicateRow[];
  groups: GroupRow[];
  clashes: ClashRow[];
  /** Clashes of the previous report that no longer exist. */
  gone?: { id: string; kind: string; names: string[]; removed?: string[] }[];
  complete?: boolean;
  stopped?: string;
}

/** An axis of the world. */
export type Axis = "x" | "y" | "z";

/** What the page states beside the report. See `crates/impinge-report/src/html/facts.rs`. */
export interface Facts {
  up: Axis;
  meters?: number;
  sentences: string[];
  scenes: { label: string; parts: [name: string, type: string][] }[];
  boxes: number;
  curves: number;
  max_triangles: number;
  max_curves: number;
  rounding: number;
  bcf?: Bcf;
}

/** What a BCF file has beside the report. See `crates/impinge-report/src/bcf/page.rs`. */
export interface Bcf {
  project: [id: string, name: string];
  author: string;
  colors: [string, string];
  field_of_view: number;
  size: [number, number];
  topics: Topic[];
}

/** A topic of a BCF file. */
export interface Topic {
  guids: [topic: string, comment: string, viewpoint: string];
  title: string;
  kind: string;
  priority: string;
  labels?: string[];
  /** Places in the list of all findings, the worst first. */
  findings: number[];
  part_lines?: string[];
}
