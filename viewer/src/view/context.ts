/** All parts of the model, drawn in one call: ghosts around the selected ones, or solid. */
import { BatchedMesh, Color, Vector3, type Plane } from "three";
import { diagonal, middle } from "../data/boxes";
import type { PlacedPart } from "../data/geometry";
import type { Theme } from "./colors";
import { FacetMaterial } from "./facet-material";
import { GhostMaterial } from "./ghost-material";
import type { Placement } from "./placement";

/** Factors of the color of a part: as it is, and marked. The color of a ghost is dark, so that the factors are large. */
const PLAIN = new Color(1, 1, 1);
const MARKED = new Color(0.3, 4, 3.2);

/** Number of triangles that a slow machine draws around the selected parts while the camera moves. */
const FEW_TRIANGLES = 5000;

export class Context {
  readonly mesh: BatchedMesh;
  private readonly ghost = new GhostMaterial();
  private readonly solid = new FacetMaterial();
  /** Instance of each part, or -1 if the part is not drawn. */
  private readonly instances: Int32Array;
  private marked: number | undefined;

  constructor(private readonly placement: Placement) {
    const { parts } = placement.geometry;
    const used = [...new Set(parts.filter((part) => part.box !== undefined).map((part) => placement.shapeOf(part)))];
    const triangles = used.map((shape) => placement.triangles(shape));
    const points = triangles.reduce((sum, each) => sum + each.getAttribute("position").count, 0);
    const corners = triangles.reduce((sum, each) => sum + (each.getIndex()?.count ?? 0), 0);
    this.mesh = new BatchedMesh(Math.max(parts.length, 1), Math.max(points, 1), Math.max(corners, 1), this.ghost);
    this.mesh.sortObjects = false;
    this.mesh.renderOrder = 10; // after everything that is solid
    const ids = new Map(used.map((shape, at) => [shape, this.mesh.addGeometry(triangles[at])]));
    this.instances = Int32Array.from(parts, (part) => {
      const id = part.box === undefined ? undefined : ids.get(placement.shapeOf(part));
      return id === undefined ? -1 : this.mesh.addInstance(id);
    });
    this.place();
  }

  /** Places all parts again, after the origin of the view moved. */
  place(): void {
    this.placement.geometry.parts.forEach((part, at) => {
      if (this.instances[at] >= 0) this.mesh.setMatrixAt(this.instances[at], this.placement.matrix(part));
    });
    this.mesh.boundingSphere = null;
    this.mesh.boundingBox = null;
  }

  /** Shows the parts for which `isShown` holds. */
  show(isShown: (place: number) => boolean): void {
    this.instances.forEach((instance, place) => {
      if (instance >= 0) this.mesh.setVisibleAt(instance, isShown(place));
    });
  }

  /** Returns the parts that matter most in a view of a place: large ones, and ones near it. They have few triangles together. */
  mostVisible(place: Vector3, reach: number): ReadonlySet<number> {
    const { parts } = this.placement.geometry;
    const weigh = ({ box }: PlacedPart) => {
      const distance = box === undefined ? Infinity : place.distanceTo(new Vector3(...this.placement.toView(middle(box))));
      return diagonal(box) / (distance + reach);
    };
    const order = parts.map((part, at) => [weigh(part), at] as const).sort((a, b) => b[0] - a[0]);
    const kept = new Set<number>();
    let left = FEW_TRIANGLES;
    for (const [, at] of order) {
      const triangles = (this.placement.triangles(this.placement.shapeOf(parts[at])).getIndex()?.count ?? 0) / 3;
      if (triangles > left) continue;
      left -= triangles;
      kept.add(at);
    }
    return kept;
  }

  /** Gives a part another color, and the part that had it before its own. */
  mark(place: number | undefined): void {
    const paint = (at: number | undefined, color: Color) => {
      if (at !== undefined && this.instances[at] >= 0) this.mesh.setColorAt(this.instances[at], color);
    };
    paint(this.marked, PLAIN);
    paint(place, MARKED);
    this.marked = place;
  }

  setSolid(isSolid: boolean): void {
    this.mesh.material = isSolid ? this.solid : this.ghost;
  }

  setTheme(theme: Theme): void {
    this.ghost.setLook(theme.ghost, theme.ghostOpacity);
    this.solid.color = new Color(theme.solid);
  }

  setClipping(planes: Plane[]): void {
    this.ghost.clippingPlanes = planes;
    this.solid.clippingPlanes = planes;
  }

  setPivot(pivot: Vector3, reach: number): void {
    this.ghost.setPivot(pivot, reach);
  }
}
