/**
 * A BCF file of version 2.1 with the statuses of the page. Topics, identities and texts are those of `impinge clash --bcf`,
 * which `crates/impinge-report/src/bcf` writes.
 */
import { zipSync, type Zippable } from "fflate";
import type { ClashModel } from "../data/model";
import type { Bcf, Topic } from "../data/report";
import { descriptionOf, statusOf } from "./topic";
import { viewpointOf, type Shot } from "./viewpoint";
import { documentOf, element, field } from "./xml";

const VERSION = "2.1";

/** Names of the files of a viewpoint. Some programs accept no others. */
const [VIEWPOINT, SNAPSHOT] = ["viewpoint.bcfv", "snapshot.png"];

/** Returns the file. `shots` has what a camera sees of each topic; of unbounded parts it sees nothing. */
export function bcfFile(model: ClashModel, bcf: Bcf, shots: readonly (Shot | undefined)[], now: Date): Uint8Array<ArrayBuffer> {
  const [id, name] = bcf.project;
  const project = element("Project", { ProjectId: id }, field("Name", name));
  const files: Zippable = {
    "bcf.version": documentOf(element("Version", { VersionId: VERSION }, field("DetailedVersion", VERSION))),
    "project.bcfp": documentOf(element("ProjectExtension", {}, project, field("ExtensionSchema", ""))),
  };
  const date = `${now.toISOString().slice(0, 19)}Z`;
  bcf.topics.forEach((topic, at) => {
    const shot = shots[at];
    const folder = topic.guids[0];
    files[`${folder}/markup.bcf`] = markupOf(topic, shot, model, bcf, date);
    if (shot === undefined) return;
    files[`${folder}/${VIEWPOINT}`] = viewpointOf(topic, shot, model, bcf);
    if (shot.picture !== undefined) files[`${folder}/${SNAPSHOT}`] = [shot.picture, { level: 0 }]; // it is packed already
  });
  return zipSync(files, { mtime: now });
}

function markupOf(topic: Topic, shot: Shot | undefined, model: ClashModel, { author }: Bcf, date: string): Uint8Array {
  const [guid, comment, viewpoint] = topic.guids;
  const names = model.report.scenes.flatMap(({ file }) => file?.split(/[/\\]/).at(-1) ?? []);
  const files = names.map((name) => element("File", { isExternal: "true" }, field("Filename", name)));
  const fields = element(
    "Topic",
    { Guid: guid, TopicType: topic.kind, TopicStatus: statusOf(topic, model) },
    field("Title", topic.title),
    field("Priority", topic.priority),
    ...(topic.labels ?? []).map((label) => field("Labels", label)),
    field("CreationDate", date),
    field("CreationAuthor", author),
    field("Description", descriptionOf(topic, model)),
  );
  const shown = [
    element(
      "Comment",
      { Guid: comment },
      field("Date", date),
      field("Author", author),
      field("Comment", `The viewpoint shows it: ${topic.title}.`),
      element("Viewpoint", { Guid: viewpoint }),
    ),
    element(
      "Viewpoints",
      { Guid: viewpoint },
      field("Viewpoint", VIEWPOINT),
      ...(shot?.picture === undefined ? [] : [field("Snapshot", SNAPSHOT)]),
    ),
  ];
  const header = files.length === 0 ? [] : [element("Header", {}, ...files)];
  return documentOf(element("Markup", {}, ...header, fields, ...(shot === undefined ? [] : shown)));
}
