/** The area of a section inside each solid, and the area inside both, which shows how they overlap. */
import {
  AlwaysStencilFunc, DoubleSide, EqualStencilFunc, Group, InvertStencilOp, KeepStencilOp, Mesh, MeshBasicMaterial,
  PlaneGeometry, Vector3, type Plane,
} from "three";
import type { Finding } from "../data/model";
import { FIRST, SECOND, type Theme } from "./colors";
import type { Placement } from "./placement";

/**
 * Each solid has a bit of the stencil. A surface behind the plane inverts it, so that it is set where the plane lies
 * inside the solid: a ray from there crosses the surface an odd number of times.
 */
const BITS = [1, 2] as const;

export class SectionCaps {
  readonly group = new Group();

  constructor(private readonly placement: Placement) {}

  /** Draws the areas of the two parts of a finding, if they are closed and not hidden. */
  show(finding: Finding | undefined, hidden: ReadonlySet<number>, plane: Plane | undefined, theme: Theme): void {
    this.clear();
    if (finding === undefined || plane === undefined) return;
    const { parts, meshes } = this.placement.geometry;
    let reach = 0;
    finding.places.slice(0, 2).forEach((place, at) => {
      const part = parts[place];
      const isSolid = part?.mesh !== undefined && meshes[part.mesh].isClosed;
      if (!isSolid || part.box === undefined || hidden.has(place)) return;
      for (const corner of part.box) reach = Math.max(reach, new Vector3(...this.placement.toView(corner)).length());
      this.addSurface(place, BITS[at], plane);
    });
    this.addArea(BITS[0], FIRST, reach, plane);
    this.addArea(BITS[1], SECOND, reach, plane);
    this.addArea(BITS[0] | BITS[1], theme.shared, reach, plane);
  }

  private clear(): void {
    for (const mesh of this.group.children as Mesh<PlaneGeometry, MeshBasicMaterial>[]) {
      mesh.material.dispose();
      if (mesh.geometry instanceof PlaneGeometry) mesh.geometry.dispose();
    }
    this.group.clear();
  }

  private addSurface(place: number, bit: number, plane: Plane): void {
    const part = this.placement.geometry.parts[place];
    const material = new MeshBasicMaterial({
      colorWrite: false,
      depthWrite: false,
      depthTest: false,
      side: DoubleSide,
      clippingPlanes: [plane],
      stencilWrite: true,
      stencilWriteMask: bit,
      stencilFunc: AlwaysStencilFunc,
      stencilZPass: InvertStencilOp,
    });
    const mesh = new Mesh(this.placement.triangles(this.placement.shapeOf(part)), material);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(this.placement.matrix(part));
    mesh.renderOrder = 3;
    mesh.frustumCulled = false;
    this.group.add(mesh);
  }

  private addArea(bits: number, color: number, reach: number, plane: Plane): void {
    if (reach === 0) return;
    const material = new MeshBasicMaterial({
      color,
      side: DoubleSide,
      stencilWrite: true,
      stencilWriteMask: 0,
      stencilRef: bits,
      stencilFuncMask: BITS[0] | BITS[1],
      stencilFunc: EqualStencilFunc,
      stencilZPass: KeepStencilOp,
      polygonOffset: true,
      polygonOffsetFactor: -1,
      polygonOffsetUnits: -1,
    });
    const side = 4 * reach;
    const area = new Mesh(new PlaneGeometry(side, side), material);
    area.position.copy(plane.coplanarPoint(new Vector3()));
    area.lookAt(area.position.clone().add(plane.normal));
    area.renderOrder = 4;
    this.group.add(area);
  }
}
