/** What the person chose: the selected finding, filters, and how the view shows the model. */
import type { Finding, Model } from "./data/model";
import type { Status } from "./data/report";
import { matches, noFilter, type Filter } from "./list/filter";

/** How the parts around the selected finding are drawn. */
export type Surroundings = "ghost" | "solid" | "none";

/** A cut through the model: along an axis of the world, or across the direction of view. */
export type SectionAxis = "x" | "y" | "z" | "view";

export interface State {
  selected: Finding | undefined;
  filter: Filter;
  /** The findings that the filter keeps, in the order of the report. */
  kept: readonly Finding[];
  isGrouped: boolean;
  surroundings: Surroundings;
  section: SectionAxis | undefined;
  isMeasuring: boolean;
  /** Place of the part that the person clicked in the view. */
  picked: number | undefined;
  /** Places of the parts that are hidden. */
  hidden: ReadonlySet<number>;
  /** Number of statuses and notes that were edited and not saved. */
  unsaved: number;
}

type Listener = (state: Readonly<State>, changed: ReadonlySet<keyof State>) => void;

/** Holds the state and tells listeners which fields changed. */
export class Store<M extends Model = Model> {
  private readonly listeners: Listener[] = [];
  private state: State;

  constructor(
    readonly model: M,
    start: Partial<State> = {},
  ) {
    this.state = {
      selected: undefined,
      filter: noFilter(),
      kept: model.findings,
      isGrouped: false,
      surroundings: "ghost",
      section: undefined,
      isMeasuring: false,
      picked: undefined,
      hidden: new Set(),
      unsaved: 0,
      ...start,
    };
  }

  get now(): Readonly<State> {
    return this.state;
  }

  /** Changes fields, and tells every listener once. */
  set(change: Partial<State>): void {
    if (change.filter !== undefined) {
      const { filter } = change;
      change = { ...change, kept: this.model.findings.filter((finding) => matches(finding, filter)) };
    }
    const changed = new Set((Object.keys(change) as (keyof State)[]).filter((key) => change[key] !== this.state[key]));
    if (changed.size === 0) return;
    this.state = { ...this.state, ...change };
    for (const listener of this.listeners) listener(this.state, changed);
  }

  listen(listener: Listener): void {
    this.listeners.push(listener);
  }

  /** Selects a finding. A section stays, and moves to it. */
  select(finding: Finding | undefined): void {
    this.set({ selected: finding, picked: undefined });
  }

  /** Gives the selected finding a status. */
  setStatus(status: Status): void {
    const { selected, unsaved, filter } = this.state;
    if (selected === undefined || selected.row.status === status) return;
    selected.row.status = status;
    delete selected.row.accepted; // it is accepted as it is now
    this.set({ unsaved: unsaved + 1, filter: { ...filter } });
  }

  /** Gives the selected finding a remark. */
  setNote(note: string): void {
    const { selected, unsaved } = this.state;
    if (selected === undefined || note === (selected.row.note ?? "")) return;
    if (note === "") delete selected.row.note;
    else selected.row.note = note;
    this.set({ unsaved: unsaved + 1 });
  }
}
