import { readFileSync } from "node:fs";
import { defineConfig, type Plugin } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

/** The place of the data in the page, which the Rust crate fills. */
const MARK = "<!--data-->";

/** Puts the data of a page that impinge wrote (IMPINGE_PAGE=page.html vite) into the page that is developed. */
function sampleData(): Plugin {
  return {
    name: "sample-data",
    apply: "serve",
    transformIndexHtml(html) {
      const page = process.env["IMPINGE_PAGE"];
      if (page === undefined) return html;
      const blocks = readFileSync(page, "utf8").match(/<script type="application\/octet-stream"[^]*?<\/script>/g);
      const open = html.replace(/<meta\s+http-equiv="Content-Security-Policy"[^>]*>/, ""); // the server sends the scripts
      return open.replace(MARK, () => (blocks ?? []).join("\n"));
    },
  };
}

export default defineConfig({
  plugins: [sampleData(), viteSingleFile({ removeViteModuleLoader: true })],
  build: {
    target: "es2022",
    modulePreload: false,
    outDir: "out/page",
  },
});
