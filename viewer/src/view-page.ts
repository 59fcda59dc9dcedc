/** Shows a page about a pair of meshes, a hierarchy, or a robot. */
import { commandsOfView, listenToKeys, type Command } from "./commands";
import { Lengths } from "./data/length";
import { pairOf, type Finding, type Model } from "./data/model";
import {
  between, extentOf, readLevels, readPlaces, readViewModel,
  type HierarchyFacts, type PairFacts, type RobotFacts, type RobotStep, type ViewFacts,
} from "./data/view-model";
import { around } from "./data/boxes";
import type { PlacedPart } from "./data/geometry";
import { count, counted, get } from "./elements";
import { fillHelp, helpSheet } from "./panel/help";
import { showPicked } from "./panel/picked";
import { Steps, type Step } from "./panel/steps";
import { aboutLines, showSummary } from "./panel/summary";
import { Toolbar } from "./panel/toolbar";
import { Store } from "./state";
import { followTheme } from "./theme";
import { BoxOverlay } from "./view/box-overlay";
import { PairOverlay } from "./view/pair-overlay";
import { SceneView } from "./view/scene-view";

/** A page that was set up: its view, and what the slider does if there is one. */
interface Shown {
  readonly store: Store;
  readonly view: SceneView;
  readonly steps?: Steps;
}

export async function startViewPage(): Promise<void> {
  document.body.dataset["page"] = "view";
  const { facts, model, beside } = await readViewModel();
  const lengths = new Lengths(facts.unit, facts.meters);
  document.title = `${facts.title}: ${facts.heading}`;
  get("title").textContent = facts.title;
  get("summary").textContent = facts.heading;
  const shown = await show(facts, model, beside, lengths);
  const { store, view, steps } = shown;
  showPicked(store);
  const toggleHelp = helpSheet();
  get("help-open").addEventListener("click", toggleHelp);
  const all = [...commandsOfSteps(facts, steps), ...commandsOfView(store, view, false, facts.kind), help(toggleHelp)];
  new Toolbar(all, store, view);
  listenToKeys(all, store);
  fillHelp(all, aboutLines(facts, lengths));
  followTheme((isDark) => view.setTheme(isDark));
  Object.assign(window, { impinge: { store, view } }); // for tests
  document.body.dataset["ready"] = "";
}

function help(toggleHelp: () => void): Command {
  return { key: "?", does: "This help", run: toggleHelp };
}

function commandsOfSteps({ kind }: ViewFacts, steps: Steps | undefined): Command[] {
  if (steps === undefined) return [];
  const noun = kind === "hierarchy" ? "level" : "step";
  return [
    { key: "n", does: `Next ${noun}`, button: "Next", run: () => steps.move(1) },
    { key: "p", does: `Previous ${noun}`, button: "Previous", run: () => steps.move(-1) },
  ];
}

function show(facts: ViewFacts, model: Model, beside: readonly PlacedPart[], lengths: Lengths): Promise<Shown> | Shown {
  switch (facts.kind) {
    case "pair":
      return showPair(facts, model, beside, lengths);
    case "hierarchy":
      return showHierarchy(facts, model, lengths);
    case "robot":
      return showRobot(facts, model, lengths);
  }
}

function showPair(facts: PairFacts, model: Model, beside: readonly PlacedPart[], lengths: Lengths): Shown {
  const { nearest, heading } = facts;
  const curves = model.geometry.curves.get(0) ?? [];
  const box = nearest === undefined ? between(model.geometry.parts[0].box, model.geometry.parts[1].box) : around(nearest);
  const pair = pairOf([0, 1], heading, { box, curves });
  const store = new Store({ ...model, findings: [pair] });
  const gap = nearest === undefined ? "" : lengths.text(Math.hypot(...[0, 1, 2].map((axis) => nearest[1][axis] - nearest[0][axis])));
  const view = new SceneView(store, lengths, (placement) => new PairOverlay(placement, beside, nearest, gap));
  const legend: [string, string][] = [["first", facts.parts[0][0]], ["second", facts.parts[1][0]]];
  if (nearest !== undefined) legend.push(["shared", "the line between the nearest points"]);
  else legend.push(["hit", "intersecting faces"], ["shared", "intersection curves"]);
  showSummary(facts, legend);
  store.select(pair);
  return { store, view };
}

async function showHierarchy(facts: HierarchyFacts, model: Model, lengths: Lengths): Promise<Shown> {
  const levels = await readLevels();
  const store = new Store(model, { surroundings: "solid" });
  let overlay: BoxOverlay | undefined;
  const view = new SceneView(store, lengths, (placement) => (overlay = new BoxOverlay(placement, levels[0] ?? new Float64Array())));
  const now = showSummary(facts, [["box", "boxes of the level"]]);
  if (levels.length === 0) return { store, view };
  const steps: Step[] = levels.map((boxes, level) => ({ name: `level ${level}: ${counted(boxes.length / 6, "box", "boxes")}` }));
  const left = facts.levels - levels.length;
  const missing = left === 0 ? "" : ` ${counted(left, "deeper level")} with more than ${count(facts.max_boxes)} boxes ${left === 1 ? "is" : "are"} not in the page.`;
  const start = Math.max(levels.findLastIndex((boxes) => boxes.length / 6 <= MAX_BOXES_AT_START), 0);
  const slider = new Steps("Level", steps, start, (level) => {
    overlay?.setBoxes(levels[level]);
    view.changed();
    now.textContent = `Level ${level} of ${facts.levels - 1}.${missing}`;
  });
  return { store, view, steps: slider };
}

/** Maximum number of boxes that the page shows first. More hide each other. */
const MAX_BOXES_AT_START = 160;

async function showRobot(facts: RobotFacts, model: Model, lengths: Lengths): Promise<Shown> {
  const places = await readPlaces(facts, model);
  const store = new Store({ ...model, extent: extentOf(places, model) }, { surroundings: "solid" });
  const view = new SceneView(store, lengths, undefined, false);
  const looks: [string, string][] = [["first", "the link that collides"], ["second", "the link or obstacle that it collides with"]];
  const track: [string, string][] = [["free", "proved free"], ["collides", "collides"], ["open", "not proved"]];
  const found = new Set(facts.steps.map(({ verdict }) => verdict));
  const now = showSummary(facts, [...(found.has("collides") ? looks : []), ...track.filter(([look]) => found.has(look as RobotStep["verdict"]))]);
  const steps = facts.steps.map(({ name, verdict }) => ({ name, look: verdict }));
  const start = Math.max(facts.steps.findIndex(({ verdict }) => verdict === "collides"), 0);
  const slider = new Steps(facts.slider, steps, start, (at) => {
    places[at].forEach((part, place) => (model.geometry.parts[place] = part));
    now.textContent = facts.steps[at].text;
    store.set({ selected: collisionOf(facts.steps[at], model), picked: undefined });
    view.changed();
  });
  return { store, view, steps: slider };
}

/** Returns the colliding parts of a step in their places. */
function collisionOf({ pair, text }: RobotStep, { geometry }: Model): Finding | undefined {
  return pair === undefined ? undefined : pairOf(pair, text, { box: between(geometry.parts[pair[0]].box, geometry.parts[pair[1]].box) });
}
