/** The resolution of the view: coarser during motion on slow machines, and always fine at rest. */

/** Time that a picture waits for the one before it, from which motion does not look smooth, in milliseconds. */
const SLOW = 40;

/** Waiting time from which only the coarsest picture can help, in milliseconds. */
const VERY_SLOW = 160;

/** Coarsest resolution: pixels that are drawn for each pixel of the page, along one axis. */
const COARSEST = 0.4;

/** Resolution at rest without a graphics card. Several pixels for each of the page stand for antialiasing. */
const SOFTWARE_FINEST = 2;

/** Returns whether the browser draws without a graphics card. */
export function isSoftware(): boolean {
  return document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true }) === null;
}

export class Resolution {
  /** Time without a picture after which the motion has ended, in milliseconds. */
  readonly rest = 350;
  private moving: number;

  constructor(private readonly isSoftware: boolean) {
    this.moving = isSoftware ? 1 : this.finest;
  }

  /** Resolution at rest. */
  get finest(): number {
    return this.isSoftware ? SOFTWARE_FINEST : Math.min(devicePixelRatio, 2);
  }

  /** Returns the resolution of a picture in motion, which waited some milliseconds for the one before it. */
  inMotion(waited: number): number {
    if (waited > SLOW) this.moving = waited > VERY_SLOW ? COARSEST : Math.max(this.moving * 0.75, COARSEST);
    return Math.min(this.moving, this.finest);
  }

  /** Whether even the coarsest pictures are too slow, so that something has to be left out of them. */
  get isTooSlow(): boolean {
    return this.moving === COARSEST;
  }
}
