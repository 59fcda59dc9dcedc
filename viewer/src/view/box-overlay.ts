/** The edges of the boxes of one level of a hierarchy. */
import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, type Plane } from "three";
import type { Theme } from "./colors";
import type { Overlay } from "./overlay";
import type { Placement } from "./placement";

/** The two corners of each edge of a box. Bit k of a corner says whether it is at the upper end of axis k. */
const EDGES = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((corner) => [1, 2, 4].filter((bit) => (corner & bit) === 0).map((bit) => [corner, corner | bit] as const));

export class BoxOverlay implements Overlay {
  readonly group: LineSegments<BufferGeometry, LineBasicMaterial>;

  /** Boxes are six numbers each: the lower and the upper corner. */
  constructor(
    private readonly placement: Placement,
    private boxes: Float64Array,
  ) {
    this.group = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.group.frustumCulled = false;
  }

  setBoxes(boxes: Float64Array): void {
    this.boxes = boxes;
  }

  show(theme: Theme): void {
    const { boxes, placement } = this;
    const { origin } = placement;
    const positions = new Float32Array((boxes.length / 6) * EDGES.length * 6);
    let next = 0;
    for (let box = 0; box < boxes.length; box += 6) {
      for (const edge of EDGES) {
        for (const corner of edge) {
          for (let axis = 0; axis < 3; axis++) positions[next++] = boxes[box + axis + ((corner >> axis) & 1) * 3] - origin[axis];
        }
      }
    }
    this.group.geometry.dispose();
    this.group.geometry = new BufferGeometry();
    this.group.geometry.setAttribute("position", new BufferAttribute(positions, 3));
    this.group.material.color.setHex(theme.box);
  }

  setClipping(planes: Plane[]): void {
    this.group.material.clippingPlanes = planes;
  }

  setSize(): void {
    // The lines are one pixel wide.
  }

  placeLabel(): void {
    // The boxes have no label.
  }
}
