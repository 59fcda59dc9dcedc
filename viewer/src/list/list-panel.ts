/** The list of findings. */
import type { ClashModel, Finding } from "../data/model";
import { count, get, make } from "../elements";
import type { Lengths } from "../data/length";
import type { Store } from "../state";
import { flatLines, Groups, type Head, type Item, type Line } from "./lines";
import { VirtualList } from "./virtual-list";

export class ListPanel {
  private readonly frame = get("list");
  private readonly empty = get("list-empty");
  private readonly groups: Groups;
  private folded = new Set<number>();
  private lines: Line[] = [];
  /** The line that the keyboard is at. */
  private current = -1;
  private readonly list: VirtualList;

  constructor(
    private readonly store: Store<ClashModel>,
    private readonly lengths: Lengths,
  ) {
    this.groups = new Groups(store.model);
    // A long report begins with its groups folded, so that all of them are in sight.
    if (store.model.findings.length > 200) this.folded = new Set(this.groups.all());
    this.list = new VirtualList(this.frame, (index) => this.render(index));
    this.frame.addEventListener("click", (event) => this.click(event));
    this.frame.addEventListener("keydown", (event) => this.press(event));
    get("fold-all").addEventListener("click", () => this.foldAll());
    const grouped = get<HTMLInputElement>("grouped");
    grouped.checked = store.now.isGrouped;
    grouped.addEventListener("change", () => store.set({ isGrouped: grouped.checked }));
    store.listen((_, changed) => {
      if (changed.has("kept") || changed.has("isGrouped")) this.rebuild();
      else if (changed.has("unsaved")) this.list.redraw();
      if (changed.has("selected")) this.show(store.now.selected);
    });
    this.rebuild();
  }

  /** Returns the finding that lies `step` findings after the selected one, in the order of the list. */
  neighbor(step: 1 | -1): Finding | undefined {
    const { selected, kept, isGrouped } = this.store.now;
    const all = isGrouped ? this.groups.lines(kept, new Set()) : this.lines;
    const found = all.flatMap((line) => (line.kind === "item" ? [line.finding] : []));
    const at = selected === undefined ? -1 : found.indexOf(selected);
    if (at >= 0) return found[at + step];
    // The filters may have left out the selected finding, for example because its status changed.
    const after = selected === undefined ? -1 : selected.index;
    return step > 0 ? found.find(({ index }) => index > after) : found.findLast(({ index }) => after < 0 || index < after);
  }

  private rebuild(): void {
    const { kept, isGrouped, selected } = this.store.now;
    this.lines = isGrouped ? this.groups.lines(kept, this.folded) : flatLines(kept);
    this.current = selected === undefined ? -1 : this.indexOf(selected);
    this.list.reset(this.lines.length);
    this.empty.hidden = kept.length > 0;
    get("shown").textContent = `${count(kept.length)} of ${count(this.store.model.findings.length)}`;
    const fold = get("fold-all");
    fold.hidden = !isGrouped || !this.lines.some((line) => line.kind === "head");
    fold.textContent = this.folded.size > 0 ? "Unfold all" : "Fold all";
  }

  private foldAll(): void {
    this.folded = this.folded.size > 0 ? new Set() : new Set(this.groups.all());
    this.rebuild();
  }

  private setFolded(group: number, isFolded: boolean): void {
    if (isFolded) this.folded.add(group);
    else this.folded.delete(group);
    const before = this.current;
    this.rebuild();
    this.current = before;
    this.list.redraw();
  }

  /** Unfolds the group of a finding, and scrolls to it. */
  private show(finding: Finding | undefined): void {
    if (finding !== undefined && this.store.now.isGrouped && this.folded.has(this.groups.of(finding))) {
      this.folded.delete(this.groups.of(finding));
      this.rebuild();
    }
    this.moveTo(finding === undefined ? -1 : this.indexOf(finding));
  }

