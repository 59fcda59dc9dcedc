/** The buttons below the view. */
import { get, make } from "../elements";
import type { Command } from "../commands";
import type { SectionAxis, State, Store } from "../state";
import type { SceneView } from "../view/scene-view";

export class Toolbar {
  private readonly buttons: { command: Command; button: HTMLButtonElement }[];

  constructor(commands: readonly Command[], store: Store, view: SceneView) {
    this.buttons = commands
      .filter(({ button }) => button !== undefined)
      .map((command) => {
        const label = command.button ?? "";
        const button = make("button", { type: "button", title: command.does }, label, make("kbd", { "aria-hidden": "true" }, command.key));
        button.addEventListener("click", () => command.run());
        return { command, button };
      });
    get("toolbar").append(...this.buttons.map(({ button }) => button));
    for (const input of get("section-axes").querySelectorAll("input")) {
      input.addEventListener("change", () => store.set({ section: input.value as SectionAxis }));
    }
    const offset = get<HTMLInputElement>("section-offset");
    offset.addEventListener("input", () => view.moveSection(Number(offset.value)));
    store.listen((state, changed) => {
      if (changed.has("selected")) offset.value = "0";
      this.show(state);
    });
    this.show(store.now);
  }

  private show(state: Readonly<State>): void {
    for (const { command, button } of this.buttons) {
      if (command.isOn !== undefined) button.setAttribute("aria-pressed", String(command.isOn(state)));
      button.disabled = command.needsClash === true && state.selected === undefined;
    }
    get("section-tools").hidden = state.section === undefined;
    for (const input of get("section-axes").querySelectorAll("input")) input.checked = input.value === state.section;
    get("measure-hint").hidden = !state.isMeasuring;
  }
}
