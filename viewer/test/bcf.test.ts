/** The BCF file that the page saves: that of the command, with the statuses of the page. */
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { strFromU8, unzipSync, type Unzipped } from "fflate";
import type { Browser, Page } from "playwright-core";
import { launch, open, PAGE, required } from "./browser.js";

/** The file that the command wrote beside the page. */
const COMMAND_FILE = PAGE.replace(/html$/, "bcfzip");
/** The question whose answer the page shows. */
const QUESTION = ["clash", "../data/cad_cycloidal_gearbox.glb", "--rules", "test/pins.toml"];

interface Row {
  id: string;
  status: string;
}

let browser: Browser;
let page: Page;
let faults: string[];

before(async () => {
  browser = await launch();
  ({ page, faults } = await open(browser));
});

after(() => browser.close());

/** Saves the file from the page under a name, and returns its path. */
async function save(name: string): Promise<string> {
  await page.click("#save-menu summary");
  const [file] = await Promise.all([page.waitForEvent("download"), page.click("#save-bcf")]);
  assert.equal(file.suggestedFilename(), "clashes.bcfzip");
  const path = join(dirname(PAGE), name);
  await file.saveAs(path);
  return path;
}

function files(path: string): Unzipped {
  return unzipSync(readFileSync(path));
}

/** Returns a document without differences that have no meaning: spaces, quotes, forms of empty elements, and of numbers. */
function plain(bytes: Uint8Array): string {
  const text = strFromU8(bytes).replace(/>\s+</g, "><").replace(/<(\w+)([^<>]*)><\/\1>/g, "<$1$2/>").replace(/\s+$/, "").replaceAll("&apos;", "'").replaceAll("&quot;", '"');
  return text.replace(/<(CreationDate|Date)>[^<]*</g, "<$1><").replace(/(?<=(?:depth|gap|to|at least|at) )[\d.]+(?:e-?\d+)?/g, (number) => String(Number(number)));
}

/** Returns a viewpoint without its camera, which the page places in its own way. */
function components(bytes: Uint8Array): string {
  return plain(bytes).replace(/<Camera(ViewPoint|Direction|UpVector)>.*?<\/Camera\1>/g, "");
}

test("without edits, the topics are those of the command", async () => {
  const [own, expected] = [files(await save("page.bcfzip")), files(COMMAND_FILE)];
  assert.deepEqual(Object.keys(own).sort(), Object.keys(expected).sort());
  const markups = Object.keys(own).filter((name) => name.endsWith("/markup.bcf"));
  assert.ok(markups.length > 1, `${markups.length} topics`);
  for (const name of markups) {
    assert.equal(plain(own[name]), plain(expected[name]));
    const viewpoint = name.replace("markup.bcf", "viewpoint.bcfv");
    assert.equal(components(own[viewpoint]), components(expected[viewpoint]));
    const picture = own[name.replace("markup.bcf", "snapshot.png")];
    const size = [16, 20].map((at) => Buffer.from(picture).readUInt32BE(at));
    assert.deepEqual(size, [800, 600]);
    assert.ok(picture.length > 5000, `a picture of ${picture.length} bytes has nothing in it`);
  }
  for (const name of ["bcf.version", "project.bcfp"]) assert.equal(plain(own[name]), plain(expected[name]));
});

test("the command reads the statuses of the page", async () => {
  const ids = await page.evaluate<string[]>("window.impinge.store.model.report.clashes.map(({ id }) => id)");
  const statuses = ["approved", "reviewed", "resolved"];
  for (const [at, status] of statuses.entries()) {
    await page.evaluate((hash) => (location.hash = hash), ids[at]);
    await page.waitForFunction((hash) => document.querySelector("#details code")?.textContent === hash, ids[at]);
    await page.check(`#status-${status}`);
  }
  await page.locator("#note").fill("<seen> & \"agreed\"");
  await page.locator("#note").press("Tab");
  assert.match((await page.textContent("#unsaved")) ?? "", /not saved/);
  const path = await save("edited.bcfzip");
  await page.waitForFunction(() => document.getElementById("unsaved")?.textContent === "");
  const texts = Object.entries(files(path)).filter(([name]) => name.endsWith("markup.bcf")).map(([, bytes]) => strFromU8(bytes));
  assert.ok(texts.some((text) => text.includes(`${ids[2]}: &lt;seen&gt; &amp; &quot;agreed&quot;`)));
  const read = (previous: string): Map<string, string> => {
    const { stdout } = spawnSync(required("IMPINGE"), [...QUESTION, "--previous", previous, "--json"], { encoding: "utf8" });
    const report = JSON.parse(stdout) as { clashes: Row[]; gone: unknown[] };
    assert.equal(report.gone.length, 0);
    return new Map(report.clashes.map(({ id, status }) => [id, status]));
  };
  const found = read(path);
  // A clash that is resolved and still exists is active.
  assert.deepEqual(ids.slice(0, 3).map((id) => found.get(id)), ["approved", "reviewed", "active"]);
  const unedited = read(COMMAND_FILE);
  assert.deepEqual(ids.slice(3).map((id) => found.get(id)), ids.slice(3).map((id) => unedited.get(id)));
});

test("saving made no request, and printed nothing", () => {
  assert.deepEqual(faults, []);
});
