/**
 * Makes the picture of the page for the documentation, from the root of the repository:
 *
 *     impinge clash data/cad_cycloidal_gearbox.glb --view /tmp/gearbox.html
 *     cd viewer && IMPINGE_PAGE=/tmp/gearbox.html CHROMIUM=/usr/bin/chromium npm run screenshot
 *
 * An argument of the script is the identity of another clash.
 */
import { launch, open, picture } from "./browser.js";

/** The picture, relative to the folder of the sources. */
const PICTURE = "../docs/images/clash-page.png";

const browser = await launch();
const { page } = await open(browser, undefined, { viewport: { width: 1280, height: 720 } });
const [, , clash] = process.argv;
if (clash === undefined) await page.keyboard.press("n");
else await page.evaluate((id) => (location.hash = id), clash);
await picture(page); // a slow machine draws the fine picture last
await page.screenshot({ path: PICTURE });
await browser.close();
