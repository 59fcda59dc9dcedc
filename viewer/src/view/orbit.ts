/** A camera that turns around a target, by mouse, fingers or keys, and flies from one place to the next. */
import { PerspectiveCamera, Vector3 } from "three";
import type { Axis } from "../data/report";

/** Vertical field of view of the page in degrees. */
const FIELD_OF_VIEW = 40;

/** Angle of a turn for each pixel that the pointer moves, and for each press of a key. */
const TURN_PER_PIXEL = 0.006;
const TURN_PER_KEY = Math.PI / 24;

/** Largest angle above the ground: at the pole the camera would not know which way is up. */
const MAX_PITCH = Math.PI / 2 - 0.001;

/** Duration of a flight in milliseconds. */
const FLIGHT_TIME = 650;

/** What the camera looks at, and from where. */
export interface Stance {
  target: Vector3;
  distance: number;
  /** Angle around the axis that points up, and angle above the ground. */
  yaw: number;
  pitch: number;
}

export class Orbit {
  readonly camera: PerspectiveCamera;
  stance: Stance = { target: new Vector3(), distance: 10, yaw: -0.9, pitch: 0.5 };
  /** Largest distance of a part from the origin, which must be in sight. */
  sceneReach = 1;
  private flight: { from: Stance; to: Stance; start: number } | undefined;
  private readonly pointers = new Map<number, { x: number; y: number }>();

