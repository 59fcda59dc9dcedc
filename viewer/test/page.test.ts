/** What a person does with the page: select, look, filter, set statuses and save them. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { PageData } from "./blocks.js";
import { launch, open, PAGE, picture, selected, type Opened } from "./browser.js";

interface Row {
  id: string;
  kind: string;
  status: string;
  a: { name: string };
}

const report = JSON.parse(new PageData(PAGE).read("report").toString()) as { clashes: Row[]; duplicates: { id: string }[] };
const count = report.clashes.length + report.duplicates.length;

let browser: Browser;
let opened: Opened;
let page: Page;

before(async () => {
  browser = await launch();
  opened = await open(browser);
  page = opened.page;
});

after(() => browser.close());

/** Presses a key, and expects that the view changes or not. */
async function press(key: string, changes: boolean): Promise<void> {
  const old = await picture(page);
  await page.keyboard.press(key);
  assert.equal(!old.equals(await picture(page)), changes, `the picture after ${key}`);
}

async function shown(): Promise<string> {
  return (await page.textContent("#shown")) ?? "";
}

function digits(text: string): number[] {
  return (text.replace(/\u202f/g, "").match(/\d+/g) ?? []).map(Number);
}

test("the list has every clash", async () => {
  assert.deepEqual(digits(await shown()), [count, count]);
  assert.ok((await page.locator("#list .line").count()) > 2);
});

test("a click selects a clash, and its address and numbers appear", async () => {
  await page.locator("#list .item").first().click();
  const id = await selected(page);
  assert.ok(id !== undefined);
  assert.equal(await page.evaluate(() => location.hash), `#${id}`);
  assert.equal(await page.textContent("#details code"), id);
  assert.match((await page.textContent("#details h2")) ?? "", /(enters|touches|lies inside|away from|shape)/);
});

test("n and p go forth and back", async () => {
  const first = await selected(page);
  await page.keyboard.press("n");
  assert.notEqual(await selected(page), first);
  await page.keyboard.press("p");
  assert.equal(await selected(page), first);
});

test("an address selects its clash", async () => {
  const { id } = report.clashes[report.clashes.length - 1];
  await page.evaluate((hash) => (location.hash = hash), id);
  await page.waitForFunction((hash) => document.querySelector("#details code")?.textContent === hash, id);
  assert.equal(await selected(page), id);
  const { id: worst } = report.clashes[0];
  await page.evaluate((hash) => (location.hash = hash), worst);
  await page.waitForFunction((hash) => document.querySelector("#details code")?.textContent === hash, worst);
});

test("a picture at rest stays", async () => {
  assert.ok((await picture(page)).equals(await picture(page)));
});

test("ghosts, isolation, hiding and fitting change the picture", async () => {
  await press("g", true);
  await press("g", true);
  await press("i", true);
  await press("h", true);
  await press("h", true);
  await press("i", true);
  await press("f", true);
  await press("f", true);
  await press("f", true);
});

test("a section cuts the view open, and its slider moves it", async () => {
  await press("x", true);
  const old = await picture(page);
  await page.locator("#section-offset").fill("0.5");
  assert.ok(!old.equals(await picture(page)));
  await press("X", true);
  await press("x", true);
});

test("two clicks measure a distance", async () => {
  await page.keyboard.press("i");
  await page.keyboard.press("m");
  assert.ok(await page.locator("#measure-hint").isVisible());
  const frame = await page.locator("#canvas").boundingBox();
  assert.ok(frame !== null);
  const spots: [number, number][] = [];
  for (let down = 1; down < 12; down++) for (let right = 1; right < 12; right++) spots.push([right / 12, down / 12]);
  for (const [right, down] of spots) {
    await page.mouse.click(frame.x + right * frame.width, frame.y + down * frame.height);
    if (await page.locator("#measure-label").isVisible()) break;
  }
  assert.match((await page.textContent("#measure-label")) ?? "", /\d.*x \d.*y \d.*z \d/s);
  await page.keyboard.press("m");
  assert.ok(!(await page.locator("#measure-label").isVisible()));
  await page.keyboard.press("i");
});

test("a search keeps the clashes that contain all words", async () => {
  await page.keyboard.press("/");
  const { id } = report.clashes[0];
  await page.keyboard.type(id.toUpperCase());
  assert.deepEqual(digits(await shown()), [1, count]);
  await page.locator("#search").fill("no such part");
  assert.ok(await page.locator("#list-empty").isVisible());
  await page.click("#clear-filters");
  assert.deepEqual(digits(await shown()), [count, count]);
});

test("a filter leaves out a kind", async () => {
  const { kind } = report.clashes[0];
  const others = count - report.clashes.filter((row) => row.kind === kind).length;
  await page.click(`#kinds [data-value="${kind}"]`);
  assert.equal(digits(await shown())[0], others);
  await page.click(`#kinds [data-value="${kind}"]`);
  await page.locator("#min-depth").fill("100");
  assert.ok(digits(await shown())[0] < count);
  await page.click("#clear-filters");
});

test("groups fold and unfold", async () => {
  await page.locator("#list .head").first().click();
  const heads = await page.locator('#list .head[aria-expanded="false"]').count();
  await page.locator("#list .head").first().click();
  assert.notEqual(await page.locator('#list .head[aria-expanded="false"]').count(), heads);
  await page.uncheck("#grouped");
  assert.equal(await page.locator("#list .head").count(), 0);
  await page.check("#grouped");
});

async function download(button: string): Promise<string> {
  await page.click("#save-menu summary");
  const [file] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  return readFileSync(await file.path(), "utf8");
}

test("statuses are saved as an accept file and as a report", async () => {
  const { id } = report.clashes[0];
  await page.evaluate((hash) => (location.hash = hash), id);
  await page.waitForFunction((hash) => document.querySelector("#details code")?.textContent === hash, id);
  await page.locator("#canvas").focus();
  await page.keyboard.press("4");
  assert.ok(await page.locator("#status-approved").isChecked());
  await page.locator("#note").fill('agreed, "for now"');
  await page.locator("#note").press("Tab");
  assert.match((await page.textContent("#unsaved")) ?? "", /not saved/);
  const accepted = await download("#save-accept");
  assert.ok(accepted.includes(`[[accept]]\nid = "${id}"\n`), accepted);
  assert.ok(accepted.endsWith('note = "agreed, \\"for now\\""\n'), accepted);
  const saved = JSON.parse(await download("#save-report")) as { clashes: (Row & { note?: string })[] };
  assert.deepEqual([saved.clashes[0].status, saved.clashes[0].note], ["approved", 'agreed, "for now"']);
  assert.equal(saved.clashes.length, report.clashes.length);
  assert.equal(await page.textContent("#unsaved"), "");
});

test("the help sheet lists every key", async () => {
  await page.keyboard.press("?");
  const keys = await page.locator("#help-keys kbd").allTextContents();
  for (const key of "npgihxmf12345/?") assert.ok(keys.includes(key), key);
  await page.keyboard.press("Escape");
  assert.ok(!(await page.locator("#help").isVisible()));
});

test("the view turns", async (context) => {
  const pictures = await page.evaluate<number>("window.impinge.view.benchmark(2000)");
  assert.ok(pictures > 0);
  context.diagnostic(`${pictures / 2} pictures a second without a graphics card`);
});

test("the page made no request, and printed nothing", () => {
  assert.deepEqual(opened.faults, []);
});
