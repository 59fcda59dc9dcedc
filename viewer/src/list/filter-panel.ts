/** The search and the filters above the list. */
import type { ClashModel } from "../data/model";
import type { Lengths } from "../data/length";
import { KINDS, STATUSES } from "../data/report";
import { count, get, make } from "../elements";
import type { State, Store } from "../state";
import { isEmpty, noFilter, wordsOf, type Filter } from "./filter";

/** Number of steps of the slider for the least depth. */
const DEPTH_STEPS = 100;

type Choice = "rule" | "scene" | "type";

export class FilterPanel {
  private readonly search = get<HTMLInputElement>("search");
  private readonly depth = get<HTMLInputElement>("min-depth");
  private readonly selects = new Map<Choice, HTMLSelectElement>();
  /** Smallest and largest depth that is not zero. */
  private readonly depths: readonly [number, number] | undefined;

  constructor(
    private readonly store: Store<ClashModel>,
    private readonly lengths: Lengths,
  ) {
    this.depths = rangeOfDepths(store);
    this.search.addEventListener("input", () => this.change({ words: wordsOf(this.search.value) }));
    this.search.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.search.blur();
    });
    this.addChips();
    this.addChoices();
    this.addDepth();
    get("clear-filters").addEventListener("click", () => this.clear());
    store.listen((state, changed) => {
      if (changed.has("filter")) this.show(state);
    });
    this.show(store.now);
  }

  /** Moves the keyboard to the search. */
  focus(): void {
    this.search.focus();
    this.search.select();
  }

  private change(part: Partial<Filter>): void {
    this.store.set({ filter: { ...this.store.now.filter, ...part } });
  }

  private clear(): void {
    this.search.value = "";
    this.depth.value = "0";
    for (const select of this.selects.values()) select.value = "";
    this.store.set({ filter: noFilter() });
  }

  private addChips(): void {
    const { findings } = this.store.model;
    for (const kind of KINDS.filter((each) => findings.some((finding) => finding.kind === each))) {
      const button = chip(kind, `kind ${kind}`);
      button.addEventListener("click", () => this.change({ withoutKinds: toggled(this.store.now.filter.withoutKinds, kind) }));
      get("kinds").append(button);
    }
    for (const status of STATUSES) {
      const button = chip(status, `status ${status}`);
      button.addEventListener("click", () =>
        this.change({ withoutStatuses: toggled(this.store.now.filter.withoutStatuses, status) }),
      );
      get("statuses").append(button);
    }
  }

  private addChoices(): void {
    const { findings } = this.store.model;
    const parts = findings.flatMap((finding) => finding.parts);
    this.addChoice("rule", "Rule", findings.map(({ rule }) => rule));
    this.addChoice("scene", "Scene", parts.map(({ scene }) => scene));
    this.addChoice("type", "Type", parts.map(({ type }) => type));
  }

  /** Adds a choice, if there is more than one value. */
  private addChoice(name: Choice, label: string, values: (string | undefined)[]): void {
    const known = [...new Set(values.filter((value): value is string => value !== undefined && value !== ""))].sort();
    if (known.length < 2) return;
    const select = make("select", { id: `filter-${name}` }, make("option", { value: "" }, "any"));
    select.append(...known.map((value) => make("option", { value }, value)));
    select.addEventListener("change", () => this.change({ [name]: select.value }));
    this.selects.set(name, select);
    get("choices").append(make("label", {}, label, select));
  }

  private addDepth(): void {
    get("depth-filter").hidden = this.depths === undefined;
    this.depth.max = String(DEPTH_STEPS);
    this.depth.addEventListener("input", () => this.change({ minDepth: this.depthAt(Number(this.depth.value)) }));
  }

  /** Returns the depth at a step of the slider: equal steps are equal factors. */
  private depthAt(step: number): number {
    if (step === 0 || this.depths === undefined) return 0;
    const [least, most] = this.depths;
    return Number((least * (most / least) ** (step / DEPTH_STEPS)).toPrecision(2));
  }

  private show({ filter }: Readonly<State>): void {
    const { findings } = this.store.model;
    for (const button of get("kinds").querySelectorAll("button")) {
      const kind = button.dataset["value"] as (typeof KINDS)[number];
      showChip(button, !filter.withoutKinds.has(kind), findings.filter((each) => each.kind === kind).length);
    }
    for (const button of get("statuses").querySelectorAll("button")) {
      const status = button.dataset["value"] as (typeof STATUSES)[number];
      const members = findings.filter((each) => each.row.status === status).length;
      button.hidden = members === 0 && !filter.withoutStatuses.has(status);
      showChip(button, !filter.withoutStatuses.has(status), members);
    }
    const depth = filter.minDepth === 0 ? "any depth" : `${this.lengths.text(filter.minDepth)} or deeper`;
    get("min-depth-text").textContent = depth;
    this.depth.setAttribute("aria-valuetext", depth);
    get("clear-filters").hidden = isEmpty(filter);
    const { part } = filter;
    get("part-filter").hidden = part === undefined;
    get("part-filter").textContent = part === undefined ? "" : `only clashes of ${this.store.model.parts[part]?.name ?? ""}`;
  }
}

function rangeOfDepths(store: Store<ClashModel>): readonly [number, number] | undefined {
  let least = Infinity;
  let most = 0;
  for (const { depth } of store.model.findings) {
    const deep = depth?.[1] ?? depth?.[0] ?? 0;
    if (deep > 0) least = Math.min(least, deep);
    most = Math.max(most, deep);
  }
  return least < most ? [least, most] : undefined;
}

function chip(value: string, style: string): HTMLButtonElement {
  return make("button", { type: "button", class: `chip ${style}`, "data-value": value });
}

function showChip(button: HTMLButtonElement, isOn: boolean, members: number): void {
  button.setAttribute("aria-pressed", String(isOn));
  button.replaceChildren(button.dataset["value"] ?? "", " ", make("span", { class: "members" }, count(members)));
}

function toggled<T>(set: ReadonlySet<T>, item: T): ReadonlySet<T> {
  const changed = new Set(set);
  if (!changed.delete(item)) changed.add(item);
  return changed;
}
