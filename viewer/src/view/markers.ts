/** A dot at each finding in the list, while none is selected. */
import { BufferAttribute, BufferGeometry, Points, PointsMaterial, Vector3 } from "three";
import type { Vector } from "../data/geometry";
import type { Finding } from "../data/model";
import type { Theme } from "./colors";
import type { Placement } from "./placement";

export class Markers {
  readonly points = new Points(
    new BufferGeometry(),
    new PointsMaterial({ size: 6, sizeAttenuation: false, depthTest: false, transparent: true, opacity: 0.85 }),
  );
  private findings: readonly Finding[] = [];

  constructor(private readonly placement: Placement) {
    this.points.renderOrder = 25;
    this.points.frustumCulled = false;
    this.points.material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <clipping_planes_fragment>",
        "#include <clipping_planes_fragment>\nif (length(gl_PointCoord - 0.5) > 0.5) discard;",
      );
    };
  }

  /** Shows a dot for each finding. */
  show(findings: readonly Finding[]): void {
    this.findings = findings.filter((finding) => placeOf(finding) !== undefined);
    const places = this.findings.flatMap((finding) => [...this.placement.toView(placeOf(finding) ?? [0, 0, 0])]);
    this.points.geometry.dispose();
    this.points.geometry = new BufferGeometry();
    this.points.geometry.setAttribute("position", new BufferAttribute(Float32Array.from(places), 3));
  }

  setTheme(theme: Theme): void {
    this.points.material.color.setHex(theme.shared);
  }

  /** Returns the finding whose dot is within some pixels of a point of the screen. */
  at(x: number, y: number, toScreen: (point: Vector3) => { x: number; y: number }, reach = 9): Finding | undefined {
    let best: Finding | undefined;
    let least = reach;
    for (const finding of this.findings) {
      const dot = toScreen(new Vector3(...this.placement.toView(placeOf(finding) ?? [0, 0, 0])));
      const distance = Math.hypot(dot.x - x, dot.y - y);
      if (distance < least) [best, least] = [finding, distance];
    }
    return best;
  }
}

/** Returns the place of a finding: its point, or the middle of its box if that shows more of it. */
export function placeOf({ kind, point, box }: Finding): Vector | undefined {
  // A point that proves that one part is inside another may be at its surface.
  if (box === undefined || (point !== undefined && kind !== "contained")) return point;
  return [0, 1, 2].map((axis) => 0.5 * box[0][axis] + 0.5 * box[1][axis]) as unknown as Vector;
}
