/** Which findings the list keeps. */
import type { Finding } from "../data/model";
import type { Kind, Status } from "../data/report";

export interface Filter {
  /** Kinds that are left out. */
  readonly withoutKinds: ReadonlySet<Kind>;
  /** Statuses that are left out. */
  readonly withoutStatuses: ReadonlySet<Status>;
  /** Rule, scene and type that a finding must have; empty for any. */
  readonly rule: string;
  readonly scene: string;
  readonly type: string;
  /** Least depth in world units. Findings without a depth are kept. */
  readonly minDepth: number;
  /** Words, all of which a finding must contain, in lower case. */
  readonly words: readonly string[];
  /** Place of a part that a finding must have. */
  readonly part: number | undefined;
}

/** Returns the filter that keeps everything. */
export function noFilter(): Filter {
  return {
    withoutKinds: new Set(),
    withoutStatuses: new Set(),
    rule: "",
    scene: "",
    type: "",
    minDepth: 0,
    words: [],
    part: undefined,
  };
}

export function isEmpty(filter: Filter): boolean {
  const { withoutKinds, withoutStatuses, rule, scene, type, minDepth, words, part } = filter;
  const isAny = rule === "" && scene === "" && type === "" && minDepth === 0 && part === undefined;
  return isAny && withoutKinds.size === 0 && withoutStatuses.size === 0 && words.length === 0;
}

export function matches(finding: Finding, filter: Filter): boolean {
  return (
    !filter.withoutKinds.has(finding.kind) &&
    !filter.withoutStatuses.has(finding.row.status) &&
    (filter.rule === "" || finding.rule === filter.rule) &&
    (filter.scene === "" || finding.parts.some((part) => part.scene === filter.scene)) &&
    (filter.type === "" || finding.parts.some((part) => part.type === filter.type)) &&
    (finding.depth === undefined || (finding.depth[1] ?? Infinity) >= filter.minDepth) &&
    (filter.part === undefined || finding.places.includes(filter.part)) &&
    filter.words.every((word) => finding.text.includes(word))
  );
}

/** Returns the words of a search. */
export function wordsOf(search: string): string[] {
  return search.toLowerCase().split(/\s+/).filter((word) => word !== "");
}
