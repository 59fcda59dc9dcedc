/** Finds a direction from which a clash is in sight. */
import { Ray, Vector3 } from "three";
import type { Finding } from "../data/model";
import type { Orbit } from "./orbit";
import type { Picker } from "./picker";
import type { Placement } from "./placement";

/** Angles around the axis that points up, and above the ground, the most pleasant first. */
const YAWS = [-0.9, 0.67, 2.24, -2.47];
const PITCHES = [0.5, 0.15, -0.5, 1.25];

/** Maximum number of points of the clash that are looked at from each direction. */
const POINTS = 24;

/** Returns the direction to the camera from which the fewest points of a clash are hidden by its two parts. */
export function clearestDirection(finding: Finding, target: Vector3, orbit: Orbit, placement: Placement, picker: Picker): Vector3 {
  const points = pointsOf(finding, target, placement);
  const places = finding.places.slice(0, 2).filter((place) => place !== finding.outer);
  let best = orbit.direction({ ...orbit.stance, yaw: YAWS[0], pitch: PITCHES[0] });
  let least = Infinity;
  for (const pitch of PITCHES) {
    for (const yaw of YAWS) {
      const direction = orbit.direction({ ...orbit.stance, yaw, pitch });
      // A curve lies on both surfaces, so that a ray has to start a little before them.
      const isHidden = (point: Vector3) => {
        const ray = new Ray(point.clone().addScaledVector(direction, 1e-3 * point.distanceTo(target) + 1e-9), direction);
        return places.some((place) => picker.isBlocked(ray, place));
      };
      const hidden = points.filter(isHidden).length;
      if (hidden < least) [best, least] = [direction, hidden];
    }
  }
  return best;
}

/** Returns points of the curves, or corners of the box of the clash without curves. */
function pointsOf({ curves, box }: Finding, target: Vector3, placement: Placement): Vector3[] {
  const all = curves.flatMap((line) => Array.from({ length: line.length / 3 }, (_, at) => new Vector3(...placement.toView([line[3 * at], line[3 * at + 1], line[3 * at + 2]]))));
  if (all.length > 0) return all.filter((_, at) => at % Math.ceil(all.length / POINTS) === 0);
  if (box === undefined) return [target];
  const corner = (bits: number) => [0, 1, 2].map((axis) => box[(bits >> axis) & 1][axis]) as [number, number, number];
  return Array.from({ length: 8 }, (_, bits) => new Vector3(...placement.toView(corner(bits))));
}
