/** A headless Chromium, and a page in it that records everything that a page must not do. */
import { chromium, type Browser, type BrowserContextOptions, type Page } from "playwright-core";

/** The page under test: any page that `impinge clash --view` wrote for a model with several clashes. */
export const PAGE = required("IMPINGE_PAGE");

/** Time to wait for anything, in milliseconds. A busy machine draws a picture in some seconds. */
const PATIENCE = 120_000;

export function required(name: string): string {
  const value = process.env[name];
  if (value === undefined) throw new Error(`Set ${name}. cargo xtask viewer does so.`);
  return value;
}

export function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: required("CHROMIUM"),
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
}

export interface Opened {
  page: Page;
  /** Requests, errors and warnings of the page. All must stay empty. */
  faults: string[];
}

/** Opens a page from the disk, without motion so that its state can be compared. */
export async function open(browser: Browser, path = PAGE, options: BrowserContextOptions = {}): Promise<Opened> {
  const page = await browser.newPage({ viewport: { width: 1200, height: 760 }, reducedMotion: "reduce", ...options });
  const faults: string[] = [];
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url()) || faults.length > 0) faults.push(`request ${request.url()}`);
  });
  page.on("console", (message) => {
    if (!/GPU stall due to ReadPixels/.test(message.text())) faults.push(`console ${message.text()}`);
  });
  page.on("pageerror", (error) => faults.push(`error ${error.message}`));
  page.setDefaultTimeout(PATIENCE);
  await page.goto(`file://${path}`);
  await page.waitForSelector("body[data-ready]");
  return { page, faults };
}

/** What the page shows to tests. */
interface Viewed {
  impinge: { view: { isAtRest: boolean } };
}

/** Leaves the canvas alone, so that its picture does not have the buttons over it. */
const CANVAS_ALONE = "#view > :not(canvas) { visibility: hidden !important } #canvas { outline: none !important }";

/** Waits until the view is at rest, and returns its picture. */
export async function picture(page: Page): Promise<Buffer> {
  await page.waitForTimeout(50);
  await page.waitForFunction(() => (window as unknown as Viewed).impinge.view.isAtRest);
  return page.locator("#canvas").screenshot({ style: CANVAS_ALONE });
}

/** Returns the identity of the selected clash. */
export function selected(page: Page): Promise<string | undefined> {
  return page.evaluate("window.impinge.store.now.selected?.id");
}
