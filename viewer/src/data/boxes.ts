/** Boxes in the world. */
import type { Box, Vector } from "./geometry";

export function middle([low, high]: Box): Vector {
  return [0, 1, 2].map((axis) => 0.5 * low[axis] + 0.5 * high[axis]) as unknown as Vector;
}

/** Returns the length of the diagonal, or 0 without a box. */
export function diagonal(box: Box | undefined): number {
  return box === undefined ? 0 : Math.hypot(...[0, 1, 2].map((axis) => box[1][axis] - box[0][axis]));
}

/** Returns the smallest box around points. There must be one. */
export function around(points: Iterable<Vector>): Box {
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (const point of points) {
    for (let axis = 0; axis < 3; axis++) {
      low[axis] = Math.min(low[axis], point[axis]);
      high[axis] = Math.max(high[axis], point[axis]);
    }
  }
  return [low, high];
}
