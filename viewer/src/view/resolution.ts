/** The resolution of the view: coarser during motion on slow machines, and always fine at rest. */

/** Time between two pictures of one motion, at most, in milliseconds. */
const SAME_MOTION = 400;

/** Time between two pictures from which motion does not look smooth, in milliseconds. */
const SLOW = 45;

/** Coarsest resolution: pixels that are drawn for each pixel of the page, along one axis. */
const COARSEST = 0.4;

export class Resolution {
  private before = 0;
  private moving: number | undefined;

  /** Returns the resolution for a picture at a time. `finest` is that of the screen. */
  at(now: number, finest: number): number {
    const time = now - this.before;
    this.before = now;
    const isMoving = time < SAME_MOTION;
    if (isMoving && time > SLOW) this.moving = Math.max((this.moving ?? finest) * 0.75, COARSEST);
    return isMoving && this.moving !== undefined ? Math.min(this.moving, finest) : finest;
  }

  /** Time without a picture after which the motion has ended, in milliseconds. */
  readonly rest = SAME_MOTION;
}
