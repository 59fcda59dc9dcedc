/** Lengths for people: four digits and a unit of their size. */

/** Formats lengths in world units, as `length_text` of the crate impinge-files does. */
export class Lengths {
  constructor(
    readonly unit: string | undefined,
    private readonly meters: number | undefined,
  ) {}

  text(length: number): string {
    if ((this.unit === "m" || this.unit === "cm") && this.meters !== undefined && Math.abs(length) * this.meters < 1) {
      return withUnit(digits(length * this.meters * 1e3), "mm");
    }
    return withUnit(digits(length), this.unit);
  }

  /** Returns an interval as one number if its bounds agree. */
  interval([lower, upper]: readonly [number, number | null]): string {
    if (upper === null) return `at least ${this.text(lower)}`;
    if (upper <= lower * 1.02) return this.text(upper);
    if (lower === 0) return `at most ${this.text(upper)}`;
    return `${this.text(lower)} to ${this.text(upper)}`;
  }

  /** Returns an interval in few letters: its bounds if they agree, or else the one that is proved. */
  brief([lower, upper]: readonly [number, number | null]): string {
    if (upper !== null && upper <= lower * 1.02) return this.text(upper);
    return upper !== null && lower === 0 ? `≤ ${this.text(upper)}` : `≥ ${this.text(lower)}`;
  }

  /** Returns a coordinate to a tenth of a tolerance, without a unit. */
  coordinate(x: number, tolerance: number): string {
    const decimals = Math.min(Math.max(Math.ceil(1 - Math.log10(tolerance || 1e-9)), 0), 12);
    return String(Number(x.toFixed(decimals)));
  }
}

function withUnit(number: string, unit: string | undefined): string {
  return unit === undefined ? number : `${number}\u202f${unit}`;
}

function digits(x: number): string {
  const rounded = Number(x.toPrecision(4));
  const size = Math.abs(rounded);
  return rounded === 0 || (size >= 1e-3 && size < 1e6) ? String(rounded) : x.toExponential(3).replace("e+", "e");
}
