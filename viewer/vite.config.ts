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

/** Puts the licenses of the libraries into the page, which they require. */
function licenses(): Plugin {
  return {
    name: "licenses",
    apply: "build",
    transformIndexHtml(html) {
      const { dependencies } = JSON.parse(readFileSync("package.json", "utf8")) as { dependencies: Record<string, string> };
      const texts = Object.entries(dependencies).map(([name, version]) => {
        return `${name} ${version}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}`;
      });
      return html.replace("<head>", () => `<head>\n    <!--\nThis page contains:\n\n${texts.join("\n\n")}\n    -->`);
    },
  };
}

export default defineConfig({
  plugins: [sampleData(), licenses(), viteSingleFile({ removeViteModuleLoader: true })],
  build: {
    target: "es2022",
    modulePreload: false,
    outDir: "out/page",
  },
});
