/** Measures the distance of two points, which snap to corners and edges. */
import {
  BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial, Vector3,
  type PerspectiveCamera,
} from "three";
import type { Lengths } from "../data/length";
import { get } from "../elements";
import type { Theme } from "./colors";
import type { Hit } from "./picker";

/** Distance in pixels at which a point snaps to a corner, and to an edge. */
const CORNER_REACH = 14;
const EDGE_REACH = 9;

export interface Snapped {
  readonly point: Vector3;
  readonly to: "corner" | "edge" | "face";
}

export class Measure {
  readonly group = new Group();
  private points: Vector3[] = [];
  private readonly label = get("measure-label");

  constructor(private readonly lengths: Lengths) {}

  /** Adds a point. After the second, the next begins a new measurement. */
  add(point: Vector3, theme: Theme): void {
    this.points = this.points.length === 2 ? [point] : [...this.points, point];
    this.draw(theme);
  }

  clear(): void {
    this.points = [];
    for (const object of this.group.children as Points<BufferGeometry, PointsMaterial>[]) {
      object.geometry.dispose();
      object.material.dispose();
    }
    this.group.clear();
    this.label.hidden = true;
  }

  shift(by: Vector3): void {
    for (const point of this.points) point.add(by);
    this.group.position.add(by);
  }

  /** Puts the label beside the line. */
  placeLabel(toScreen: (point: Vector3) => { x: number; y: number }): void {
    const [a, b] = this.points;
    this.label.hidden = b === undefined;
    if (b === undefined) return;
    const { x, y } = toScreen(a.clone().lerp(b, 0.5));
    this.label.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px) translate(-50%, -140%)`;
  }

  private draw(theme: Theme): void {
    const points = this.points;
    this.clear();
    this.points = points;
    this.group.position.set(0, 0, 0);
    const geometry = new BufferGeometry().setFromPoints(points);
    const options = { color: theme.edge === 0x1b2330 ? 0x000000 : 0xffffff, depthTest: false, transparent: true };
    const ends = new Points(geometry, new PointsMaterial({ ...options, size: 7, sizeAttenuation: false }));
    ends.renderOrder = 40;
    this.group.add(ends);
    const [a, b] = points;
    if (b === undefined) return;
    const line = new BufferGeometry();
    line.setAttribute("position", new BufferAttribute(Float32Array.from([...a.toArray(), ...b.toArray()]), 3));
    const drawn = new LineSegments(line, new LineBasicMaterial(options));
    drawn.renderOrder = 40;
    this.group.add(drawn);
    const along = b.clone().sub(a);
    const axes = (["x", "y", "z"] as const).map((axis) => `${axis} ${this.lengths.text(Math.abs(along[axis]))}`);
    this.label.replaceChildren(this.lengths.text(along.length()), document.createElement("br"), axes.join("   "));
  }
}

/** Returns the corner or the point of an edge of the hit triangle that is close on the screen, or the hit itself. */
export function snap(hit: Hit, camera: PerspectiveCamera, height: number): Snapped {
  const perPixel = (2 * hit.point.distanceTo(camera.position) * Math.tan((camera.fov / 2) * (Math.PI / 180))) / height;
  const reach = (point: Vector3) => point.distanceTo(hit.point) / perPixel;
  const [corner] = [...hit.corners].sort((a, b) => reach(a) - reach(b));
  if (reach(corner) < CORNER_REACH) return { point: corner.clone(), to: "corner" };
  const [edge] = hit.corners
    .map((from, at) => nearestOn(from, hit.corners[(at + 1) % 3], hit.point))
    .sort((a, b) => reach(a) - reach(b));
  if (reach(edge) < EDGE_REACH) return { point: edge, to: "edge" };
  return { point: hit.point.clone(), to: "face" };
}

function nearestOn(from: Vector3, to: Vector3, point: Vector3): Vector3 {
  const along = to.clone().sub(from);
  const share = point.clone().sub(from).dot(along) / (along.lengthSq() || 1);
  return from.clone().addScaledVector(along, Math.min(Math.max(share, 0), 1));
}
