/** All parts of the model, drawn in one call: ghosts around the selected ones, or solid. */
import { BatchedMesh, Color, DoubleSide, MeshLambertMaterial, type Plane, type Vector3 } from "three";
import type { Theme } from "./colors";
import { GhostMaterial } from "./ghost-material";
import type { Placement } from "./placement";

/** Factors of the color of a part: as it is, and marked. The color of a ghost is dark, so that the factors are large. */
const PLAIN = new Color(1, 1, 1);
const MARKED = new Color(0.3, 4, 3.2);

export class Context {
  readonly mesh: BatchedMesh;
  private readonly ghost = new GhostMaterial();
  private readonly solid = new MeshLambertMaterial({ side: DoubleSide, flatShading: true });
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
