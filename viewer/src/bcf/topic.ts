/** The status and the description of a topic, as the page has edited them. The description is read back by `--previous`. */
import type { ClashModel, Finding } from "../data/model";
import { STATUSES, type Interval, type Status, type Topic } from "../data/report";

/** Returns the status of a topic: that of the finding with the most work left. */
export function statusOf(topic: Topic, { findings }: ClashModel): string {
  const places = topic.findings.map((at) => STATUSES.indexOf(findings[at].row.status));
  const status: Status = STATUSES[Math.min(...places)];
  return status.charAt(0).toUpperCase() + status.slice(1);
}

/** Returns the description: the title, remarks, and a line for each finding. */
export function descriptionOf(topic: Topic, { findings, facts }: ClashModel): string {
  const own = topic.findings.map((at) => findings[at]);
  const remarks = own.flatMap(({ id, why, row }) => [
    ...(why === undefined ? [] : [`${id} is not proved: ${why}.`]),
    ...(row.note === undefined ? [] : [`${id}: ${row.note}`]),
  ]);
  const lines = own.map((finding) => lineOf(finding, facts.meters ?? 1));
  return [`${topic.title}.`, ...remarks, ...(topic.part_lines ?? []), "", ...lines].join("\n");
}

/** Returns the line of a finding, as `crates/impinge-report/src/bcf/description.rs` reads it. Lengths are in meters. */
function lineOf({ id, kind, depth, gap, row, sentence }: Finding, meters: number): string {
  const bounds = (name: string, interval: Interval | undefined) => {
    if (interval === undefined) return "";
    const [lower, upper] = interval;
    return `, ${name} ${upper === null ? `at least ${lower * meters}` : `${lower * meters} to ${upper * meters}`} m`;
  };
  const accepted = row.accepted === undefined ? "" : `, accepted at ${row.accepted * meters} m`;
  return `${id} ${kind} ${row.status}${bounds("depth", depth)}${bounds("gap", gap)}${accepted}: ${sentence}`;
}
