/** A report of 100,000 clashes: the list stays short in the document, and its ends can be reached. */
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import type { Browser } from "playwright-core";
import { PageData } from "./blocks.js";
import { launch, open, PAGE, selected } from "./browser.js";

interface Report {
  clashes: { id: string }[];
  duplicates: unknown[];
  groups: { sentence: string; clashes: string[] }[];
}

/** Writes a page that has the clashes of the page under test again and again. */
function longPage(folder: string, clashes: number): string {
  const data = new PageData(PAGE);
  const report = JSON.parse(data.read("report").toString()) as Report;
  const facts = JSON.parse(data.read("facts").toString()) as { sentences: string[] };
  const known = report.clashes;
  const sentences = facts.sentences.slice(0, known.length);
  const sets = facts.sentences.slice(known.length);
  report.clashes = Array.from({ length: clashes }, (_, at) => ({ ...known[at % known.length], id: `c-${at}` }));
  facts.sentences = [...report.clashes.map((_, at) => sentences[at % known.length]), ...sets];
  report.groups = Array.from({ length: clashes / 100 }, (_, group) => ({
    sentence: `group ${group}`,
    clashes: Array.from({ length: 100 }, (_, at) => `c-${100 * group + at}`),
  }));
  data.write("report", Buffer.from(JSON.stringify(report)));
  data.write("facts", Buffer.from(JSON.stringify(facts)));
  const path = join(folder, `${clashes}.html`);
  writeFileSync(path, data.toString());
  return path;
}

let browser: Browser;
const folder = mkdtempSync(join(tmpdir(), "impinge-viewer-"));

before(async () => {
  browser = await launch();
});

after(async () => {
  await browser.close();
  rmSync(folder, { recursive: true });
});

for (const clashes of [10_000, 100_000]) {
  test(`${clashes} clashes are listed`, async (context) => {
    const { page, faults } = await open(browser, longPage(folder, clashes));
    const ready = await page.evaluate(() => performance.getEntriesByName("list-ready")[0].startTime);
    context.diagnostic(`the list of ${clashes} clashes was ready after ${Math.round(ready)} ms`);
    await page.uncheck("#grouped");
    assert.ok((await page.locator("#list .line").count()) < 100);
    await page.locator("#list").focus();
    await page.keyboard.press("End");
    assert.equal(await selected(page), `c-${clashes - 1}`);
    assert.ok(await page.locator("#list .line.selected").isVisible());
    await page.keyboard.press("Home");
    assert.ok((await selected(page)) !== `c-${clashes - 1}`);
    assert.deepEqual(faults, []);
    await page.close();
  });
}
