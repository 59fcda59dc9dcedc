/** The page for everybody: keyboard alone, labels, contrast. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import type { Browser } from "playwright-core";
import { paleTexts, unnamedControls } from "./access.js";
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
  assert.deepEqual(await unnamedControls(page), []);
  await page.close();
});

for (const colorScheme of ["light", "dark"] as const) {
  test(`texts have a contrast of 4.5 on a ${colorScheme} page`, async () => {
    const { page } = await open(browser, undefined, { colorScheme });
    await page.keyboard.press("n");
    await page.keyboard.press("x");
    const pale = await paleTexts(page);
    assert.ok(pale.checked > 40, `${pale.checked} texts`);
    assert.deepEqual(pale.found, []);
    await page.close();
  });
}
