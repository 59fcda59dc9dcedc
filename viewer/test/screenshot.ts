/**
 * Makes a picture of a page for the documentation, as `docs/images/draw.py` runs it:
 *
 *     IMPINGE_PAGE=/tmp/page.html CHROMIUM=/usr/bin/chromium npm run screenshot -- OUT.png KEY ...
 *
 * The keys are pressed one after the other. The variable SCHEME is `dark` for a dark page.
 */
import { launch, open, picture } from "./browser.js";

const [, , path, ...keys] = process.argv;
const browser = await launch();
const colorScheme = process.env["SCHEME"] === "dark" ? "dark" : "light";
const { page } = await open(browser, undefined, { viewport: { width: 1280, height: 720 }, colorScheme });
for (const key of keys) await page.keyboard.press(key);
await picture(page); // a slow machine draws the fine picture last
await page.screenshot({ path });
await browser.close();
