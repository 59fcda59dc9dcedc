/** The material of solid parts: flat facets, lit from the camera alike on both sides. */
import { DoubleSide, MeshBasicMaterial, type MeshBasicMaterialParameters } from "three";

/** Light from all sides, from a lamp above the right shoulder of the viewer, and from above. */
const LIGHT = "0.66 + 0.36 * max(dot(facet, vec3(0.259, 0.431, 0.864)), 0.0) + 0.06 * facet.y";

export class FacetMaterial extends MeshBasicMaterial {
  constructor(parameters: MeshBasicMaterialParameters = {}) {
    super({ side: DoubleSide, ...parameters });
    this.onBeforeCompile = (shader) => {
      shader.vertexShader = shader.vertexShader
        .replace("void main() {", "varying vec3 seen;\nvoid main() {")
        .replace("#include <project_vertex>", "#include <project_vertex>\nseen = mvPosition.xyz;");
      shader.fragmentShader = shader.fragmentShader
        .replace("void main() {", "varying vec3 seen;\nvoid main() {")
        .replace(
          "#include <opaque_fragment>",
          `vec3 facet = normalize(cross(dFdx(seen), dFdy(seen)));
           outgoingLight *= ${LIGHT};
           #include <opaque_fragment>`,
        );
    };
  }
}
