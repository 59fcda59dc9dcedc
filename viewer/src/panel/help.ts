/** The help sheet: the keys, and what the page is made of. */
import type { Command } from "../commands";
import type { Lengths } from "../data/length";
import type { ClashModel } from "../data/model";
import { counted, get, make } from "../elements";
import { boxSentence } from "./overview";
import { MAX_PICTURES } from "./save-bcf";

/** Fills the sheet, and returns a function that opens or closes it. */
export function helpSheet(): () => void {
  const sheet = get<HTMLDialogElement>("help");
  get("help-close").addEventListener("click", () => sheet.close());
  return () => (sheet.open ? sheet.close() : sheet.showModal());
}

export function fillHelp(commands: readonly Command[], about: readonly string[]): void {
  const rows = commands.map(({ key, does }) => make("tr", {}, make("td", {}, make("kbd", {}, key)), make("td", {}, does)));
  get("help-keys").replaceChildren(...rows);
  get("help-about").replaceChildren(...about.map((line) => make("li", {}, line)));
}

export function aboutReport({ report, facts, findings }: ClashModel, lengths: Lengths): string[] {
  const clashes = findings.length - report.duplicates.length;
  const lines = [
    `Written by impinge ${report.version} from ${report.scenes.map(({ file, label }) => file ?? label).join(", ")}.`,
    `Depths, gaps and kinds are those of the report. Corners are drawn within ${lengths.text(facts.rounding)} of their place.`,
  ];
  if (facts.boxes > 0) lines.push(boxSentence(facts.boxes, facts.max_triangles));
  if (facts.curves < clashes) lines.push(`Intersection curves are drawn for the worst ${counted(facts.curves, "clash", "clashes")}.`);
  const topics = facts.bcf?.topics.length ?? 0;
  if (topics > MAX_PICTURES) lines.push(`A BCF file has ${counted(topics, "topic")}, and pictures of the first ${MAX_PICTURES}.`);
  lines.push("The page makes no request, and statuses stay in it until you save them.");
  return lines;
}
