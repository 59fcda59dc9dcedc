/** Draws pictures of findings for files, beside the view and without changing it. */
import { Color, LinearSRGBColorSpace, Scene, Vector3, WebGLRenderer } from "three";
import type { Shot } from "../bcf/viewpoint";
import { middle } from "../data/boxes";
import type { Finding, Model } from "../data/model";
import { make } from "../elements";
import { clearestDirection } from "./clearest-direction";
import { LIGHT } from "./colors";
import { Context } from "./context";
import { Focus } from "./focus";
import { Framing } from "./framing";
import { placeOf } from "./markers";
import { Orbit } from "./orbit";
import { Picker } from "./picker";
import { Placement } from "./placement";

/** Ratio of what a picture shows to what the page shows of a finding: a picture cannot be zoomed out. */
const AROUND = 1.4;

export class Snapshots {
  private readonly canvas = make("canvas");
  private readonly renderer = new WebGLRenderer({ canvas: this.canvas, antialias: true });
  private readonly scene = new Scene();
  private readonly framing: Framing;
  private readonly placement: Placement;
  private readonly picker: Picker;
  private readonly orbit: Orbit;
  private readonly context: Context;
  private readonly focus: Focus;

  /** `size` is the width and the height in pixels, and the field of view is vertical and in degrees. */
  constructor(model: Model, [width, height]: readonly [number, number], fieldOfView: number) {
    this.renderer.outputColorSpace = LinearSRGBColorSpace; // colors are drawn as they are
    this.renderer.setSize(width, height, false);
    this.framing = new Framing(model);
    this.placement = new Placement(model.geometry);
    this.picker = new Picker(this.placement);
    this.orbit = new Orbit(this.canvas, model.up, () => undefined, fieldOfView);
    this.orbit.camera.aspect = width / height;
    this.context = new Context(this.placement);
    this.context.setTheme(LIGHT);
    this.focus = new Focus(this.placement);
    this.focus.setSize(width, height);
    this.scene.background = new Color(LIGHT.background);
    this.scene.add(this.context.mesh, this.focus.group);
  }

  /** Returns what the camera sees of a finding, or nothing of unbounded parts. */
  async shoot(finding: Finding, hasPicture: boolean): Promise<Shot | undefined> {
    const place = placeOf(finding);
    if (place === undefined || finding.places.some((part) => this.placement.geometry.parts[part]?.box === undefined)) return undefined;
    this.placement.origin = place;
    const target = new Vector3(...this.placement.toView(middle(this.framing.boxOf(finding, false))));
    const reach = this.framing.reachOf(finding);
    const toCamera = clearestDirection(finding, target, this.orbit, this.placement, this.picker);
    this.orbit.stance = { target, distance: this.orbit.distanceFor(AROUND * reach), ...this.orbit.angles(toCamera) };
    this.orbit.sceneReach = Math.max(...this.framing.whole.map((corner) => new Vector3(...this.placement.toView(corner)).length()));
    this.orbit.update(0);
    const { camera } = this.orbit;
    const [away, up] = [[0, 0, -1], [0, 1, 0]].map(([x, y, z]) => new Vector3(x, y, z).applyQuaternion(camera.quaternion).toArray());
    const shot = { eye: this.placement.toWorld(camera.position), away, up };
    if (!hasPicture) return shot;
    const selected = new Set(finding.places);
    this.context.place();
    this.context.show((part) => !selected.has(part));
    this.context.setPivot(target.clone().applyMatrix4(camera.matrixWorldInverse), 2 * reach);
    this.focus.show(finding, new Set(), LIGHT);
    this.renderer.render(this.scene, camera);
    const picture = await new Promise<Blob | null>((done) => this.canvas.toBlob(done, "image/png"));
    return picture === null ? shot : { ...shot, picture: new Uint8Array(await picture.arrayBuffer()) };
  }

  /** Gives back the memory of the graphics card. */
  dispose(): void {
    this.context.mesh.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
