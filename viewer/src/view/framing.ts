/** What the camera shows: a finding, its parts, or the whole model. */
import { around, diagonal } from "../data/boxes";
import type { Box } from "../data/geometry";
import type { Finding, Model } from "../data/model";

export class Framing {
  /** The box around all parts. */
  readonly whole: Box;

  constructor(private readonly model: Model) {
    const corners = model.geometry.parts.flatMap((part) => part.box ?? []);
    this.whole = model.extent ?? (corners.length === 0 ? [[-1, -1, -1], [1, 1, 1]] : around(corners));
  }

  /** Returns half of the length that the camera shows of a clash: its box, and enough of its parts to know them. */
  reachOf(finding: Finding | undefined): number {
    if (finding === undefined) return diagonal(this.whole) / 2;
    const all = finding.places.slice(0, 2).map((place) => diagonal(this.model.geometry.parts[place]?.box));
    const sizes = all.filter((size) => size > 0);
    const own = Math.max(0.75 * diagonal(finding.extent), 1e-9);
    if (sizes.length === 0) return own;
    const [least, most] = [Math.min(...sizes), Math.max(...sizes)];
    return Math.max(own, 0.12 * least, 0.05 * Math.sqrt(least * most));
  }

  /** Returns the box of a finding, or that of its parts. */
  boxOf(finding: Finding, isWhole: boolean): Box {
    const { parts } = this.model.geometry;
    const own = finding.places.flatMap((place) => parts[place]?.box ?? []);
    if (!isWhole && finding.extent !== undefined) return finding.extent;
    return own.length === 0 ? this.whole : around(own);
  }
}
