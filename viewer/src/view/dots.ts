/** Round dots with a border, over everything. */
import { Points, PointsMaterial, type BufferGeometry } from "three";
import type { Theme } from "./colors";

/** Sizes of the border and of the dot, in pixels. */
const BORDER = 16;
const DOT = 11;

/** Returns a dot at each point of a geometry. */
export function dots(geometry: BufferGeometry, theme: Theme): Points[] {
  return ([[BORDER, theme.background], [DOT, theme.shared]] as const).map(([size, color]) => {
    const material = new PointsMaterial({ size, color, sizeAttenuation: false, depthTest: false, transparent: true });
    material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <clipping_planes_fragment>",
        "#include <clipping_planes_fragment>\nif (length(gl_PointCoord - 0.5) > 0.5) discard;",
      );
    };
    const point = new Points(geometry, material);
    point.renderOrder = 30;
    return point;
  });
}
