/** The menu that saves statuses. */
import type { ClashModel } from "../data/model";
import { acceptFile, reportFile, save } from "../data/downloads";
import { counted, get } from "../elements";
import type { Store } from "../state";
import { saveBcf } from "./save-bcf";

export function saveMenu(store: Store<ClashModel>): void {
  const menu = get<HTMLDetailsElement>("save-menu");
  const state = get("unsaved");
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
  const { bcf } = store.model.facts;
  if (bcf !== undefined) {
    const button = get<HTMLButtonElement>("save-bcf");
    button.hidden = false;
    button.addEventListener("click", async () => {
      menu.open = false;
      button.disabled = true;
      const { unsaved } = store.now;
      try {
        await saveBcf(store.model, bcf, (ready) => (state.textContent = `${ready} of ${counted(bcf.topics.length, "topic")}`));
        // What was edited meanwhile may be missing in the file.
        store.set({ unsaved: store.now.unsaved - unsaved });
        state.textContent = unsavedText(store.now.unsaved);
      } catch (error) {
        state.textContent = `No BCF file: ${error instanceof Error ? error.message : String(error)}`;
      }
      button.disabled = false;
    });
  }
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape") menu.open = false;
  });
  document.addEventListener("click", (event) => {
    if (!menu.contains(event.target as Node)) menu.open = false;
  });
  store.listen(({ unsaved }, changed) => {
    if (changed.has("unsaved")) state.textContent = unsavedText(unsaved);
  });
  addEventListener("beforeunload", (event) => {
    if (store.now.unsaved > 0) event.preventDefault();
  });
}

function unsavedText(unsaved: number): string {
  return unsaved === 0 ? "" : `${unsaved} not saved`;
}
