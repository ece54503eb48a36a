/** Puts the page together: reads the data, keeps the state, tells the parts when it changes. */
import { Compare } from "./compare.js";
import { dimensions, readItems } from "./data.js";
import { byId, element } from "./dom.js";
import { Filters } from "./filters.js";
import { legendOf, showLegend, standalone } from "./legend.js";
import { draw, pointsOf } from "./plot.js";
import { Scatter } from "./scatter.js";
import { Table } from "./table.js";
import { colorsOf, symbolsOf, THEMES } from "./theme.js";
import { Tip } from "./tip.js";

const { title, items, groups, raw } = readItems(JSON.parse(byId("data").textContent));
const dims = dimensions(items, groups), graphs = dims.find((d) => d.id === "graph");
const state = {
  time: raw.times.findIndex((axis) => axis.key === raw.time),
  error: raw.errors.findIndex((axis) => axis.key === raw.error),
  color: (graphs.values.length > 1 ? graphs : dims.find((d) => d.id.startsWith("parameter") && d.numeric) ?? graphs).id,
  pins: { A: undefined, B: undefined },
  theme: matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
  printing: false,
};

const filters = new Filters(dims, update);
const scatter = new Scatter({ into: byId("chart"), tip: new Tip(byId("tip")), pin: (item) => pin(item) });
const compare = new Compare({ into: byId("comparison"), clear: (name) => { state.pins[name] = undefined; updatePins(); }, swap });
const table = new Table({ table: byId("table"), more: byId("more"), copied: byId("copied"), pin, mark: (key) => scatter.mark(key) });

/** Without a name: unpins what is pinned, fills what is free, else replaces B. */
function pin(item, name) {
  const taken = Object.keys(state.pins).find((n) => state.pins[n] === item);
  if (taken && (!name || name === taken)) state.pins[taken] = undefined;
  else {
    if (taken) state.pins[taken] = undefined;
    state.pins[name ?? (state.pins.A ? "B" : "A")] = item;
  }
  updatePins();
}

function swap() {
  state.pins = { A: state.pins.B, B: state.pins.A };
  updatePins();
}

/** All that a drawing depends on. */
function viewOf(themeName, width, height) {
  const theme = THEMES[themeName];
  const shown = items.filter((item) => filters.passes(item));
  const all = pointsOf(shown, state.time, state.error);
  const points = byId("frontOnly").checked ? all.filter((p) => p.front) : all;
  const dimension = dims.find((d) => d.id === state.color);
  const colors = colorsOf(dimension, theme), symbols = symbolsOf(graphs);
  return {
    shown, points, groups, front: new Set(all.filter((p) => p.front).map((p) => p.item.key)), lists: legendOf(dimension, graphs, colors, symbols, theme),
    theme, width, height, time: state.time, error: state.error,
    xLabel: raw.times[state.time].label, yLabel: raw.errors[state.error].label,
    equal: byId("equal").checked, bars: byId("bars").checked,
    color: (item) => colors.get(dimension.of(item)), symbol: (item) => symbols.get(item.data.graph),
    pins: Object.entries(state.pins).filter(([, item]) => item).map(([name, item]) => ({ name, key: item.key })),
  };
}

function drawChart() {
  const width = Math.max(Math.floor(byId("chart").clientWidth), 280);
  const view = viewOf(state.printing ? "light" : state.theme, width, Math.round(Math.min(Math.max(width * 0.62, 340), 640)));
  showLegend(byId("legend"), view.lists);
  scatter.update(view, dims.filter((d) => d.values.length > 1));
  const { points, shown } = view, missing = shown.length - pointsOf(shown, state.time, state.error).length;
  byId("caption").textContent = points.length === 0
    ? "Nothing to show: no configuration that passes the filters has both figures above zero."
    : `${points.length} configurations, ${points.filter((p) => p.front).length} on the Pareto front (solid line). Bars: 95 % confidence interval of the error, 95th percentile of the time.`
      + (missing > 0 ? ` ${missing} more have no such figure, or zero, and are in the table only.` : "");
  byId("caption").dataset.points = points.length;
  return view;
}