  constructor(
    private readonly element: HTMLElement,
    private readonly up: Axis,
    private readonly changed: () => void,
    private readonly fieldOfView = FIELD_OF_VIEW,
  ) {
    this.camera = new PerspectiveCamera(fieldOfView, 1, 0.1, 1000);
    this.camera.up.set(Number(up === "x"), Number(up === "y"), Number(up === "z"));
    element.addEventListener("pointerdown", (event) => this.press(event));
    element.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"] as const) {
      element.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    }
    element.addEventListener("wheel", (event) => this.roll(event), { passive: false });
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("keydown", (event) => this.key(event));
  }

  /** Returns the direction from the target to the camera. */
  direction({ yaw, pitch } = this.stance): Vector3 {
    const [x, y, z] = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
    return { x: new Vector3(z, x, y), y: new Vector3(x, z, -y), z: new Vector3(x, y, z) }[this.up];
  }

  /** Returns the angles of a direction from the target to the camera. */
  angles(direction: Vector3): { yaw: number; pitch: number } {
    const { x, y, z } = direction.clone().normalize();
    const [along, across, above] = { x: [y, z, x], y: [x, -z, y], z: [x, y, z] }[this.up];
    return { yaw: Math.atan2(across, along), pitch: Math.asin(Math.min(Math.max(above, -1), 1)) };
  }

  /** Returns the distance from which a sphere fills most of the view. */
  distanceFor(radius: number): number {
    const half = (this.fieldOfView / 2) * (Math.PI / 180);
    const narrow = Math.min(1, this.camera.aspect);
    return radius / Math.sin(half) / narrow;
  }

  /** Moves to another place, at once if the person wants no motion. */
  fly(to: Stance): void {
    const turn = to.yaw - this.stance.yaw;
    const yaw = to.yaw - 2 * Math.PI * Math.round(turn / (2 * Math.PI)); // the shorter way around
    const pitch = Math.min(Math.max(to.pitch, -MAX_PITCH), MAX_PITCH);
    const end = { ...to, yaw, pitch };
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) {
      this.stance = end;
      this.flight = undefined;
    } else {
      const from = { ...this.stance, target: this.stance.target.clone() };
      this.flight = { from, to: end, start: performance.now() };
    }
    this.changed();
  }

  /** Moves all places by a vector, after the origin of the view moved. */
  shift(by: Vector3): void {
    const stances = new Set([this.stance, ...(this.flight === undefined ? [] : [this.flight.from, this.flight.to])]);
    for (const target of new Set([...stances].map((stance) => stance.target))) target.add(by);
  }

  /** Places the camera, and returns whether it still flies. */
  update(now: number): boolean {
    if (this.flight !== undefined) this.advance(now, this.flight);
    const { target, distance } = this.stance;
    this.camera.position.copy(target).addScaledVector(this.direction(), distance);
    this.camera.lookAt(target);
    // A near plane close to the eye costs depth precision at the target, which needs it.
    this.camera.near = distance / 100;
    this.camera.far = this.camera.position.length() + this.sceneReach;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    return this.flight !== undefined;
  }

  /** Returns the length that a pixel shows at the target. */
  lengthOfPixel(): number {
    const height = 2 * this.stance.distance * Math.tan((this.fieldOfView / 2) * (Math.PI / 180));
    return height / Math.max(this.element.clientHeight, 1);
  }

  private advance(now: number, { from, to, start }: { from: Stance; to: Stance; start: number }): void {
    const part = Math.min((now - start) / FLIGHT_TIME, 1);
    const eased = part * part * (3 - 2 * part);
    const mix = (a: number, b: number) => a + (b - a) * eased;
    // Farther away in the middle of a long flight, so that the person sees where it leads.
    const leap = from.target.distanceTo(to.target) / (from.distance + to.distance);
    const rise = 1 + Math.min(leap, 4) * Math.sin(Math.PI * eased) * 0.5;
    this.stance = {
      target: from.target.clone().lerp(to.target, eased),
      distance: Math.exp(mix(Math.log(from.distance), Math.log(to.distance))) * rise,
      yaw: mix(from.yaw, to.yaw),
      pitch: mix(from.pitch, to.pitch),
    };
    if (part === 1) this.flight = undefined;
  }

  private press(event: PointerEvent): void {
    this.element.focus({ preventScroll: true });
    this.element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.flight = undefined;
  }

  private drag(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (before === undefined) return;
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other !== undefined) {
      const gap = (point: { x: number; y: number }) => Math.hypot(point.x - other.x, point.y - other.y) || 1;
      this.zoom(gap(before) / gap({ x: event.clientX, y: event.clientY }));
      this.pan(dx / 2, dy / 2);
    } else if (event.buttons === 1 && !event.shiftKey) {
      this.turn(-dx * TURN_PER_PIXEL, dy * TURN_PER_PIXEL);
    } else {
      this.pan(dx, dy);
    }
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }

  private roll(event: WheelEvent): void {
    event.preventDefault();
    this.flight = undefined;
    const factor = Math.exp(Math.min(Math.max(event.deltaY, -200), 200) * 0.0015);
    const frame = this.element.getBoundingClientRect();
    // The point under the pointer stays where it is.
    const [dx, dy] = [event.clientX - frame.left - frame.width / 2, event.clientY - frame.top - frame.height / 2];
    this.pan(-dx * (1 - factor), -dy * (1 - factor));
    this.zoom(factor);
  }

  private key(event: KeyboardEvent): void {
    const arrows: Record<string, readonly [number, number]> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
    };
    const arrow = arrows[event.key];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (arrow !== undefined && event.shiftKey) this.pan(-40 * arrow[0], 40 * arrow[1]);
    else if (arrow !== undefined) this.turn(arrow[0] * TURN_PER_KEY, arrow[1] * TURN_PER_KEY);
    else if (event.key === "+" || event.key === "=") this.zoom(0.8);
    else if (event.key === "-") this.zoom(1.25);
    else return;
    this.flight = undefined;
    event.preventDefault();
  }

  private turn(yaw: number, pitch: number): void {
    this.stance.yaw += yaw;
    this.stance.pitch = Math.min(Math.max(this.stance.pitch + pitch, -MAX_PITCH), MAX_PITCH);
    this.changed();
  }

  private pan(dx: number, dy: number): void {
    const right = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const above = new Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
    const length = this.lengthOfPixel();
    this.stance.target.addScaledVector(right, -dx * length).addScaledVector(above, dy * length);
    this.changed();
  }

  private zoom(factor: number): void {
    this.stance.distance *= factor;
    this.changed();
  }
}