  private moveTo(index: number): void {
    this.current = index;
    this.list.redraw();
    if (index >= 0) this.list.reveal(index);
    if (index >= 0) this.frame.setAttribute("aria-activedescendant", `line-${index}`);
    else this.frame.removeAttribute("aria-activedescendant");
  }

  private indexOf(finding: Finding): number {
    return this.lines.findIndex((line) => line.kind === "item" && line.finding === finding);
  }

  private click(event: MouseEvent): void {
    const element = (event.target as Element).closest<HTMLElement>("[data-line]");
    if (element !== null) this.activate(Number(element.dataset["line"]));
  }

  private activate(index: number): void {
    const line = this.lines[index];
    if (line === undefined) return;
    this.current = index;
    if (line.kind === "item") this.store.select(line.finding);
    else this.setFolded(line.group, !line.isFolded);
  }

  private press(event: KeyboardEvent): void {
    const line = this.lines[this.current];
    const page = Math.max(1, Math.floor(this.frame.clientHeight / 46) - 1);
    const steps: Record<string, number> = { ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -1e9, End: 1e9 };
    const step = steps[event.key];
    if (step !== undefined) {
      this.moveTo(Math.min(Math.max(this.current + step, 0), this.lines.length - 1));
      const reached = this.lines[this.current];
      if (reached?.kind === "item") this.store.select(reached.finding);
    } else if (event.key === "Enter" || event.key === " ") {
      this.activate(this.current);
    } else if (event.key === "ArrowLeft" && line !== undefined) {
      this.fold(line);
    } else if (event.key === "ArrowRight" && line?.kind === "head" && line.isFolded) {
      this.setFolded(line.group, false);
    } else {
      return;
    }
    event.preventDefault();
  }

  /** Folds the group of a line, and moves to its head. */
  private fold(line: Line): void {
    const group = line.kind === "head" ? line.group : this.groups.of(line.finding);
    const head = this.lines.findIndex((each) => each.kind === "head" && each.group === group);
    if (head < 0) return;
    this.current = head;
    this.setFolded(group, true);
    this.moveTo(head);
  }

  private render(index: number): HTMLElement {
    const line = this.lines[index];
    const element = line.kind === "head" ? renderHead(line) : this.renderItem(line);
    element.id = `line-${index}`;
    element.dataset["line"] = String(index);
    element.setAttribute("role", "treeitem");
    element.classList.toggle("current", index === this.current);
    return element;
  }

  private renderItem({ finding, isInGroup }: Item): HTMLElement {
    const { kind, parts, depth, gap, row, id } = finding;
    const isSelected = finding === this.store.now.selected;
    const size = depth ?? gap;
    const others = parts.length > 2 ? ` and ${count(parts.length - 2)} more` : "";
    return make(
      "div",
      {
        class: `line item ${isInGroup ? "in-group" : ""} ${isSelected ? "selected" : ""}`,
        "aria-selected": String(isSelected),
        "aria-level": isInGroup ? "2" : "1",
        title: `${finding.sentence} (${id})`,
      },
      make("span", { class: `kind ${kind}` }, kind),
      make("span", { class: "names" }, nameOf(parts[0]), make("span", { class: "and" }, " × "), nameOf(parts[1]), others),
      make("span", { class: "size" }, size === undefined ? "" : this.lengths.brief(size)),
      make("span", { class: `status ${row.status}` }, row.status),
    );
  }
}

function renderHead({ title, count: members, isFolded }: Head): HTMLElement {
  return make(
    "div",
    { class: "line head", "aria-expanded": String(!isFolded), "aria-level": "1", title },
    make("span", { class: "fold", "aria-hidden": "true" }, isFolded ? "▸" : "▾"),
    make("span", { class: "title" }, title),
    make("span", { class: "members" }, count(members)),
  );
}

function nameOf(part: { name: string; key: string }): string {
  return part.name === "" ? part.key : part.name;
}
