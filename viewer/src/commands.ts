/** What keys and buttons do. One table makes the keys, the toolbar and the help sheet. */
import { STATUSES } from "./data/report";
import type { FilterPanel } from "./list/filter-panel";
import type { ListPanel } from "./list/list-panel";
import { toggleHidden } from "./panel/details";
import type { State, Store } from "./state";
import { nearestAxis } from "./view/section";
import type { SceneView } from "./view/scene-view";

export interface Command {
  readonly key: string;
  /** What it does, for the help sheet. */
  readonly does: string;
  /** Name on the toolbar; without one there is no button. */
  readonly button?: string;
  /** Whether the button is pressed in a state. */
  readonly isOn?: (state: Readonly<State>) => boolean;
  /** Whether the command does nothing without a selected clash. */
  readonly needsClash?: boolean;
  readonly run: () => void;
}

/** Returns all commands of a report of clashes, in the order of the help sheet. */
export function commandsOfReport(store: Store, view: SceneView, list: ListPanel, filters: FilterPanel, toggleHelp: () => void): Command[] {
  const step = (by: 1 | -1) => {
    const finding = list.neighbor(by);
    if (finding !== undefined) store.select(finding);
  };
  return [
    { key: "n", does: "Next clash", button: "Next", run: () => step(1) },
    { key: "p", does: "Previous clash", button: "Previous", run: () => step(-1) },
    ...commandsOfView(store, view, true, "clash"),
    ...STATUSES.map((status, at) => ({
      key: String(at + 1),
      does: `Set the status: ${status}`,
      needsClash: true,
      run: () => store.setStatus(status),
    })),
    { key: "/", does: "Search", run: () => filters.focus() },
    { key: "?", does: "This help", run: toggleHelp },
  ];
}

/** Returns the commands of every view. `canDeselect` says whether a view without a selection is useful. */
export function commandsOfView(store: Store, view: SceneView, canDeselect: boolean, subject: string): Command[] {
  const others: Command[] = [
    {
      key: "g",
      does: "Draw all other parts solid, or as ghosts",
      button: "Solid",
      isOn: (state) => state.surroundings === "solid",
      run: () => store.set({ surroundings: store.now.surroundings === "solid" ? "ghost" : "solid" }),
    },
    {
      key: "i",
      does: "Isolate: hide all other parts",
      button: "Isolate",
      isOn: (state) => state.surroundings === "none",
      needsClash: true,
      run: () => store.set({ surroundings: store.now.surroundings === "none" ? "ghost" : "none" }),
    },
  ];
  return [
    { key: "f", does: `Fit the view: the ${subject}, its parts, everything`, button: "Fit", run: () => view.fitNext() },
    ...(subject === "pair" ? [] : others),
    {
      key: "h",
      does: "Hide the part that was clicked in the view, or else the second part; again: show all",
      button: "Hide",
      isOn: (state) => state.hidden.size > 0,
      run: () => hide(store),
    },
    {
      key: "x",
      does: "Section through the middle of the view",
      button: "Section",
      isOn: (state) => state.section !== undefined,
      run: () => store.set({ section: store.now.section === undefined ? nearestAxis(view.toCamera) : undefined }),
    },
    { key: "X", does: "Turn the section: x, y, z, across the view", run: () => view.nextAxis() },
    {
      key: "m",
      does: "Measure between two points; they snap to corners and edges",
      button: "Measure",
      isOn: (state) => state.isMeasuring,
      run: () => store.set({ isMeasuring: !store.now.isMeasuring }),
    },
    {
      key: "Escape",
      does: `End the measurement, then the section${canDeselect ? ", then the selection" : ""}`,
      run: () => leave(store, canDeselect),
    },
  ];
}

function hide(store: Store): void {
  const { picked, selected, hidden } = store.now;
  const place = picked ?? (hidden.size > 0 ? undefined : selected?.places[1]);
  if (place !== undefined) {
    toggleHidden(store, place);
    store.set({ picked: undefined });
  } else if (hidden.size > 0) {
    store.set({ hidden: new Set() });
  }
}

function leave(store: Store, canDeselect: boolean): void {
  const { isMeasuring, section, picked } = store.now;
  if (isMeasuring) store.set({ isMeasuring: false });
  else if (picked !== undefined) store.set({ picked: undefined });
  else if (section !== undefined) store.set({ section: undefined });
  else if (canDeselect) store.select(undefined);
}

/** Runs commands by their keys, except while the person writes. */
export function listenToKeys(all: readonly Command[], store: Store): void {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isWriting(event.target)) return;
    if (document.querySelector("dialog[open]") !== null && event.key !== "?") return;
    const command = all.find(({ key }) => key === event.key);
    if (command === undefined || (command.needsClash === true && store.now.selected === undefined)) return;
    event.preventDefault();
    command.run();
  });
}

function isWriting(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !["radio", "checkbox", "range", "button"].includes(target.type);
  return target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement;
}
