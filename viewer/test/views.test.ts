/** Pages about other things than clashes: two meshes, a hierarchy, and a robot. */
import assert from "node:assert/strict";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { paleTexts, unnamedControls } from "./access.js";
import { launch, open, PAGE, picture } from "./browser.js";

/** Pages of `cargo xtask viewer`, beside the page under test, with a pattern of their headings. */
const PAGES = {
  meet: /The meshes intersect: .* pairs of faces/,
  apart: /No intersection/,
  hierarchy: /Hierarchy of [\d ,]+ triangles/,
  configurations: /2 of 3 configurations collide/,
  path: /1 of 2 legs proved free/,
};

let browser: Browser;

before(async () => {
  browser = await launch();
});

after(() => browser.close());

function pathOf(name: keyof typeof PAGES): string {
  return join(dirname(PAGE), `${name}.html`);
}

/** Opens a page, does something with it, and expects that it made no request and printed nothing. */
async function visit(name: keyof typeof PAGES, look: (page: Page) => Promise<void>): Promise<void> {
  const { page, faults } = await open(browser, pathOf(name));
  await look(page);
  assert.deepEqual(faults, []);
  await page.close();
}

async function changes(page: Page, act: () => Promise<void>): Promise<boolean> {
  const old = await picture(page);
  await act();
  return !old.equals(await picture(page));
}

/** Moves the slider to a step. */
async function step(page: Page, at: number): Promise<void> {
  await page.locator("#step").fill(String(at));
}

for (const [name, heading] of Object.entries(PAGES) as [keyof typeof PAGES, RegExp][]) {
  test(`${name}: the answer is in words, and there is no list`, () =>
    visit(name, async (page) => {
      assert.match((await page.textContent("#details h2")) ?? "", heading);
      assert.ok(!(await page.locator("#clashes").isVisible()));
      assert.ok(!(await page.locator("#save-menu").isVisible()));
      assert.deepEqual(await unnamedControls(page), []);
    }));

  test(`${name}: keys turn, cut and measure`, () =>
    visit(name, async (page) => {
      await page.locator("#canvas").focus();
      assert.ok(await changes(page, () => page.keyboard.press("ArrowLeft")), "turn");
      assert.ok(await changes(page, () => page.keyboard.press("x")), "section");
      await page.keyboard.press("Escape");
      await page.keyboard.press("m");
      assert.ok(await page.locator("#measure-hint").isVisible());
      await page.keyboard.press("Escape");
      await page.keyboard.press("?");
      const keys = await page.locator("#help-keys kbd").allTextContents();
      assert.ok(keys.includes("f") && !keys.includes("/"), keys.join());
    }));
}

for (const colorScheme of ["light", "dark"] as const) {
  test(`texts have a contrast of 4.5 on ${colorScheme} pages`, async () => {
    for (const name of Object.keys(PAGES) as (keyof typeof PAGES)[]) {
      const { page } = await open(browser, pathOf(name), { colorScheme });
      const { checked, found } = await paleTexts(page);
      assert.ok(checked > 15, `${checked} texts`);
      assert.deepEqual(found, [], name);
      await page.close();
    }
  });
}

test("the page of two meshes shows curves, and hides a mesh", () =>
  visit("meet", async (page) => {
    assert.ok(await page.locator("#gap-label").isHidden());
    assert.match((await page.textContent("#details dl")) ?? "", /curves\d+ closed/);
    assert.ok(await changes(page, () => page.keyboard.press("h")));
    assert.ok(await changes(page, () => page.keyboard.press("h")));
  }));

test("the page of meshes that are apart shows their distance", () =>
  visit("apart", async (page) => {
    const label = (await page.textContent("#gap-label")) ?? "";
    assert.ok(await page.locator("#gap-label").isVisible());
    const [, shown] = /([\d.]+)/.exec(label) ?? [];
    assert.ok(((await page.textContent("#details dl")) ?? "").includes(`distance${shown}`), label);
  }));

test("the slider of a hierarchy shows its levels", () =>
  visit("hierarchy", async (page) => {
    await step(page, 0);
    assert.match((await page.textContent("#step-text")) ?? "", /level 0: 1 box$/);
    assert.ok(await changes(page, () => page.keyboard.press("n")));
    assert.match((await page.textContent("#step-text")) ?? "", /level 1: \d+ boxes/);
    assert.match((await page.textContent("#now")) ?? "", /^Level 1 of \d+\./);
    await page.locator("#step").focus();
    await page.keyboard.press("ArrowRight");
    assert.match((await page.textContent("#step-text")) ?? "", /level 2:/);
  }));

test("the page of configurations shows the pair that collides", () =>
  visit("configurations", async (page) => {
    await step(page, 0);
    assert.match((await page.textContent("#now")) ?? "", /^configuration 1: .* and .* collide/);
    assert.equal(await page.evaluate("window.impinge.store.now.selected.places.length"), 2);
    assert.ok(await changes(page, () => page.keyboard.press("n")));
    assert.match((await page.textContent("#now")) ?? "", /^configuration 2: /);
  }));

test("the slider of a path moves the robot, and its track has the proved part", () =>
  visit("path", async (page) => {
    const last = Number(await page.getAttribute("#step", "max"));
    assert.ok(last > 100, `${last}`);
    await step(page, 0);
    assert.match((await page.textContent("#now")) ?? "", /^leg 0, 0.0 %: proved free/);
    assert.equal(await page.evaluate("window.impinge.store.now.selected"), undefined);
    assert.ok(await changes(page, () => step(page, 60)));
    await step(page, last);
    assert.match((await page.textContent("#now")) ?? "", /^leg 1, 100.0 %: not proved/);
    const track = await page.evaluate(() => document.getElementById("step")?.style.getPropertyValue("--track") ?? "");
    assert.match(track, /--free\).*--collides\).*--open\)/);
  }));
