/** The scale bar and the axes in the corner of the view. */
import { Vector3, type PerspectiveCamera } from "three";
import type { Lengths } from "../data/length";
import { get } from "../elements";

/** Largest length of the bar in pixels. */
const MAX_LENGTH = 140;

/** Length of an axis in pixels. */
const AXIS_LENGTH = 26;

export class Scale {
  private readonly bar = get("scale-bar");
  private readonly text = get("scale-text");
  private readonly axes = get("axes");

  constructor(private readonly lengths: Lengths) {}

  /** Shows a round length, and the directions of the axes of the world. */
  show(lengthOfPixel: number, camera: PerspectiveCamera): void {
    const most = MAX_LENGTH * lengthOfPixel;
    const power = 10 ** Math.floor(Math.log10(most));
    const length = ([5, 2, 1].find((digit) => digit * power <= most) ?? 1) * power;
    this.bar.style.width = `${length / lengthOfPixel}px`;
    this.text.textContent = this.lengths.text(length);
    (["x", "y", "z"] as const).forEach((axis, at) => {
      const end = new Vector3(Number(at === 0), Number(at === 1), Number(at === 2));
      end.applyQuaternion(camera.quaternion.clone().invert()).multiplyScalar(AXIS_LENGTH);
      const line = this.axes.querySelector(`line[data-axis="${axis}"]`);
      line?.setAttribute("x2", end.x.toFixed(1));
      line?.setAttribute("y2", (-end.y).toFixed(1));
      const text = this.axes.querySelector(`text[data-axis="${axis}"]`);
      text?.setAttribute("x", (1.35 * end.x).toFixed(1));
      text?.setAttribute("y", (-1.35 * end.y).toFixed(1));
    });
  }
}
