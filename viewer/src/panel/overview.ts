/** What the panel beside the view says about the whole report, while no clash is selected. */
import type { Lengths } from "../data/length";
import type { ClashModel } from "../data/model";
import type { Report } from "../data/report";
import { count, counted, make } from "../elements";

export function overview({ report, facts }: ClashModel, lengths: Lengths): HTMLElement[] {
  const scenes = report.scenes.map(({ label, parts, triangles }) =>
    make("li", {}, make("b", {}, label), ` ${counted(parts, "part")}, ${counted(triangles, "triangle")}`),
  );
  const { tolerance, clearance } = report.asked;
  const gaps = clearance === undefined ? "" : ` Gaps of at most ${lengths.text(clearance)} are listed.`;
  const lines = [
    make("h2", {}, "Select a clash in the list, or a dot in the view."),
    make("ul", { class: "scenes" }, ...scenes),
    make("p", { class: "meaning" }, `Common material deeper than ${lengths.text(tolerance)} counts as a clash.${gaps}`),
  ];
  if (report.complete === false) lines.push(make("p", { class: "warning" }, `The search is not complete: ${report.stopped ?? ""}.`));
  if (facts.boxes > 0) lines.push(make("p", { class: "warning" }, boxSentence(facts.boxes, facts.max_triangles)));
  return [...lines, ...depths(report, lengths), ...gone(report)];
}

/** Says how many parts are drawn as boxes, and why. */
export function boxSentence(boxes: number, maxTriangles: number): string {
  const parts = boxes === 1 ? "1 part is drawn as a box" : `${counted(boxes, "part")} are drawn as boxes`;
  return `${parts}: the page holds at most ${counted(maxTriangles, "triangle")}, or the parts have no triangles.`;
}

/** Returns the number of pairs in each decade of depth, with a bar for each. */
function depths({ decades, asked }: Report, lengths: Lengths): HTMLElement[] {
  if (decades.length === 0) return [];
  const most = Math.max(...decades.map(({ pairs }) => pairs));
  const rows = decades.map(({ from, to, pairs }) => {
    const bar = make("span", { class: `bar ${to > asked.tolerance ? "deep" : ""}` });
    bar.style.width = `${(100 * pairs) / most}%`;
    const range = from === 0 ? `below ${lengths.text(to)}` : `from ${lengths.text(from)}`;
    return make("tr", {}, make("th", { scope: "row" }, range), make("td", {}, count(pairs)), make("td", { class: "bars" }, bar));
  });
  return [make("table", { class: "depths" }, make("caption", {}, "Pairs by depth"), make("tbody", {}, ...rows))];
}

/** Lists the clashes of the previous report that no longer exist. */
function gone({ gone: all }: Report): HTMLElement[] {
  if (all === undefined || all.length === 0) return [];
  const rows = all.map(({ names, kind, removed }) =>
    make("li", {}, names.join(" × "), make("span", { class: "meaning" }, ` ${kind}${removed === undefined ? "" : ", a part was removed"}`)),
  );
  const title = `${counted(all.length, "clash", "clashes")} of the previous report ${all.length === 1 ? "is" : "are"} gone`;
  return [make("details", { class: "gone" }, make("summary", {}, title), make("ul", { class: "scenes" }, ...rows))];
}
