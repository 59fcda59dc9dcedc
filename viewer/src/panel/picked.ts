/** The name of the part that was clicked in the view. */
import { get, make } from "../elements";
import type { Store } from "../state";
import { toggleHidden } from "./details";

export function showPicked(store: Store): void {
  const frame = get("picked");
  store.listen(({ picked }, changed) => {
    if (!changed.has("picked")) return;
    const part = picked === undefined ? undefined : store.model.parts[picked];
    frame.hidden = part === undefined;
    if (part === undefined || picked === undefined) return;
    const hide = make("button", { type: "button", class: "small" }, "Hide");
    hide.addEventListener("click", () => {
      toggleHidden(store, picked);
      store.set({ picked: undefined });
    });
    const found = store.model.findings.filter(({ places }) => places.includes(picked)).length;
    const only = make("button", { type: "button", class: "small", disabled: found === 0 }, `Its clashes (${found})`);
    only.addEventListener("click", () => store.set({ filter: { ...store.now.filter, part: picked } }));
    frame.replaceChildren(make("b", {}, part.name), make("span", { class: "meaning" }, part.type), hide, only);
  });
}
