/** Two meshes: their intersecting faces, or the line between their nearest points. */
import { BufferAttribute, BufferGeometry, Group, Mesh, Points, Vector2, Vector3, type Material, type Plane } from "three";
import type { PlacedPart, Vector } from "../data/geometry";
import { get } from "../elements";
import type { Theme } from "./colors";
import { dots } from "./dots";
import { FacetMaterial } from "./facet-material";
import type { Overlay } from "./overlay";
import type { Placement } from "./placement";
import { WideLines, wideLines } from "./wide-lines";

export class PairOverlay implements Overlay {
  readonly group = new Group();
  private readonly label = get("gap-label");
  private readonly size = new Vector2(1, 1);
  private middle = new Vector3();
  private planes: Plane[] = [];

  /** `faces` are the intersecting faces of both meshes, and `gap` the text of the distance. */
  constructor(
    private readonly placement: Placement,
    private readonly faces: readonly PlacedPart[],
    private readonly nearest: readonly [Vector, Vector] | undefined,
    gap: string,
  ) {
    this.label.textContent = gap;
    this.label.hidden = nearest === undefined;
  }

  show(theme: Theme, hidden: ReadonlySet<number>): void {
    this.clear();
    this.faces.forEach((part, side) => {
      if (part.mesh === undefined || hidden.has(side)) return;
      const material = new FacetMaterial({ color: theme.hit });
      const mesh = new Mesh(this.placement.triangles(part.mesh), material);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(this.placement.matrix(part));
      this.group.add(mesh);
    });
    if (this.nearest !== undefined) {
      const ends = this.nearest.map((point) => new Vector3(...this.placement.toView(point)));
      this.middle = ends[0].clone().lerp(ends[1], 0.5);
      const positions = Float32Array.from(ends.flatMap((end) => end.toArray()));
      const points = new BufferGeometry();
      points.setAttribute("position", new BufferAttribute(positions, 3));
      this.group.add(...wideLines([...positions], theme.shared, this.size), ...dots(points, theme));
    }
    this.setClipping(this.planes);
  }

  setClipping(planes: Plane[]): void {
    this.planes = planes;
    for (const object of this.group.children) if (object instanceof Mesh && !(object instanceof WideLines)) object.material.clippingPlanes = planes;
  }

  setSize(width: number, height: number): void {
    this.size.set(width, height);
    for (const object of this.group.children) if (object instanceof WideLines) object.setSize(this.size);
  }

  placeLabel(toScreen: (point: Vector3) => { x: number; y: number }): void {
    if (this.label.hidden) return;
    const { x, y } = toScreen(this.middle);
    this.label.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px) translate(-50%, -160%)`;
  }

  private clear(): void {
    for (const object of this.group.children) {
      const { geometry, material } = object as Mesh<BufferGeometry, Material>;
      // The triangles belong to the placement, and are used again.
      if (object instanceof WideLines || object instanceof Points) geometry.dispose();
      material.dispose();
    }
    this.group.clear();
  }
}
