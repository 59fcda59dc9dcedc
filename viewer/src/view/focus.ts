/** The parts of the selected finding: solid, with their edges, their curves and the point of the clash. */
import {
  BackSide, BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh,
  Points, Vector2, type Plane,
} from "three";
import type { Finding } from "../data/model";
import { FIRST, SECOND, type Theme } from "./colors";
import { FacetMaterial } from "./facet-material";
import { featureEdges } from "./feature-edges";
import type { Placement } from "./placement";
import { dots } from "./dots";
import { WideLines, wideLines } from "./wide-lines";

/** Opacity of a part that contains another. Its front is left out, so that the other is in sight. */
const OUTER_OPACITY = 0.45;

/** Largest number of duplicates of one set that are drawn: they are all in one place. */
const MAX_PARTS = 8;

export class Focus {
  readonly group = new Group();
  private planes: Plane[] = [];
  private size = new Vector2(1, 1);

  constructor(private readonly placement: Placement) {}

  /** Draws the parts of a finding that are not hidden. */
  show(finding: Finding | undefined, hidden: ReadonlySet<number>, theme: Theme): void {
    this.clear();
    if (finding === undefined) return;
    const places = finding.places.slice(0, MAX_PARTS);
    // All duplicates are in one place, so only the first is solid.
    const isStack = finding.kind === "duplicate";
    places.forEach((place, at) => {
      if (!hidden.has(place)) this.addPart(place, at === 0 ? FIRST : SECOND, place === finding.outer || (isStack && at > 0), theme);
    });
    this.addCurves(finding, theme);
    this.addPoint(finding, theme);
    this.setClipping(this.planes);
  }

  setClipping(planes: Plane[]): void {
    this.planes = planes;
    this.group.traverse((object) => {
      const { material, userData } = object as Mesh;
      if (material !== undefined && !Array.isArray(material) && userData["isClipped"] === true) material.clippingPlanes = planes;
    });
  }

  /** Tells the size of the canvas in pixels, on which the width of curves depends. */
  setSize(width: number, height: number): void {
    this.size = new Vector2(width, height);
    this.group.traverse((object) => {
      if (object instanceof WideLines) object.setSize(this.size);
    });
  }

  private clear(): void {
    this.group.traverse((object) => {
      // The triangles belong to the placement, and are used again.
      if (object instanceof LineSegments || object instanceof WideLines || object instanceof Points) object.geometry.dispose();
      const { material } = object as Mesh;
      if (material !== undefined && !Array.isArray(material)) material.dispose();
    });
    this.group.clear();
  }

  private addPart(place: number, color: number, isTranslucent: boolean, theme: Theme): void {
    const part = this.placement.geometry.parts[place];
    if (part?.box === undefined) return;
    const triangles = this.placement.triangles(this.placement.shapeOf(part));
    const matrix = this.placement.matrix(part);
    const material = new FacetMaterial({
      color,
      side: isTranslucent ? BackSide : DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
      transparent: isTranslucent,
      opacity: isTranslucent ? OUTER_OPACITY : 1,
      depthWrite: !isTranslucent,
    });
    const mesh = new Mesh(triangles, material);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(matrix);
    mesh.renderOrder = isTranslucent ? 5 : 0;
    mesh.userData["isClipped"] = true;
    const edges = new BufferGeometry();
    edges.setAttribute("position", new BufferAttribute(featureEdges(triangles, matrix), 3));
    const edge = new LineBasicMaterial({ color: new Color(color).lerp(new Color(theme.edge), 0.7), transparent: isTranslucent });
    const lines = new LineSegments(edges, edge);
    lines.userData["isClipped"] = true;
    lines.renderOrder = isTranslucent ? 6 : 1;
    this.group.add(mesh, lines);
  }

  private addCurves(finding: Finding, theme: Theme): void {
    const ends: number[] = [];
    for (const line of finding.curves) {
      for (let at = 0; at + 5 < line.length; at += 3) {
        ends.push(...this.placement.toView([line[at], line[at + 1], line[at + 2]]));
        ends.push(...this.placement.toView([line[at + 3], line[at + 4], line[at + 5]]));
      }
    }
    if (ends.length > 0) this.group.add(...wideLines(ends, theme.shared, this.size));
  }

  private addPoint(finding: Finding, theme: Theme): void {
    if (finding.point === undefined) return;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from(this.placement.toView(finding.point)), 3));
    this.group.add(...dots(geometry, theme));
  }
}
