/** Shows a report of clashes. */
import { followAddress } from "./address";
import { commandsOfReport, listenToKeys } from "./commands";
import { Lengths } from "./data/length";
import { readClashModel } from "./data/model";
import { counted, get } from "./elements";
import { FilterPanel } from "./list/filter-panel";
import { ListPanel } from "./list/list-panel";
import { DetailsPanel } from "./panel/details";
import { aboutReport, fillHelp, helpSheet } from "./panel/help";
import { showPicked } from "./panel/picked";
import { saveMenu } from "./panel/save-menu";
import { Toolbar } from "./panel/toolbar";
import { Store } from "./state";
import { followTheme } from "./theme";
import { SceneView } from "./view/scene-view";

export async function startClashPage(): Promise<void> {
  const model = await readClashModel();
  const { report, facts } = model;
  const labels = report.scenes.map(({ label }) => label).join(", ");
  const summary = counted(model.findings.length, "finding");
  document.title = `${labels}: ${summary}`;
  get("title").textContent = labels;
  get("summary").textContent = `${counted(model.parts.length, "part")}, ${summary}`;
  const store = new Store(model, { isGrouped: report.groups.length > 0 });
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
  const all = commandsOfReport(store, view, list, filters, toggleHelp);
  new Toolbar(all, store, view);
  listenToKeys(all, store);
  fillHelp(all, aboutReport(model, lengths));
  followTheme((isDark) => view.setTheme(isDark));
  followAddress(store);
  Object.assign(window, { impinge: { store, view } }); // for tests
  document.body.dataset["ready"] = "";
}
