/** A list of any length, of which only the lines in sight are in the document. */

/** Height of a line in pixels, as in the style sheet. */
const LINE_HEIGHT = 46;

/** Number of lines beyond each edge of the window, so that fast scrolling shows no gaps. */
const MARGIN = 8;

/** Tallest element in pixels that all browsers lay out. Longer lists scroll in proportion. */
const MAX_HEIGHT = 8_000_000;

export class VirtualList {
  private readonly spacer = document.createElement("div");
  private count = 0;
  private readonly shown = new Map<number, HTMLElement>();

  constructor(
    private readonly frame: HTMLElement,
    private readonly render: (index: number) => HTMLElement,
  ) {
    this.spacer.className = "spacer";
    this.spacer.setAttribute("role", "presentation");
    frame.append(this.spacer);
    frame.addEventListener("scroll", () => this.draw(), { passive: true });
    new ResizeObserver(() => this.draw()).observe(frame);
  }

  /** Shows another number of lines, all of them new. */
  reset(count: number): void {
    this.count = count;
    this.spacer.style.height = `${Math.min(count * LINE_HEIGHT, MAX_HEIGHT)}px`;
    this.redraw();
  }

  /** Renders the lines in sight again. */
  redraw(): void {
    for (const line of this.shown.values()) line.remove();
    this.shown.clear();
    this.draw();
  }

  /** Scrolls as little as necessary to bring a line into sight. */
  reveal(index: number): void {
    const { clientHeight } = this.frame;
    const top = this.topOf(index) + this.frame.scrollTop;
    if (top < this.frame.scrollTop) this.frame.scrollTop = top - LINE_HEIGHT;
    else if (top + LINE_HEIGHT > this.frame.scrollTop + clientHeight) {
      this.frame.scrollTop = top + 2 * LINE_HEIGHT - clientHeight;
    }
    this.draw();
  }

  /** Number of pixels that the list is scrolled, as if no height were too large. */
  private get scrolled(): number {
    const full = this.count * LINE_HEIGHT;
    const room = this.frame.clientHeight;
    if (full <= MAX_HEIGHT) return this.frame.scrollTop;
    return (this.frame.scrollTop / (MAX_HEIGHT - room)) * (full - room);
  }

  /** Returns the top of a line, relative to the top of the window. */
  private topOf(index: number): number {
    return index * LINE_HEIGHT - this.scrolled;
  }

  private draw(): void {
    const first = Math.max(0, Math.floor(this.scrolled / LINE_HEIGHT) - MARGIN);
    const end = Math.min(this.count, Math.ceil((this.scrolled + this.frame.clientHeight) / LINE_HEIGHT) + MARGIN);
    for (const [index, line] of this.shown) {
      if (index < first || index >= end) {
        line.remove();
        this.shown.delete(index);
      }
    }
    for (let index = first; index < end; index++) {
      let line = this.shown.get(index);
      if (line === undefined) {
        line = this.render(index);
        this.shown.set(index, line);
        this.spacer.append(line);
      }
      line.style.transform = `translateY(${this.topOf(index) + this.frame.scrollTop}px)`;
    }
  }
}
