/** The panel beside the view: everything that the report says about the selected finding. */
import type { Lengths } from "../data/length";
import type { ClashModel, Finding } from "../data/model";
import { STATUSES, type Kind, type Part } from "../data/report";
import { counted, get, make } from "../elements";
import type { Store } from "../state";
import { overview } from "./overview";

const MEANINGS: Record<Kind, string> = {
  duplicate: "The parts are the same shape in the same place.",
  contained: "One part lies inside the other.",
  clash: "The parts share material that is deeper than the tolerance.",
  undecided: "Nothing was proved, so the pair counts as a clash.",
  contact: "The parts touch, or share material that is no deeper than the tolerance.",
  clearance: "The gap between the parts is at most the clearance.",
};

/** Largest number of parts of a set of duplicates that are listed. */
const MAX_PARTS = 50;

export class DetailsPanel {
  private readonly frame = get("details");

  constructor(
    private readonly store: Store<ClashModel>,
    private readonly lengths: Lengths,
  ) {
    store.listen((state, changed) => {
      if (changed.has("selected")) this.show(state.selected);
      else if (changed.has("filter") || changed.has("hidden")) this.update();
    });
    this.show(undefined);
  }

  private show(finding: Finding | undefined): void {
    if (finding === undefined) {
      this.frame.replaceChildren(...overview(this.store.model, this.lengths));
      return;
    }
    const { parts } = finding;
    const isSet = finding.kind === "duplicate";
    this.frame.replaceChildren(
      make("p", { class: "badges" }, make("span", { class: `kind ${finding.kind}` }, finding.kind), make("code", {}, finding.id)),
      make("h2", {}, `${capital(finding.sentence)}.`),
      make("p", { class: "meaning" }, MEANINGS[finding.kind], finding.why === undefined ? "" : ` Not proved: ${finding.why}.`),
      this.statuses(finding),
      this.numbers(finding),
      ...parts.slice(0, MAX_PARTS).map((part, at) => this.part(part, finding.places[at], isSet ? Math.min(at, 1) : at)),
      parts.length > MAX_PARTS ? make("p", {}, `and ${counted(parts.length - MAX_PARTS, "other part")}`) : "",
    );
    this.update();
  }

  private statuses(finding: Finding): HTMLElement {
    const buttons = STATUSES.map((status, at) => {
      const input = make("input", { type: "radio", name: "status", value: status, id: `status-${status}` });
      input.addEventListener("change", () => this.store.setStatus(status));
      return make("label", { class: `status ${status}`, title: `Key ${at + 1}` }, input, status);
    });
    const note = make("input", { type: "text", id: "note", placeholder: "Remark", "aria-label": "Remark", autocomplete: "off" });
    note.value = finding.row.note ?? "";
    note.addEventListener("change", () => this.store.setNote(note.value.trim()));
    return make("fieldset", { id: "status-choice" }, make("legend", {}, "Status"), ...buttons, note);
  }

  private numbers({ depth, gap, point, box, rule, severity, row, curves }: Finding): HTMLElement {
    const { report } = this.store.model;
    const origin = report.scenes[0]?.origin ?? [0, 0, 0];
    const at = point?.map((x, axis) => this.lengths.coordinate(x + origin[axis], report.asked.tolerance)).join(", ");
    const size = box?.[0].map((low, axis) => this.lengths.text(box[1][axis] - low)).join(" × ");
    const rows: [string, string | undefined][] = [
      ["Depth", depth === undefined ? undefined : this.lengths.interval(depth)],
      ["Gap", gap === undefined ? undefined : this.lengths.interval(gap)],
      ["Accepted at", row.accepted === undefined ? undefined : this.lengths.text(row.accepted)],
      ["Rule", rule],
      ["Severity", severity],
      ["Point", at === undefined ? undefined : `${at}${report.unit === undefined ? "" : ` ${report.unit}`}`],
      ["Common box", size],
      ["Curves", curves.length > 0 ? counted(curves.length, "intersection curve") : undefined],
    ];
    const known = rows.filter((each): each is [string, string] => each[1] !== undefined);
    return make("dl", {}, ...known.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
  }

  private part(part: Part, place: number, at: number): HTMLElement {
    const hide = make("button", { type: "button", class: "small", "data-hide": String(place) }, "Hide");
    hide.addEventListener("click", () => toggleHidden(this.store, place));
    const only = make("button", { type: "button", class: "small" }, "All its clashes");
    only.addEventListener("click", () => this.store.set({ filter: { ...this.store.now.filter, part: place } }));
    const rows: [string, string][] = [
      ["Type", part.type ?? ""],
      ["Key", part.key === part.name ? "" : part.key],
      ["Scene", this.store.model.report.scenes.length > 1 ? part.scene : ""],
      ["Path", (part.path ?? []).join(" / ")],
    ];
    const known = rows.filter(([, value]) => value !== "");
    const { geometry } = this.store.model;
    const mesh = geometry.parts[place]?.mesh;
    const look = mesh === undefined ? "drawn as its box" : geometry.meshes[mesh].isClosed ? "" : "open";
    return make(
      "section",
      { class: "part" },
      make("h3", {}, make("span", { class: `swatch ${at === 0 ? "first" : "second"}` }), part.name === "" ? part.key : part.name),
      make("dl", {}, ...known.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)])),
      look === "" ? "" : make("p", { class: "meaning" }, `This part is ${look}.`),
      make("p", { class: "actions" }, hide, only),
    );
  }

  /** Shows a changed status, and whether parts are hidden. */
  private update(): void {
    const { selected, hidden } = this.store.now;
    if (selected === undefined) return;
    const radio = get<HTMLInputElement>(`status-${selected.row.status}`);
    radio.checked = true;
    for (const button of this.frame.querySelectorAll<HTMLButtonElement>("[data-hide]")) {
      button.textContent = hidden.has(Number(button.dataset["hide"])) ? "Show" : "Hide";
    }
  }
}

/** Hides a part, or shows it again. */
export function toggleHidden(store: Store, place: number): void {
  const hidden = new Set(store.now.hidden);
  if (!hidden.delete(place)) hidden.add(place);
  store.set({ hidden });
}

function capital(sentence: string): string {
  return sentence.charAt(0).toUpperCase() + sentence.slice(1);
}
