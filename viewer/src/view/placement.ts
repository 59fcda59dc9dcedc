/** Places of parts near a movable origin, so that single precision is enough anywhere in the world. */
import { BufferAttribute, BufferGeometry, Matrix4 } from "three";
import type { Geometry, PlacedPart, Vector } from "../data/geometry";

/** The unit cube, which stands for parts without a mesh. */
const CUBE_POSITIONS = Uint16Array.from([0, 1, 2, 3, 4, 5, 6, 7].flatMap((corner) => [0, 1, 2].map((axis) => ((corner >> axis) & 1) * 65535)));
const CUBE_CORNERS = Uint32Array.from([
  [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
  [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
].flat());

export class Placement {
  /** The point of the world that is the origin of the view. */
  origin: Vector = [0, 0, 0];
  private readonly geometries = new Map<number, BufferGeometry>();

  constructor(readonly geometry: Geometry) {}

  /** Returns the number of the shape of a part: that of its mesh, or the next for the cube. */
  shapeOf(part: PlacedPart): number {
    return part.mesh ?? this.geometry.meshes.length;
  }

  /** Returns the triangles of a shape, as steps from 0 to 1 in its box. */
  triangles(shape: number): BufferGeometry {
    let triangles = this.geometries.get(shape);
    if (triangles === undefined) {
      const mesh = this.geometry.meshes[shape];
      triangles = new BufferGeometry();
      triangles.setAttribute("position", new BufferAttribute(mesh?.positions ?? CUBE_POSITIONS, 3, true));
      triangles.setIndex(new BufferAttribute(mesh?.corners ?? CUBE_CORNERS, 1));
      this.geometries.set(shape, triangles);
    }
    return triangles;
  }

  /** Returns the map from the triangles of a part to the view. */
  matrix({ columns: [x, y, z], corner }: PlacedPart): Matrix4 {
    const at = this.toView(corner);
    return new Matrix4().set(
      x[0], y[0], z[0], at[0],
      x[1], y[1], z[1], at[1],
      x[2], y[2], z[2], at[2],
      0, 0, 0, 1,
    );
  }

  toView(point: Vector): Vector {
    return [point[0] - this.origin[0], point[1] - this.origin[1], point[2] - this.origin[2]];
  }

  toWorld(point: { x: number; y: number; z: number }): Vector {
    return [point.x + this.origin[0], point.y + this.origin[1], point.z + this.origin[2]];
  }
}