function update() {
  const view = drawChart();
  filters.update(items);
  byId("shown").textContent = `${view.shown.length} of ${items.length}`;
  compare.update(state.pins, dims.filter((d) => d.values.length > 1), raw);
  table.update({ items: view.shown, front: view.front, time: state.time, error: state.error, pins: state.pins }, dims);
}

/** What another pin changes: with a thousand rows the rest would be felt. */
function updatePins() {
  drawChart();
  compare.update(state.pins, dims.filter((d) => d.values.length > 1), raw);
  table.showPins(state.pins);
}

function applyTheme() {
  document.documentElement.dataset.theme = state.theme;
  byId("theme").textContent = state.theme === "dark" ? "Light" : "Dark";
  byId("theme").setAttribute("aria-label", `${state.theme === "dark" ? "light" : "dark"} colours`);
}

/** Light and of one size, whatever the window is. */
function save() {
  const view = viewOf("light", 900, 560);
  const text = standalone(draw(view), view.lists, title, THEMES.light);
  const link = element("a", { href: URL.createObjectURL(new Blob([text], { type: "image/svg+xml" })), download: "chart.svg" });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function fill(select, options, current, chosen) {
  select.replaceChildren(...options.map(({ value, label, disabled }) => element("option", { value, disabled, selected: String(value) === String(current) }, label)));
  select.addEventListener("change", () => { chosen(select.value); update(); });
}

function start() {
  byId("title").textContent = title;
  const devices = [...new Set(raw.files.map((f) => [f.device, f.driver].filter(Boolean).join(", ")))];
  const sizes = [...new Set(items.map((i) => i.data.size.join("×")))];
  byId("facts").textContent = `${items.length} configurations · ${groups.join(" · ")} · ${sizes.join(", ")} pixels · ${devices.join("; ")}`;
  byId("footer").textContent = `From ${raw.files.map((f) => `${f.name}${f.weir ? ` (Weir ${f.weir})` : ""}`).join(", ")}.`
    + (raw.picturesLeftOut > 0 ? ` The pictures of ${raw.picturesLeftOut} configurations had no room in this page.` : "");
  const measured = (list, i) => items.some((item) => item[list][i]);
  fill(byId("time"), raw.times.map((a, i) => ({ value: i, label: a.label, disabled: !measured("times", i) })), state.time, (v) => (state.time = Number(v)));
  fill(byId("error"), raw.errors.map((a, i) => ({ value: i, label: a.label, disabled: !measured("errors", i) })), state.error, (v) => (state.error = Number(v)));
  fill(byId("color"), dims.filter((d) => d.values.length > 1 || d.id === "graph").map((d) => ({ value: d.id, label: d.label })), state.color, (v) => (state.color = v));
  for (const id of ["equal", "bars", "frontOnly"]) byId(id).addEventListener("change", update);
  byId("axes").addEventListener("submit", (event) => event.preventDefault());
  byId("reset").addEventListener("click", () => { filters.reset(); update(); });
  byId("save").addEventListener("click", save);
  byId("theme").addEventListener("click", () => { state.theme = state.theme === "dark" ? "light" : "dark"; applyTheme(); update(); });
  addEventListener("beforeprint", () => { state.printing = true; drawChart(); });
  addEventListener("afterprint", () => { state.printing = false; drawChart(); });
  // Errors of different scenes can't be compared: one at a time, unless somebody wants more.
  for (const other of groups.slice(1)) filters.hidden.get("scene")?.add(other);
  filters.show(byId("dimensions"));
  byId("filters").open = innerWidth > 820;
  byId("app").hidden = false;
  applyTheme();
  update();
  let last = byId("chart").clientWidth;
  new ResizeObserver(() => {
    const now = byId("chart").clientWidth;
    if (now === last) return;
    last = now;
    requestAnimationFrame(drawChart);
  }).observe(byId("chart"));
}

start();
