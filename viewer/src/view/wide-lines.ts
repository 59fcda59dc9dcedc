/** Lines that are wider than a pixel, and faint behind a part. */
import { BufferAttribute, BufferGeometry, Color, DoubleSide, InterleavedBuffer, InterleavedBufferAttribute, Mesh, ShaderMaterial, type Vector2 } from "three";

/** Width in pixels. */
const WIDTH = 3;

/** Opacity behind a part. */
const HIDDEN_OPACITY = 0.4;

/** Corners of the quad of a line: along it, and across it. */
const CORNERS = [[-1, -1], [1, -1], [1, 1], [-1, 1]] as const;

/** Numbers of a corner: both ends of the line, and the corner. */
const STRIDE = 8;

/** Moves the corners of a quad to both sides of a line, and beyond its ends by half of its width so that joints have no gaps. */
const VERTEX = `
  attribute vec2 corner;
  attribute vec3 from;
  attribute vec3 to;
  uniform vec2 canvas;
  void main() {
    vec4 start = projectionMatrix * modelViewMatrix * vec4(from, 1.0);
    vec4 end = projectionMatrix * modelViewMatrix * vec4(to, 1.0);
    // Nothing is drawn before the eye, where the direction of the line would turn around.
    float near = 1e-3 * max(abs(start.w), abs(end.w));
    if (start.w < near && end.w > near) start = mix(start, end, (near - start.w) / (end.w - start.w));
    if (end.w < near && start.w > near) end = mix(end, start, (near - end.w) / (start.w - end.w));
    vec2 along = (end.xy / end.w - start.xy / start.w) * canvas;
    along = length(along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    vec4 place = corner.x < 0.0 ? start : end;
    place.xy += ${WIDTH.toFixed(1)} * (corner.x * along + corner.y * across) / canvas * place.w;
    gl_Position = place;
  }`;

const FRAGMENT = `
  uniform vec3 color;
  uniform float opacity;
  void main() {
    gl_FragColor = vec4(color, opacity);
  }`;

export class WideLines extends Mesh<BufferGeometry, ShaderMaterial> {
  /** Tells the size of the canvas in pixels. */
  setSize(size: Vector2): void {
    (this.material.uniforms["canvas"].value as Vector2).copy(size);
  }
}

/** Returns lines between pairs of points, six numbers a line, on a canvas of a size in pixels. */
export function wideLines(ends: number[], color: number, size: Vector2): WideLines[] {
  // Quads, and not instances of one quad: without a graphics card, an instance takes as long as 20 triangles.
  const count = ends.length / 6;
  const quads = new InterleavedBuffer(new Float32Array(count * 4 * STRIDE), STRIDE);
  const index = new Uint32Array(count * 6);
  for (let line = 0; line < count; line++) {
    CORNERS.forEach((corner, at) => {
      const place = (4 * line + at) * STRIDE;
      quads.array.set(ends.slice(6 * line, 6 * line + 6), place);
      quads.array.set(corner, place + 6);
    });
    index.set([0, 1, 2, 0, 2, 3].map((corner) => 4 * line + corner), 6 * line);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("from", new InterleavedBufferAttribute(quads, 3, 0));
  geometry.setAttribute("to", new InterleavedBufferAttribute(quads, 3, 3));
  geometry.setAttribute("corner", new InterleavedBufferAttribute(quads, 2, 6));
  geometry.setIndex(new BufferAttribute(index, 1));
  return [true, false].map((isBehind) => {
    const material = new ShaderMaterial({
      uniforms: { color: { value: new Color(color) }, opacity: { value: isBehind ? HIDDEN_OPACITY : 1 }, canvas: { value: size.clone() } },
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: isBehind,
      depthTest: !isBehind,
      depthWrite: !isBehind,
      side: DoubleSide,
    });
    const lines = new WideLines(geometry, material);
    lines.frustumCulled = false;
    lines.renderOrder = isBehind ? 20 : 2;
    return lines;
  });
}
