/** The view in three dimensions: the model, the selected finding, and what the person does with them. */
import { Color, LinearSRGBColorSpace, Raycaster, Scene, Vector2, Vector3, WebGLRenderer, type Ray } from "three";
import { diagonal, middle } from "../data/boxes";
import type { Lengths } from "../data/length";
import type { Finding } from "../data/model";
import { get } from "../elements";
import type { SectionAxis, State, Store } from "../state";
import { DARK, LIGHT, type Theme } from "./colors";
import { Context } from "./context";
import { Focus } from "./focus";
import { Framing } from "./framing";
import { Markers, placeOf } from "./markers";
import { Measure, snap } from "./measure";
import { Orbit } from "./orbit";
import type { Overlay } from "./overlay";
import { Picker, type Hit } from "./picker";
import { Placement } from "./placement";
import { Section } from "./section";
import { SectionCaps } from "./section-caps";
import { isSoftware, Resolution } from "./resolution";
import { Scale } from "./scale";
import { clearestDirection } from "./clearest-direction";

/** Distance from the origin, relative to what the camera shows, beyond which single precision is not enough. */
const MAX_OFFSET = 200;

/** Distance in pixels that a pointer may move during a click. */
const CLICK_REACH = 4;

/** What `fit` shows: the clash, both parts, or everything. */
const FITS = ["clash", "parts", "model"] as const;

export class SceneView {
  private readonly canvas = get<HTMLCanvasElement>("canvas");
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly placement: Placement;
  private readonly picker: Picker;
  private readonly orbit: Orbit;
  private readonly context: Context;
  private readonly focus: Focus;
  private readonly caps: SectionCaps;
  private readonly markers: Markers;
  private readonly overlay: Overlay | undefined;
  private readonly measure: Measure;
  private readonly section = new Section();
  private readonly scale: Scale;
  private readonly resolution: Resolution;
  /** Timer of the fine picture after a motion. */
  private rest: number | undefined;
  private readonly framing: Framing;
  private theme: Theme = LIGHT;
  private fitted = 0;
  private isDirty = false;
  /** Whether only few parts are drawn around the selected ones. */
  private isThinned = false;
  private pressed: { x: number; y: number } | undefined;

  /** `makeOverlay` returns what a page draws beside parts and findings. */
  constructor(
    private readonly store: Store,
    lengths: Lengths,
    makeOverlay?: (placement: Placement) => Overlay,
    /** Whether the camera flies to each finding that is selected. */
    private readonly followsSelection = true,
  ) {
    const isSlow = isSoftware();
    this.resolution = new Resolution(isSlow);
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: !isSlow, stencil: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.outputColorSpace = LinearSRGBColorSpace; // colors are drawn as they are
    this.placement = new Placement(store.model.geometry);
    this.framing = new Framing(store.model);
    this.placement.origin = middle(this.framing.whole);
    this.picker = new Picker(this.placement);
    this.orbit = new Orbit(this.canvas, store.model.up, () => this.redraw());
    this.context = new Context(this.placement);
    this.focus = new Focus(this.placement);
    this.caps = new SectionCaps(this.placement);
    this.markers = new Markers(this.placement);
    this.overlay = makeOverlay?.(this.placement);
    this.measure = new Measure(lengths);
    this.scale = new Scale(lengths);
    this.scene.add(this.context.mesh, this.focus.group, this.caps.group, this.markers.points, this.measure.group);
    if (this.overlay !== undefined) this.scene.add(this.overlay.group);
    this.canvas.addEventListener("pointerdown", ({ clientX, clientY }) => (this.pressed = { x: clientX, y: clientY }));
    this.canvas.addEventListener("pointerup", (event) => this.release(event));
    this.canvas.addEventListener("pointermove", (event) => this.hover(event));
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    store.listen((state, changed) => this.follow(state, changed));
    this.resize();
    this.restage();
    this.fit("model");
  }

  /** Changes to the colors of the page. */
  setTheme(isDark: boolean): void {
    this.theme = isDark ? DARK : LIGHT;
    this.scene.background = new Color(this.theme.background);
    this.context.setTheme(this.theme);
    this.markers.setTheme(this.theme);
    this.restage();
  }

  /** Shows the clash; if it is in view already, both parts, and then the whole model. */
  fitNext(): void {
    const { selected } = this.store.now;
    this.fitted = selected === undefined ? 2 : (this.fitted + 1) % FITS.length;
    this.fit(FITS[this.fitted]);
  }

  /** Turns the section to the next axis. */
  nextAxis(): void {
    const axes: SectionAxis[] = ["x", "y", "z", "view"];
    const at = axes.indexOf(this.store.now.section ?? "view");
    this.store.set({ section: axes[(at + 1) % axes.length] });
  }

  /** Draws everything again, after parts or the overlay changed. */
  changed(): void {
    this.context.place();
    this.restage();
  }

