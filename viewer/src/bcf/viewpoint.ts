/** The viewpoint of a topic: the camera, and both parts selected and colored. */
import type { Vector } from "../data/geometry";
import type { ClashModel } from "../data/model";
import type { Bcf, Part, Topic } from "../data/report";
import { documentOf, element, field } from "./xml";

/** What a camera sees of a finding, in the coordinates of the report. */
export interface Shot {
  readonly eye: Vector;
  /** Unit vectors away from the viewer and up. */
  readonly away: Vector;
  readonly up: Vector;
  /** A picture as a PNG file. */
  readonly picture?: Uint8Array;
}

export function viewpointOf(topic: Topic, shot: Shot, model: ClashModel, bcf: Bcf): Uint8Array {
  const { facts, report, findings } = model;
  const parts = findings[topic.findings[0]].parts.slice(0, 2);
  const hidden = { SpacesVisible: "false", SpaceBoundariesVisible: "false", OpeningsVisible: "false" };
  const turned = (direction: Vector) => zUp(direction, facts.up);
  const origin = report.scenes.find((scene) => scene.origin !== undefined)?.origin ?? [0, 0, 0];
  const eye = turned(shot.eye).map((x, axis) => (x + turned(origin)[axis]) * (facts.meters ?? 1));
  const components = element(
    "Components",
    {},
    element("ViewSetupHints", hidden),
    element("Selection", {}, ...parts.map(component)),
    element("Visibility", { DefaultVisibility: "true" }),
    element("Coloring", {}, ...parts.map((part, at) => element("Color", { Color: bcf.colors[at] }, component(part)))),
  );
  const camera = element(
    "PerspectiveCamera",
    {},
    vector("CameraViewPoint", eye),
    vector("CameraDirection", turned(shot.away)),
    vector("CameraUpVector", turned(shot.up)),
    field("FieldOfView", String(bcf.field_of_view)),
  );
  return documentOf(element("VisualizationInfo", { Guid: topic.guids[2] }, components, camera));
}

/** Returns a part, with its key as IFC GlobalId if it is one. */
function component({ scene, key }: Part): string {
  const attributes: Record<string, string> = /^[0-9A-Za-z_$]{22}$/.test(key) ? { IfcGuid: key } : {};
  return element("Component", attributes, field("AuthoringToolId", `${scene}/${key}`));
}

/** Returns a vector in axes whose z points up, as BCF has them. */
function zUp([x, y, z]: Vector, up: "x" | "y" | "z"): Vector {
  return { x: [y, z, x], y: [x, -z, y], z: [x, y, z] }[up] as unknown as Vector;
}

function vector(name: string, values: readonly number[]): string {
  return element(name, {}, ...["X", "Y", "Z"].map((axis, at) => field(axis, String(values[at] + 0)))); // without a negative zero
}
