/** The edges of a mesh at which its surface bends: borders, and edges with a visible angle. */
import type { BufferGeometry, Matrix4 } from "three";
import { Vector3 } from "three";

/** Cosine of the angle from which an edge is drawn, about 25 degrees. Facets of round parts bend less. */
const SMOOTH = 0.9;

/** Largest number of triangles whose edges are found: more take too long, and their edges hide them. */
const MAX_TRIANGLES = 400_000;

/** Returns the ends of the edges, three numbers a point, in the frame that `matrix` maps to. */
export function featureEdges(triangles: BufferGeometry, matrix: Matrix4): Float32Array {
  const index = triangles.getIndex();
  const position = triangles.getAttribute("position");
  if (index === null || index.count / 3 > MAX_TRIANGLES) return new Float32Array();
  const points = Array.from({ length: position.count }, (_, at) => new Vector3().fromBufferAttribute(position, at).applyMatrix4(matrix));
  const normals = new Map<number, Vector3>();
  const lines: number[] = [];
  const draw = (a: number, b: number) => lines.push(...points[a].toArray(), ...points[b].toArray());
  for (let face = 0; face < index.count; face += 3) {
    const corners = [index.getX(face), index.getX(face + 1), index.getX(face + 2)];
    const [p, q, r] = corners.map((corner) => points[corner]);
    const normal = new Vector3().subVectors(q, p).cross(new Vector3().subVectors(r, p)).normalize();
    for (let side = 0; side < 3; side++) {
      const a = corners[side];
      const b = corners[(side + 1) % 3];
      const key = Math.min(a, b) * position.count + Math.max(a, b);
      const other = normals.get(key);
      if (other === undefined) {
        normals.set(key, normal);
      } else {
        if (other.dot(normal) < SMOOTH) draw(a, b);
        normals.delete(key);
      }
    }
  }
  for (const key of normals.keys()) draw(Math.floor(key / position.count), key % position.count);
  return Float32Array.from(lines);
}
