/** Reads the data of the page and shows it. */
import "./style/base.css";
import "./style/frame.css";
import "./style/list.css";
import "./style/marks.css";
import "./style/view.css";
import "./style/details.css";
import "./style/help.css";
import { followAddress } from "./address";
import { commands, listenToKeys } from "./commands";
import { Lengths } from "./data/length";
import { readModel } from "./data/model";
import { counted, get, make } from "./elements";
import { FilterPanel } from "./list/filter-panel";
import { ListPanel } from "./list/list-panel";
import { DetailsPanel } from "./panel/details";
import { fillHelp, helpSheet } from "./panel/help";
import { showPicked } from "./panel/picked";
import { saveMenu } from "./panel/save-menu";
import { Toolbar } from "./panel/toolbar";
import { Store } from "./state";
import { followTheme } from "./theme";
import { SceneView } from "./view/scene-view";

async function start(): Promise<void> {
  const model = await readModel();
  const { report, facts } = model;
  const labels = report.scenes.map(({ label }) => label).join(", ");
  const summary = counted(model.findings.length, "finding");
  document.title = `${labels}: ${summary}`;
  get("title").textContent = labels;
  get("summary").textContent = `${counted(model.parts.length, "part")}, ${summary}`;
  const store = new Store(model);
  const lengths = new Lengths(report.unit, facts.meters);
  const list = new ListPanel(store, lengths);
  const filters = new FilterPanel(store, lengths);
  performance.mark("list-ready");
  new DetailsPanel(store, lengths);
  saveMenu(store);
  showPicked(store);
  const toggleHelp = helpSheet();
  get("help-open").addEventListener("click", toggleHelp);
  const view = new SceneView(store, lengths);
  const all = commands(store, view, list, filters, toggleHelp);
  new Toolbar(all, store, view);
  listenToKeys(all, store);
  fillHelp(all, model, lengths);
  followTheme((isDark) => view.setTheme(isDark));
  followAddress(store);
  Object.assign(window, { impinge: { store, view } }); // for tests
  document.body.dataset["ready"] = "";
}

start().catch((error: unknown) => {
  const text = error instanceof Error ? error.message : String(error);
  document.body.prepend(make("p", { class: "failure", role: "alert" }, `The page cannot be shown: ${text}`));
  console.error(error);
});
