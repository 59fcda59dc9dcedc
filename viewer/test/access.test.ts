/** The page for everybody: keyboard alone, labels, contrast. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import type { Browser } from "playwright-core";
import { launch, open, selected } from "./browser.js";

let browser: Browser;

before(async () => {
  browser = await launch();
});

after(() => browser.close());

test("the keyboard alone reaches the list, the view and the statuses", async () => {
  const { page } = await open(browser);
  const reach = async (id: string) => {
    for (let presses = 0; presses < 80; presses++) {
      if ((await page.evaluate(() => document.activeElement?.id)) === id) return;
      await page.keyboard.press("Tab");
    }
    assert.fail(`Tab does not reach ${id}`);
  };
  await reach("list");
  for (let presses = 0; presses < 3; presses++) {
    await page.keyboard.press("ArrowDown");
    await page.keyboard.press("ArrowRight");
  }
  const first = await selected(page);
  assert.ok(first !== undefined);
  await page.keyboard.press("ArrowDown");
  assert.notEqual(await selected(page), first);
  await reach("canvas");
  const yaw = () => page.evaluate("window.impinge.view.toCamera.x");
  const old = await yaw();
  await page.keyboard.press("ArrowLeft");
  await page.waitForTimeout(100);
  assert.notEqual(await yaw(), old);
  await reach("status-new");
  await page.keyboard.press("ArrowRight");
  assert.ok(await page.locator("#status-active").isChecked());
  await page.close();
});

test("every control has a name", async () => {
  const { page } = await open(browser);
  await page.keyboard.press("n");
  await page.keyboard.press("x");
  const unnamed = await page.evaluate(() => {
    const controls = [...document.querySelectorAll<HTMLElement>("button, input, select, summary, [tabindex='0']")];
    const name = (element: HTMLElement) =>
      element.getAttribute("aria-label") ?? (element as HTMLInputElement).labels?.[0]?.textContent ?? element.textContent ?? "";
    return controls.filter((element) => name(element).trim() === "" && !element.hidden).map((element) => element.outerHTML);
  });
  assert.deepEqual(unnamed, []);
  await page.close();
});

for (const colorScheme of ["light", "dark"] as const) {
  test(`texts have a contrast of 4.5 on a ${colorScheme} page`, async () => {
    const { page } = await open(browser, undefined, { colorScheme });
    await page.keyboard.press("n");
    await page.keyboard.press("x");
    const pale = await page.evaluate(paleTexts);
    assert.ok(pale.checked > 40, `${pale.checked} texts`);
    assert.deepEqual(pale.found, []);
    await page.close();
  });
}

/** Returns the texts whose contrast with their background is below 4.5. It runs in the page. */
function paleTexts(): { checked: number; found: string[] } {
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
