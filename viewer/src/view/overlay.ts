/** What a page draws in its view beside parts and findings. */
import type { Object3D, Plane, Vector3 } from "three";
import type { Theme } from "./colors";

export interface Overlay {
  readonly group: Object3D;
  /** Draws everything again: the theme, the origin of the view or the hidden parts changed. */
  show(theme: Theme, hidden: ReadonlySet<number>): void;
  setClipping(planes: Plane[]): void;
  /** Tells the size of the canvas in pixels. */
  setSize(width: number, height: number): void;
  /** Puts a label in its place. */
  placeLabel(toScreen: (point: Vector3) => { x: number; y: number }): void;
}
