/** The menu that saves statuses. */
import type { ClashModel } from "../data/model";
import { acceptFile, reportFile, save } from "../data/downloads";
import { get } from "../elements";
import type { Store } from "../state";

export function saveMenu(store: Store<ClashModel>): void {
  const menu = get<HTMLDetailsElement>("save-menu");
  const done = () => {
    menu.open = false;
    store.set({ unsaved: 0 });
  };
  get("save-accept").addEventListener("click", () => {
    save("accept.toml", acceptFile(store.model), "application/toml");
    done();
  });
  get("save-report").addEventListener("click", () => {
    save("report.json", reportFile(store.model), "application/json");
    done();
  });
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape") menu.open = false;
  });
  document.addEventListener("click", (event) => {
    if (!menu.contains(event.target as Node)) menu.open = false;
  });
  store.listen(({ unsaved }, changed) => {
    if (changed.has("unsaved")) get("unsaved").textContent = unsaved === 0 ? "" : `${unsaved} not saved`;
  });
  addEventListener("beforeunload", (event) => {
    if (store.now.unsaved > 0) event.preventDefault();
  });
}