  /** Moves the section plane: `share` is a share of the reach of the clash, from -1 to 1. */
  moveSection(share: number): void {
    this.section.offset = share;
    this.placeSection();
    this.redraw();
  }

  /** Returns the direction from the target to the camera. */
  get toCamera(): Vector3 {
    return this.orbit.direction();
  }

  /** Whether the last picture is the fine one, for tests. */
  get isAtRest(): boolean {
    return !this.isDirty && this.rest === undefined;
  }

  /** Draws as many pictures as fit into a time in milliseconds, and returns their number, for tests. */
  benchmark(milliseconds: number): number {
    const pixel = new Uint8Array(4);
    const gl = this.renderer.getContext();
    const start = performance.now();
    let [before, waited] = [start, 0];
    let pictures = 0;
    for (; performance.now() - start < milliseconds; before = performance.now()) {
      this.orbit.stance.yaw += 0.02;
      this.draw(performance.now(), this.resolution.inMotion(waited));
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits for the picture
      waited = performance.now() - before;
      pictures++;
    }
    return pictures;
  }

  private follow(state: Readonly<State>, changed: ReadonlySet<keyof State>): void {
    if (changed.has("selected")) {
      this.section.offset = 0;
      if (this.followsSelection) {
        this.moveOrigin(state.selected);
        this.fitted = 0;
        this.fit(state.selected === undefined ? "model" : "clash");
      }
    }
    if (changed.has("section") && state.section !== undefined) this.section.turn(state.section, this.toCamera);
    if (changed.has("isMeasuring") && !state.isMeasuring) this.measure.clear();
    this.restage();
  }

  /** Draws everything as the state says. */
  private restage(): void {
    const { selected, hidden, surroundings, kept, picked } = this.store.now;
    this.focus.show(selected, hidden, this.theme);
    this.context.setSolid(surroundings === "solid");
    this.context.mark(picked);
    this.showContext();
    this.markers.points.visible = selected === undefined;
    if (selected === undefined) this.markers.show(kept);
    this.overlay?.show(this.theme, hidden);
    this.placeSection();
    this.redraw();
  }

  /** Shows the parts around the selected ones: few of them while a slow machine moves. */
  private showContext(): void {
    const { selected, hidden } = this.store.now;
    const isSelected = new Set(selected?.places);
    const kept = this.isThinned ? this.context.mostVisible(this.pivot(), this.framing.reachOf(selected)) : undefined;
    this.context.show((place) => !isSelected.has(place) && !hidden.has(place) && (kept?.has(place) ?? true));
  }

  /** Returns the place that matters in the view. */
  private pivot(): Vector3 {
    const { selected } = this.store.now;
    return selected === undefined ? this.orbit.stance.target.clone() : new Vector3(...this.placement.toView(placeOf(selected) ?? [0, 0, 0]));
  }

  private placeSection(): void {
    const { section, selected, hidden } = this.store.now;
    const isCut = section !== undefined;
    const target = selected === undefined ? undefined : placeOf(selected);
    const at = target === undefined ? new Vector3() : new Vector3(...this.placement.toView(target));
    this.section.moveTo(at, this.framing.reachOf(selected));
    const planes = isCut ? [this.section.plane] : [];
    this.context.setClipping(planes);
    this.focus.setClipping(planes);
    this.overlay?.setClipping(planes);
    this.caps.show(selected, hidden, isCut ? this.section.plane : undefined, this.theme);
  }

  private fit(what: (typeof FITS)[number]): void {
    const { selected } = this.store.now;
    const box = what === "model" || selected === undefined ? this.framing.whole : this.framing.boxOf(selected, what === "parts");
    const target = new Vector3(...this.placement.toView(middle(box)));
    const radius = Math.max(diagonal(box) / 2, 1e-9);
    const isClash = what === "clash" && selected !== undefined;
    const reach = isClash ? this.framing.reachOf(selected) : radius;
    const toCamera = isClash ? clearestDirection(selected, target, this.orbit, this.placement, this.picker) : this.toCamera;
    this.orbit.fly({ target, distance: this.orbit.distanceFor(reach), ...this.orbit.angles(toCamera) });
  }

  /** Moves the origin of the view to a finding, if it is too far for single precision. */
  private moveOrigin(finding: Finding | undefined): void {
    const place = finding === undefined ? middle(this.framing.whole) : placeOf(finding);
    if (place === undefined) return;
    const by = new Vector3(...this.placement.toView(place)).negate();
    if (by.length() < MAX_OFFSET * this.framing.reachOf(finding)) return;
    this.placement.origin = place;
    this.context.place();
    this.orbit.shift(by);
    this.measure.shift(by);
  }

