/** What keeps people from using a page: controls without a name, and pale texts. */
import type { Page } from "playwright-core";

/** Returns the controls that have no name. */
export function unnamedControls(page: Page): Promise<string[]> {
  return page.evaluate(() => {
    const controls = [...document.querySelectorAll<HTMLElement>("button, input, select, summary, [tabindex='0']")];
    const name = (element: HTMLElement) =>
      element.getAttribute("aria-label") ?? (element as HTMLInputElement).labels?.[0]?.textContent ?? element.textContent ?? "";
    const isShown = (element: HTMLElement) => element.checkVisibility();
    return controls.filter((element) => name(element).trim() === "" && isShown(element)).map((element) => element.outerHTML);
  });
}

export function paleTexts(page: Page): Promise<{ checked: number; found: string[] }> {
  return page.evaluate(findPaleTexts);
}

/** Returns the texts whose contrast with their background is below 4.5. It runs in the page. */
function findPaleTexts(): { checked: number; found: string[] } {
  const channels = (color: string) => (color.match(/[\d.]+/g) ?? []).map(Number);
  const light = (color: string) => {
    const [r, g, b] = channels(color).map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const background = (element: Element | null): string => {
    if (element === null) return "rgb(255, 255, 255)";
    const color = getComputedStyle(element).backgroundColor;
    return channels(color)[3] === 0 ? background(element.parentElement) : color;
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const found: string[] = [];
  let checked = 0;
  for (let node = walker.nextNode(); node !== null; node = walker.nextNode()) {
    const element = node.parentElement;
    if (element === null || (node.textContent ?? "").trim() === "" || !element.checkVisibility() || element.closest(":disabled, script") !== null) continue;
    const [a, b] = [light(getComputedStyle(element).color), light(background(element))];
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    checked++;
    if (contrast < 4.5) found.push(`${contrast.toFixed(2)} ${element.className} ${node.textContent ?? ""}`);
  }
  return { checked, found };
}
