/** The plane that cuts the model open. */
import { Plane, Vector3 } from "three";
import type { SectionAxis } from "../state";

export class Section {
  readonly plane = new Plane();
  /** Distance of the plane from the point of the clash, as a share of the reach of the view. */
  offset = 0;
  private normal = new Vector3(1, 0, 0);

  /** Chooses the direction of the plane, so that the half before the camera is cut away. */
  turn(axis: SectionAxis, toCamera: Vector3): void {
    if (axis === "view") {
      this.normal = toCamera.clone().normalize().negate();
    } else {
      const along = new Vector3(Number(axis === "x"), Number(axis === "y"), Number(axis === "z"));
      this.normal = along.multiplyScalar(along.dot(toCamera) > 0 ? -1 : 1);
    }
  }

  /** Moves the plane to a point of the view. */
  moveTo(point: Vector3, reach: number): void {
    this.plane.setFromNormalAndCoplanarPoint(this.normal, point.clone().addScaledVector(this.normal, this.offset * reach));
  }
}

/** Returns the axis of the world that is closest to a direction. */
export function nearestAxis({ x, y, z }: Vector3): SectionAxis {
  const sizes = [Math.abs(x), Math.abs(y), Math.abs(z)];
  return (["x", "y", "z"] as const)[sizes.indexOf(Math.max(...sizes))];
}
