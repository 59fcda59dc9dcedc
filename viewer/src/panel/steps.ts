/** The slider below the view: levels of a hierarchy, or steps of a robot. */
import { get } from "../elements";

export interface Step {
  readonly name: string;
  /** Class of the step on the track, if it has one. */
  readonly look?: string;
}

export class Steps {
  private readonly slider = get<HTMLInputElement>("step");

  /** Shows the slider, and calls `show` now and after each change. */
  constructor(
    name: string,
    private readonly steps: readonly Step[],
    start: number,
    private readonly show: (at: number) => void,
  ) {
    get("step-tools").hidden = false;
    get("step-name").textContent = name;
    this.slider.max = String(steps.length - 1);
    this.slider.disabled = steps.length < 2;
    this.slider.addEventListener("input", () => this.update());
    this.slider.style.setProperty("--track", track(steps));
    this.slider.value = String(start);
    this.update();
  }

  /** Moves by some steps. */
  move(by: number): void {
    this.slider.value = String(Number(this.slider.value) + by); // the slider keeps it within its range
    this.update();
  }

  private update(): void {
    const at = Number(this.slider.value);
    const { name } = this.steps[at];
    get("step-text").textContent = name;
    this.slider.setAttribute("aria-valuetext", name);
    this.show(at);
  }
}

/** Returns the colors of the track: a piece from half a step before each step to half a step after it. */
function track(steps: readonly Step[]): string {
  const share = (at: number) => `${((100 * at) / Math.max(steps.length - 1, 1)).toFixed(2)}%`;
  const runs: string[] = [];
  for (let first = 0; first < steps.length; ) {
    let last = first;
    while (steps[last + 1]?.look === steps[first].look && last + 1 < steps.length) last++;
    runs.push(`var(--${steps[first].look ?? "line"}) ${share(Math.max(first - 0.5, 0))} ${share(last + 0.5)}`);
    first = last + 1;
  }
  return `linear-gradient(to right, ${runs.join(", ")})`;
}
