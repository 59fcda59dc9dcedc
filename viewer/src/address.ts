/** The address of a clash: its identity after the # of the page's address. */
import type { ClashModel } from "./data/model";
import type { Store } from "./state";

export function followAddress(store: Store<ClashModel>): void {
  const read = () => {
    const finding = store.model.byId.get(decodeURIComponent(location.hash.slice(1)));
    if (finding !== store.now.selected) store.select(finding);
  };
  addEventListener("hashchange", read);
  store.listen(({ selected }, changed) => {
    // A page inside a notebook has no address.
    if (changed.has("selected") && location.protocol !== "about:") history.replaceState(null, "", selected === undefined ? "#" : `#${selected.id}`);
  });
  read();
}