  private release(event: PointerEvent): void {
    const before = this.pressed;
    this.pressed = undefined;
    if (before === undefined || event.button !== 0) return;
    if (Math.hypot(event.clientX - before.x, event.clientY - before.y) > CLICK_REACH) return;
    const { selected, isMeasuring, picked, kept } = this.store.now;
    if (selected === undefined && !isMeasuring) {
      const { x, y } = this.within(event);
      const finding = this.markers.at(x, y, this.toScreen);
      if (finding !== undefined && kept.includes(finding)) return this.store.select(finding);
    }
    const hit = this.hit(event);
    if (isMeasuring) {
      if (hit !== undefined) this.measure.add(snap(hit, this.orbit.camera, this.canvas.clientHeight).point, this.theme);
      this.redraw();
    } else {
      this.store.set({ picked: hit?.place === picked ? undefined : hit?.place });
    }
  }

  /** Shows where a point of a measurement would be. */
  private hover(event: PointerEvent): void {
    const mark = get("snap-mark");
    mark.hidden = true;
    if (!this.store.now.isMeasuring || event.buttons !== 0) return;
    const hit = this.hit(event);
    if (hit === undefined) return;
    const { point, to } = snap(hit, this.orbit.camera, this.canvas.clientHeight);
    const { x, y } = this.toScreen(point);
    mark.hidden = false;
    mark.className = to;
    mark.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
  }

  private hit(event: PointerEvent): Hit | undefined {
    const { selected, hidden, surroundings, section } = this.store.now;
    const plane = section === undefined ? undefined : this.section.plane;
    const ray = this.rayAt(event);
    const isSelected = new Set(selected?.places);
    // Ghosts are behind the selected parts for a click.
    const own = this.picker.pick(ray, (place) => isSelected.has(place) && !hidden.has(place), plane);
    const isGhost = selected !== undefined && surroundings === "ghost";
    if (own !== undefined && isGhost) return own;
    const all = (place: number) => !hidden.has(place) && (surroundings !== "none" || isSelected.has(place));
    return this.picker.pick(ray, all, plane);
  }

  private rayAt(event: PointerEvent): Ray {
    const { x, y } = this.within(event);
    const caster = new Raycaster();
    const place = new Vector2((x / this.canvas.clientWidth) * 2 - 1, 1 - (y / this.canvas.clientHeight) * 2);
    caster.setFromCamera(place, this.orbit.camera);
    return caster.ray;
  }

  private within(event: PointerEvent): { x: number; y: number } {
    const frame = this.canvas.getBoundingClientRect();
    return { x: event.clientX - frame.left, y: event.clientY - frame.top };
  }

  private readonly toScreen = (point: Vector3): { x: number; y: number } => {
    const { x, y } = point.clone().project(this.orbit.camera);
    return { x: ((x + 1) / 2) * this.canvas.clientWidth, y: ((1 - y) / 2) * this.canvas.clientHeight };
  };

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.orbit.camera.aspect = width / height;
    this.focus.setSize(width, height);
    this.overlay?.setSize(width, height);
    this.redraw();
  }

  /** Draws with the next picture of the browser. */
  private redraw(): void {
    if (this.isDirty) return;
    this.isDirty = true;
    const asked = performance.now();
    requestAnimationFrame((now) => {
      this.isDirty = false;
      clearTimeout(this.rest);
      this.rest = undefined;
      const ratio = this.resolution.inMotion(performance.now() - asked);
      const isMoving = this.draw(now, ratio);
      if (isMoving) this.redraw();
      else if (ratio < this.resolution.finest) {
        this.rest = setTimeout(() => {
          this.rest = undefined;
          this.draw(performance.now(), this.resolution.finest);
        }, this.resolution.rest);
      }
    });
  }

  /** Draws now, and returns whether the camera still flies. */
  private draw(now: number, ratio: number): boolean {
    const { selected } = this.store.now;
    this.orbit.sceneReach = this.reachFromOrigin();
    const isFlying = this.orbit.update(now);
    const { camera } = this.orbit;
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    const reach = selected === undefined ? 1e30 : 2 * this.framing.reachOf(selected);
    this.context.setPivot(this.pivot().applyMatrix4(camera.matrixWorldInverse), reach);
    const isThinned = this.resolution.isTooSlow && ratio < this.resolution.finest;
    if (isThinned !== this.isThinned) {
      this.isThinned = isThinned;
      this.showContext();
    }
    this.context.mesh.visible = selected === undefined || this.store.now.surroundings !== "none";
    this.renderer.render(this.scene, camera);
    this.measure.placeLabel(this.toScreen);
    this.overlay?.placeLabel(this.toScreen);
    this.scale.show(this.orbit.lengthOfPixel(), camera);
    return isFlying;
  }

  private reachFromOrigin(): number {
    return Math.max(...this.framing.whole.map((corner) => new Vector3(...this.placement.toView(corner)).length()));
  }
}
