/** The panel beside the view of a page that is not about clashes: the answer and its numbers. */
import type { Lengths } from "../data/length";
import type { ViewFacts } from "../data/view-model";
import { counted, get, make } from "../elements";

/** Shows the answer, and returns the paragraph that says what the view shows now. */
export function showSummary(facts: ViewFacts, legend: readonly (readonly [look: string, text: string])[]): HTMLElement {
  const now = make("p", { id: "now", role: "status" });
  const frame = get("details");
  frame.setAttribute("aria-label", "Answer");
  frame.removeAttribute("aria-live"); // the paragraph alone changes
  frame.replaceChildren(
    make("h2", {}, facts.heading),
    now,
    make("ul", { class: "legend" }, ...legend.map(([look, text]) => make("li", {}, make("span", { class: `swatch ${look}` }), text))),
    make("dl", {}, ...facts.rows.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)])),
    ...notes(facts).map((note) => make("p", { class: "warning" }, note)),
  );
  return now;
}

/** Returns what the page leaves out. */
function notes(facts: ViewFacts): string[] {
  const { boxes, max_triangles: most } = facts;
  const found: string[] = [];
  if (boxes > 0) found.push(`${counted(boxes, "part")} drawn as ${boxes === 1 ? "a box" : "boxes"}: the page holds at most ${counted(most, "triangle")}.`);
  if (facts.kind === "pair" && !facts.has_faces) found.push("The intersecting faces are not drawn: there are too many.");
  if (facts.kind === "pair" && !facts.has_curves) found.push("The intersection curves are not drawn: they have too many points.");
  return found;
}

/** Returns the lines of the help sheet about the page. */
export function aboutLines({ version, title, rounding }: ViewFacts, lengths: Lengths): string[] {
  return [
    `Written by impinge ${version} from ${title}.`,
    `The answer and its numbers are exact or proved. Corners are drawn within ${lengths.text(rounding)} of their place.`,
    "The page makes no request.",
  ];
}
