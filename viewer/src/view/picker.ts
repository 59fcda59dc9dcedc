/** Finds the part and the triangle that a ray hits first. */
import { Box3, DoubleSide, Matrix4, Ray, Vector3, type Plane } from "three";
import { MeshBVH } from "three-mesh-bvh";
import type { Placement } from "./placement";

export interface Hit {
  /** Place of the part in the list of all parts. */
  readonly place: number;
  readonly point: Vector3;
  readonly distance: number;
  /** Corners of the triangle. */
  readonly corners: readonly [Vector3, Vector3, Vector3];
}

export class Picker {
  private readonly trees = new Map<number, MeshBVH>();

  constructor(private readonly placement: Placement) {}

  /** Returns the first hit on the kept side of a plane, among the parts for which `isShown` holds. */
  pick(ray: Ray, isShown: (place: number) => boolean, plane?: Plane): Hit | undefined {
    const start = startOf(ray, plane);
    if (start === undefined) return undefined;
    const box = new Box3();
    const entry = new Vector3();
    const candidates: { place: number; entry: number }[] = [];
    this.placement.geometry.parts.forEach((part, place) => {
      if (part.box === undefined || !isShown(place)) return;
      box.min.set(...this.placement.toView(part.box[0]));
      box.max.set(...this.placement.toView(part.box[1]));
      if (box.containsPoint(start.origin)) candidates.push({ place, entry: 0 });
      else if (start.intersectBox(box, entry) !== null) candidates.push({ place, entry: entry.distanceTo(start.origin) });
    });
    candidates.sort((a, b) => a.entry - b.entry);
    let best: Hit | undefined;
    for (const { place, entry } of candidates) {
      if (best !== undefined && entry > best.distance) break;
      const hit = this.hit(start, place);
      if (hit !== undefined && hit.distance < (best?.distance ?? Infinity)) best = hit;
    }
    return best;
  }

  /** Reports whether a ray hits a part. */
  isBlocked(ray: Ray, place: number): boolean {
    return this.placement.geometry.parts[place]?.box !== undefined && this.hit(ray, place) !== undefined;
  }

  private hit(ray: Ray, place: number): Hit | undefined {
    const part = this.placement.geometry.parts[place];
    const shape = this.placement.shapeOf(part);
    const matrix = this.placement.matrix(part);
    const local = ray.clone().applyMatrix4(new Matrix4().copy(matrix).invert());
    const found = this.tree(shape).raycastFirst(local, DoubleSide);
    if (!found?.face) return undefined;
    const positions = this.placement.triangles(shape).getAttribute("position");
    const corner = (index: number) => new Vector3().fromBufferAttribute(positions, index).applyMatrix4(matrix);
    const { a, b, c } = found.face;
    const point = found.point.applyMatrix4(matrix);
    return { place, point, distance: point.distanceTo(ray.origin), corners: [corner(a), corner(b), corner(c)] };
  }

  private tree(shape: number): MeshBVH {
    let tree = this.trees.get(shape);
    if (tree === undefined) {
      tree = new MeshBVH(this.placement.triangles(shape), { indirect: true });
      this.trees.set(shape, tree);
    }
    return tree;
  }
}

/** Returns the ray without its part on the cut side of a plane. */
function startOf(ray: Ray, plane: Plane | undefined): Ray | undefined {
  if (plane === undefined || plane.distanceToPoint(ray.origin) >= 0) return ray;
  const distance = ray.distanceToPlane(plane);
  return distance === null ? undefined : new Ray(ray.at(distance, new Vector3()), ray.direction);
}
