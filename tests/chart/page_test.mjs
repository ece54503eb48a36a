// The page as a browser sees it: node page_test.mjs --weir PROGRAM --modules NODE_MODULES --python PYTHON
// Headless Chromium, offline, with a made-up bench file. Exit status 77: no Chromium here.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { delimiter, dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { parseArgs } from "node:util";
import { paretoFront } from "../../tools/chart/src/pareto.js";

const { values: options } = parseArgs({ options: { weir: { type: "string" }, modules: { type: "string" }, python: { type: "string" } } });
const chromiumPath = process.env.PATH.split(delimiter).flatMap((folder) => ["chromium", "chromium-browser", "google-chrome"].map((name) => join(folder, name))).find(existsSync);
if (!chromiumPath) {
  console.error("SKIPPED: no chromium on the PATH (tools/install-deps.sh installs it); the chart page was not tested");
  process.exit(77);
}
const { chromium } = createRequire(resolve(options.modules, "x"))("playwright-core");
const here = dirname(fileURLToPath(import.meta.url)), folder = mkdtempSync(join(tmpdir(), "weir-chart-"));

const bench = join(folder, "made_up.json"), html = join(folder, "report.html"), svg = join(folder, "chart.svg");
const perScene = 32;
execFileSync(options.python, [join(here, "make_fixture.py"), bench, "--per-scene", String(perScene), "--pictures", "6", "--side", "32"]);
execFileSync(options.weir, ["chart", bench, "--out", html, "--svg", svg, "--title", "Made-up <b>title</b>"]);
const data = JSON.parse(readFileSync(bench, "utf8")).configurations;
/** Of the first scene, which is shown at first, those that have an error above zero. */
const plotted = data.slice(0, perScene).filter((c) => c.error?.relmse.median.value > 0);

