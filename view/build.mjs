// One file of HTML with everything in it. `node build.mjs OUT.html [FOLDER]`: with the simulator's module from FOLDER.

import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join, resolve } from "node:path";

const [out, folder] = process.argv.slice(2);
if (!out) {
  console.error("usage: node build.mjs OUT.html [FOLDER OF simulation.js AND simulation_bg.wasm]");
  process.exit(2);
}
const here = import.meta.dirname;
const { outputFiles } = await build({
  entryPoints: [join(here, "src/main.ts")],
  bundle: true,
  minify: true,
  write: false,
  format: "iife",
  target: "es2022",
  legalComments: "inline",
  charset: "utf8",
  absWorkingDir: here,
  alias: { simulation: folder ? resolve(folder, "simulation.js") : join(here, "src/no-simulation.ts") },
  // The module comes with the page: nobody asks where the script was.
  define: { "import.meta.url": '""' },
});
const plot = await readFile(join(here, "node_modules/uplot/dist/uPlot.min.css"), "utf8");
const style = await readFile(join(here, "src/style.css"), "utf8");
const module = folder ? await readFile(join(folder, "simulation_bg.wasm")) : null;
const wasm = module ? `<script id="wasm" type="text/plain">${module.toString("base64")}</script>` : "";
let html = await readFile(join(here, "src/index.html"), "utf8");
// As functions: a replacement text would have its dollars read.
html = html.replace("/*CSS*/", () => plot.trim() + "\n" + style);
html = html.replace("<!--WASM-->", () => wasm);
html = html.replace("/*JS*/", () => outputFiles[0].text.trim());
await mkdir(dirname(resolve(out)), { recursive: true });
await writeFile(out, html);
