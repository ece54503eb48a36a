// Bundles src/ into one HTML file with slots for `weir chart`: node build.mjs --modules node_modules --out chart.html
// Scripts are allowed by their hash alone, and nothing may be fetched: whatever a bench file holds, it can't run.
import { createHash } from "node:crypto";
import { existsSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, relative, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

const here = dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({ options: { modules: { type: "string" }, out: { type: "string" } } });
if (!values.modules || !values.out) throw new Error("usage: build.mjs --modules FOLDER --out FILE");
const modules = resolve(values.modules);
const esbuild = createRequire(join(modules, "x"))("esbuild");

const bundle = (entry) =>
  esbuild.build({
    entryPoints: [join(here, "src", entry)],
    absWorkingDir: here,
    nodePaths: [modules],
    bundle: true,
    minify: true,
    write: false,
    metafile: true,
    charset: "utf8",
    format: "iife",
    target: ["chrome109", "firefox115", "safari16"],
    legalComments: "none",  // every licence as a whole, below
  });

/** Name, version and licence of every package that is in the bundle. */
function licences(metafile) {
  const folders = new Set();
  for (const input of Object.keys(metafile.inputs)) {
    const path = resolve(here, input);
    if (!path.startsWith(modules)) continue;
    const parts = relative(modules, path).split("/");
    const last = parts.lastIndexOf("node_modules") + 1;
    folders.add(join(modules, ...parts.slice(0, last + (parts[last].startsWith("@") ? 2 : 1))));
  }
  return [...folders].sort().map((folder) => {
    const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    const file = ["LICENSE", "LICENSE.md", "LICENSE.txt", "LICENCE", "license"].map((name) => join(folder, name)).find(existsSync);
    return `${about.name} ${about.version} (${about.license})\n\n${file ? readFileSync(file, "utf8").trim() : ""}`;
  });
}

const script = await bundle("main.js");
const style = await bundle("style.css");
const code = script.outputFiles[0].text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const hash = createHash("sha256").update(code).digest("base64");
const notices = licences(script.metafile).join("\n\n---\n\n").replaceAll("--", "- -").replaceAll(">", "›");
const parts = { hash, style: style.outputFiles[0].text.replaceAll("</style", "<\\/style"), script: code, licences: notices };
const page = readFileSync(join(here, "src", "page.html"), "utf8").replace(/<!--build:(\w+)-->|%(hash)%/g, (_, a, b) => parts[a ?? b]);
writeFileSync(values.out + ".tmp", page);
renameSync(values.out + ".tmp", values.out);
console.log(`${values.out}: ${Math.round(page.length / 1024)} KiB`);
