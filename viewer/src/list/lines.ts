/** The lines of the list: findings, and heads of groups that can be folded. */
import type { ClashModel, Finding } from "../data/model";

export interface Head {
  readonly kind: "head";
  readonly group: number;
  readonly title: string;
  readonly count: number;
  readonly isFolded: boolean;
}

export interface Item {
  readonly kind: "item";
  readonly finding: Finding;
  readonly isInGroup: boolean;
}

export type Line = Head | Item;

/** Knows the group of each finding. Groups of one finding have no head. */
export class Groups {
  private readonly titles: string[] = [];
  private readonly groupOf: Int32Array;

  constructor(model: ClashModel) {
    this.groupOf = new Int32Array(model.findings.length).fill(-1);
    const duplicates = model.findings.filter(({ kind }) => kind === "duplicate");
    if (duplicates.length > 1) this.add("Duplicates: one shape in one place", duplicates);
    for (const { sentence, clashes } of model.report.groups) {
      const members = clashes.flatMap((id) => model.byId.get(id) ?? []);
      this.add(sentence, members);
    }
  }

  private add(title: string, members: readonly Finding[]): void {
    for (const { index } of members) this.groupOf[index] = this.titles.length;
    this.titles.push(title);
  }

  /** Returns the lines for some findings. Groups come in the order of their first finding in the report's groups. */
  lines(kept: readonly Finding[], folded: ReadonlySet<number>): Line[] {
    const members: Finding[][] = this.titles.map(() => []);
    const alone: Finding[] = [];
    for (const finding of kept) (members[this.groupOf[finding.index]] ?? alone).push(finding);
    const lines: Line[] = [];
    members.forEach((found, group) => {
      if (found.length > 1) {
        const isFolded = folded.has(group);
        lines.push({ kind: "head", group, title: this.titles[group], count: found.length, isFolded });
        if (isFolded) return;
      }
      for (const finding of found) lines.push({ kind: "item", finding, isInGroup: found.length > 1 });
    });
    for (const finding of alone) lines.push({ kind: "item", finding, isInGroup: false });
    return lines;
  }

  of(finding: Finding): number {
    return this.groupOf[finding.index];
  }

  /** Returns all groups. */
  all(): number[] {
    return this.titles.map((_, group) => group);
  }
}

/** Returns the lines of a list without groups. */
export function flatLines(kept: readonly Finding[]): Line[] {
  return kept.map((finding) => ({ kind: "item", finding, isInGroup: false }));
}
