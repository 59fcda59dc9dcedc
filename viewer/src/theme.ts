/** Light or dark: as the system says, until the person chooses. */
import { get } from "./elements";

/** Calls `show` now and after each change. */
export function followTheme(show: (isDark: boolean) => void): void {
  const system = matchMedia("(prefers-color-scheme: dark)");
  let chosen: boolean | undefined;
  const apply = () => {
    const isDark = chosen ?? system.matches;
    document.documentElement.dataset["theme"] = isDark ? "dark" : "light";
    show(isDark);
  };
  system.addEventListener("change", apply);
  get("theme").addEventListener("click", () => {
    chosen = !(chosen ?? system.matches);
    apply();
  });
  apply();
}