const browser = await chromium.launch({ executablePath: chromiumPath, args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
const complaints = [];
async function open(settings = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, offline: true, acceptDownloads: true, ...settings });
  const page = await context.newPage();
  page.setDefaultTimeout(20000);
  page.on("console", (message) => complaints.push(`console ${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(`error: ${error.message}`));
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || complaints.push(`request of ${request.url()}`));
  await page.goto(pathToFileURL(html).href);
  return page;
}
const points = (page) => page.locator("#chart .point").count();
const rows = (page) => page.locator("#table tbody tr").count();

const tests = {
  async "points, front and bars are those of the file"(page) {
    assert.equal(await points(page), plotted.length);
    const on = paretoFront(plotted.map((c) => ({ x: c.frame.gpu_ms.median, y: c.error.relmse.median.value }))).filter(Boolean).length;
    assert.equal(await page.locator("#chart .point[data-front]").count(), on);
    assert.equal(await page.locator("#chart .bar line").count(), 2 * plotted.length);
    assert.match(await page.locator("#caption").textContent(), new RegExp(`^${plotted.length} configurations, ${on} on the .*2 more have no such figure`));
    assert.equal(await rows(page), perScene);
  },
  async "points lie where their figures are"(page) {
    const [a, b] = [plotted[0], plotted[5]];
    const where = async (c) => {
      const box = await page.locator(`#chart .point[data-key="${data.indexOf(c)}"]`).boundingBox();
      return [box.x + box.width / 2, box.y + box.height / 2];
    };
    const ticks = await page.locator("#chart [aria-label='x-axis tick label'] text").evaluateAll((nodes) => nodes.map((n) => { const r = n.getBoundingClientRect(); return [Number(n.textContent), r.x + r.width / 2]; }));
    const [[v0, p0], [v1, p1]] = [ticks[0], ticks.at(-1)], [xa, ya] = await where(a), [xb, yb] = await where(b);
    for (const [c, x] of [[a, xa], [b, xb]]) {
      const expected = p0 + ((p1 - p0) * Math.log(c.frame.gpu_ms.median / v0)) / Math.log(v1 / v0);
      assert.ok(Math.abs(x - expected) < 2, `${x} for ${expected}`);
    }
    assert.equal(ya > yb, a.error.relmse.median.value < b.error.relmse.median.value);
  },
  async "other axes show other figures"(page) {
    await page.selectOption("#time", { label: "GPU time of the pass 'reuse'" });
    const reuse = plotted.filter((c) => c.settings["reuse.enabled"]).length;
    assert.equal(await points(page), reuse);
    await page.selectOption("#error", { label: "FLIP of a frame" });
    await page.selectOption("#time", { label: "GPU time of a frame" });
    assert.equal(await points(page), plotted.length + 1);  // the error of zero was in the relMSE
    assert.equal(await page.locator("#error option[disabled]").count(), 2);  // the fixture has no trimmed means
    await page.selectOption("#color", { label: "pick.count" });
    assert.equal(await page.locator("#legend ul").first().locator("li").count(), 1 + 4);
  },
  async "filters by pass, parameter and scene"(page) {
    const box = (dimension, value) => page.locator("fieldset", { has: page.getByText(dimension, { exact: true }) }).getByRole("checkbox", { name: new RegExp(`^${value}`) });
    await box("Pass reuse", "off").uncheck();
    assert.equal(await points(page), plotted.filter((c) => c.settings["reuse.enabled"]).length);
    await box("pick.count", "8").first().uncheck();
    assert.equal(await points(page), plotted.filter((c) => c.settings["reuse.enabled"] && c.settings["pick.count"] !== 8).length);
    assert.equal(await rows(page), data.slice(0, perScene).filter((c) => c.settings["reuse.enabled"] && c.settings["pick.count"] !== 8).length);
    await page.click("#reset");
    assert.equal(await rows(page), 2 * perScene);
    assert.equal(await points(page), plotted.length + perScene);
    await box("Scene", "stripes").uncheck();
    assert.equal(await points(page), perScene);
    await page.getByLabel("front only").check();
    assert.equal(await points(page), await page.locator("#chart .point[data-front]").count());
  },
  async "hovering shows settings and a crop"(page) {
    const key = data.indexOf(plotted.find((c) => c.pictures && c.name.startsWith("made")));
    const box = await page.locator(`#chart .point[data-key="${key}"]`).boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    const tip = page.locator("#tip");
    assert.ok(await tip.isVisible());
    const words = await tip.textContent();
    for (const word of ["pick.count", "error", "ms", "p95"]) assert.ok(words.includes(word), `${word} in ${words}`);
    assert.equal(await tip.locator("img").evaluate((image) => image.decode().then(() => image.naturalWidth)), 32);
    await page.mouse.move(2, 2);
    assert.ok(await tip.isHidden());
  },
  async "keys go through the points and pin them; the slider moves the edge"(page) {
    await page.locator("#frontOnly").focus();
    await page.keyboard.press("Tab");
    const current = () => page.evaluate(() => document.activeElement.dataset.key);
    const order = plotted.slice().sort((a, b) => a.frame.gpu_ms.median - b.frame.gpu_ms.median).map((c) => String(data.indexOf(c)));
    for (let tabs = 0; (await current()) === undefined && tabs < 60; ++tabs) await page.keyboard.press("Tab");
    assert.equal(await current(), order[0]);
    assert.ok(await page.locator("#tip").isVisible());
    await page.keyboard.press("Enter");
    assert.equal(await current(), order[0]);
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    assert.equal(await current(), order[2]);
    await page.keyboard.press("Enter");
    assert.equal(await page.locator("#chart .point[aria-selected=true]").count(), 2);
    await page.keyboard.press("End");
    assert.equal(await current(), order.at(-1));
    await page.keyboard.press("Escape");
    assert.ok(await page.locator("#tip").isHidden());
    assert.equal(await page.locator("#comparison .head code").count(), 2);

    const edge = () => page.locator(".edge").evaluate((node) => node.getBoundingClientRect().left - node.parentElement.getBoundingClientRect().left);
    const width = await page.locator(".sides").evaluate((node) => node.clientWidth);
    assert.ok(Math.abs((await edge()) - width / 2) < 3);
    await page.locator("#split").focus();
    for (let i = 0; i < 10; ++i) await page.keyboard.press("ArrowRight");
    assert.ok(Math.abs((await edge()) - 0.6 * width) < 3);
    await page.keyboard.press("Home");
    assert.ok(Math.abs(await edge()) < 3);
  },
  async "comparison: crops, reference, FLIP map, side by side"(page) {
    const pinned = data.filter((c) => c.pictures).slice(3, 5);
    for (const [i, name] of ["A", "B"].entries()) await page.getByRole("button", { name: `${pinned[i].id} as ${name}`, exact: true }).click();
    const sources = () => page.locator(".side img").evaluateAll((images) => Promise.all(images.map((image) => image.decode().then(() => image.src))));
    const file = (name) => `data:image/png;base64,${readFileSync(join(folder, name)).toString("base64")}`;
    assert.deepEqual(await sources(), pinned.map((c) => file(c.pictures.frame)));
    await page.locator("#showA-1").check();
    await page.locator("#showB-2").check();
    assert.deepEqual(await sources(), [file(pinned[0].pictures.reference), file(pinned[1].pictures.flip)]);
    assert.ok(await page.locator(".ramp").isVisible());
    await page.locator("#mode-both").check();
    const boxes = await page.locator(".side").evaluateAll((nodes) => nodes.map((n) => n.getBoundingClientRect().left));
    assert.ok(boxes[1] > boxes[0] + 100);
    assert.ok(await page.locator("#split").isHidden());
    assert.match(await page.locator(".figures").textContent(), /relMSE of a frame, median/);
    await page.click("#swap");
    assert.equal(await page.locator("#comparison .head code").first().textContent(), pinned[1].id);
  },
  async "the table sorts, and copies the command"(page) {
    const header = page.getByRole("button", { name: /^error × ms/ });
    const column = () => page.locator("#table tbody tr").evaluateAll((all) => all.map((tr) => Number(tr.dataset.key)));
    const product = (k) => (data[k].error ? data[k].frame.gpu_ms.median * data[k].error.relmse.median.value : Infinity);
    const up = (keys) => keys.every((k, i) => i === 0 || product(keys[i - 1]) <= product(k));
    assert.ok(up(await column()));
    await header.click();
    const keys = await column();
    assert.equal(keys.at(-1), 1);  // without an error: last both ways
    assert.ok(up(keys.slice(0, -1).reverse()));
    assert.equal(await page.locator("th[aria-sort=descending]").count(), 1);
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await page.getByRole("button", { name: `copy the command of ${data[5].id}`, exact: true }).click();
    await page.waitForFunction(() => document.getElementById("copied").textContent.startsWith("Copied"));
    assert.equal(await page.evaluate(() => navigator.clipboard.readText()), data[5].command);
  },
  async "markup in the file stays text"(page) {
    assert.equal(await page.evaluate(() => window.broken), undefined);
    assert.equal(await page.locator("h1").textContent(), "Made-up <b>title</b>");
    assert.equal(await page.locator(`#table tr[data-key="0"] .command code`).textContent(), data[0].command);
    await page.locator(`#table tr[data-key="0"] .pin`).first().click();
    assert.equal(await page.evaluate(() => window.broken), undefined);
    assert.equal(await page.locator("img[src=x]").count(), 0);
    assert.equal(await page.evaluate(() => document.querySelectorAll("script").length), 2);
  },
  async "a saved SVG is a picture of its own"(page) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    const text = readFileSync(await download.path(), "utf8");
    const found = await page.evaluate((xml) => {
      const tree = new DOMParser().parseFromString(xml, "image/svg+xml");
      return { error: tree.querySelector("parsererror")?.textContent, points: tree.querySelectorAll("[data-key]").length, texts: tree.documentElement.textContent };
    }, text);
    assert.equal(found.error, undefined);
    assert.equal(found.points, plotted.length);
    for (const word of ["Made-up <b>title</b>", "reuse.json", "relMSE of a frame, median"]) assert.ok(found.texts.includes(word), word);
  },
  async "the program's own SVG is one too"(page) {
    const found = await page.evaluate((xml) => {
      const tree = new DOMParser().parseFromString(xml, "image/svg+xml");
      return { error: tree.querySelector("parsererror")?.textContent, points: tree.querySelectorAll(".point").length };
    }, readFileSync(svg, "utf8"));
    assert.deepEqual(found, { error: undefined, points: plotted.length + perScene + 2 * 2 });  // and a legend of two in each panel
  },
  async "dark colours, and light ones on paper"(page) {
    const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await page.getByRole("button", { name: "dark colours" }).click();
    assert.equal(await paper(), "rgb(20, 24, 29)");
    await page.emulateMedia({ media: "print" });
    assert.equal(await paper(), "rgb(255, 255, 255)");
    assert.ok(await page.locator("#axes").isHidden());
    assert.ok(await page.locator("#table code").first().isVisible());
  },
};

const narrow = {
  async "a phone shows all without scrolling sideways"(page) {
    assert.equal(await points(page), plotted.length);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    assert.equal(await page.locator("#filters").getAttribute("open"), null);
    await page.locator("#chart .point[data-front]").first().hover();
    const box = await page.locator("#tip").boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 375 && box.y + box.height <= 720, JSON.stringify(box));
  },
};

const unscripted = {
  async "without scripts the still picture is there"(page) {
    assert.equal(await page.locator("noscript svg .front").count(), 2);
    assert.ok(await page.locator("#app").isHidden());
  },
};

let failed = 0;
for (const [list, settings] of [[tests, {}], [narrow, { viewport: { width: 375, height: 720 } }], [unscripted, { javaScriptEnabled: false }]]) {
  for (const [name, test] of Object.entries(list)) {
    const page = await open(settings);
    try {
      await test(page);
      assert.deepEqual(complaints, []);
      console.log(`ok      ${name}`);
    } catch (error) {
      ++failed;
      console.log(`FAILED  ${name}\n${error.stack}`);
    }
    complaints.length = 0;
    await page.context().close();
  }
}
await browser.close();
rmSync(folder, { recursive: true });
process.exit(failed ? 1 : 0);
