/** The material of parts around the selected ones: faint, clearer at silhouettes, fading with the distance. */
import { Color, DoubleSide, MeshBasicMaterial, Vector3 } from "three";

export class GhostMaterial extends MeshBasicMaterial {
  private readonly uniforms = {
    /** The selected place, in the frame of the camera. */
    pivot: { value: new Vector3() },
    /** Distance from it at which ghosts begin to fade. */
    reach: { value: 1 },
    /** Opacity of parts far from it, relative to that of near parts. */
    far: { value: 0.35 },
  };

  constructor() {
    super({ transparent: true, depthWrite: false, side: DoubleSide, forceSinglePass: true });
    this.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("void main() {", "varying vec3 seen;\nvoid main() {")
        .replace("#include <project_vertex>", "#include <project_vertex>\nseen = mvPosition.xyz;");
      shader.fragmentShader = shader.fragmentShader
        .replace("void main() {", "varying vec3 seen;\nuniform vec3 pivot;\nuniform float reach;\nuniform float far;\nvoid main() {")
        .replace(
          "#include <opaque_fragment>",
          `vec3 across = normalize(cross(dFdx(seen), dFdy(seen)));
           float rim = 1.0 - abs(dot(across, normalize(seen)));
           float fade = mix(far, 1.0, exp(-max(distance(seen, pivot) / reach - 1.0, 0.0)));
           // Parts close before the eye hide the rest.
           fade *= smoothstep(0.05, 0.6, length(seen) / max(length(pivot), 1e-12));
           diffuseColor.a *= fade * (0.18 + 0.82 * rim * rim * rim);
           #include <opaque_fragment>`,
        );
    };
  }

  setLook(color: number, opacity: number): void {
    this.color = new Color(color);
    this.opacity = opacity;
  }

  /** Sets the place around which ghosts are clear, in the frame of the camera. */
  setPivot(pivot: Vector3, reach: number): void {
    this.uniforms.pivot.value.copy(pivot);
    this.uniforms.reach.value = reach;
  }
}
