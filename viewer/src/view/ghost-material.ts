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
    /** Distance from the eye up to which ghosts fade, because they would hide the rest. */
    closeness: { value: 1 },
  };

  constructor() {
    super({ transparent: true, depthWrite: false, side: DoubleSide, forceSinglePass: true });
    this.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("void main() {", "varying vec3 seen;\nvoid main() {")
        .replace("#include <project_vertex>", "#include <project_vertex>\nseen = mvPosition.xyz;");
      shader.fragmentShader = shader.fragmentShader
        .replace("void main() {", "varying vec3 seen;\nuniform vec3 pivot;\nuniform float reach;\nuniform float far;\nuniform float closeness;\nvoid main() {")
        .replace(
          "#include <opaque_fragment>",
          `vec3 across = cross(dFdx(seen), dFdy(seen));
           float facing = dot(across, seen);
           // The square of the cosine between the surface and the direction of view.
           float rim = 1.0 - sqrt(facing * facing / max(dot(across, across) * dot(seen, seen), 1e-30));
           float beyond = max(distance(seen, pivot) / reach - 1.0, 0.0);
           float fade = mix(far, 1.0, 1.0 / (1.0 + beyond * (1.0 + beyond)));
           // Parts close before the eye hide the rest.
           fade *= clamp(-seen.z / closeness - 0.1, 0.0, 1.0);
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
    this.uniforms.closeness.value = 0.55 * pivot.length() || 1;
  }
}
