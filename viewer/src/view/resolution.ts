/** The resolution of the view: coarser during motion on slow machines, and always fine at rest. */

/** Longest time between two pictures of one motion in milliseconds, with a graphics card and without one. */
const SAME_MOTION = 400;
const SAME_SOFTWARE_MOTION = 1200;

/** Time between two pictures from which motion does not look smooth, in milliseconds. */
const SLOW = 40;

/** Time between two pictures from which only the coarsest can help, in milliseconds. */
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
  readonly rest: number;
  private before = 0;
  private moving: number;
  private isMoving = false;

  constructor(private readonly isSoftware: boolean) {
    this.rest = isSoftware ? SAME_SOFTWARE_MOTION : SAME_MOTION;
    this.moving = isSoftware ? 1 : this.finest;
  }

  /** Resolution at rest. */
  get finest(): number {
    return this.isSoftware ? SOFTWARE_FINEST : Math.min(devicePixelRatio, 2);
  }

  /** Whether even the coarsest picture was too slow for a motion, so that something has to be left out of the next. */
  get isTooSlow(): boolean {
    return this.isMoving && this.moving === COARSEST;
  }

  /** Returns the resolution for a picture at a time. */
  at(now: number): number {
    const time = now - this.before;
    this.before = now;
    this.isMoving = time < this.rest;
    if (!this.isMoving) return this.finest;
    if (time > SLOW) this.moving = time > VERY_SLOW ? COARSEST : Math.max(this.moving * 0.75, COARSEST);
    return Math.min(this.moving, this.finest);
  }
}
