/** The scatter: Observable Plot draws it, this says what. */
import * as Plot from "@observablehq/plot";
import { paretoFront } from "./pareto.js";
import { tick } from "./format.js";

/**
 * Those items that log axes can show, with their place: x, y, ends of their bars, whether on the front of their group.
 * @param {import("./data.js").Item[]} items
 */
export function pointsOf(items, time, error) {
  const above = (v) => (v > 0 ? v : undefined);
  const points = [];
  for (const item of items) {
    const [t, e] = [item.times[time], item.errors[error]];
    if (!(t?.[0] > 0 && e?.[0] > 0)) continue;
    points.push({ item, x: t[0], xHigh: above(t[2]), y: e[0], yLow: above(e[1]), yHigh: above(e[2]), front: false });
  }
  for (const group of new Set(points.map((p) => p.item.group))) {
    const own = points.filter((p) => p.item.group === group);
    paretoFront(own).forEach((on, i) => (own[i].front = on));
  }
  return points.sort((a, b) => a.x - b.x || a.y - b.y);
}

/** The ends of an axis with some room. An interval that nearly reaches zero would make it as long as it likes. */
function domainOf(values, ends) {
  const all = values.slice();
  ends.forEach(([v, end]) => end > v / 10 && end < v * 10 && all.push(end));
  if (all.length === 0) return [1, 10];
  // Bounds as in framework/chart/log_axis.cpp, so that neither room nor product leaves what a number holds.
  const low = Math.max(all.reduce((a, b) => Math.min(a, b)), 1e-100), high = Math.min(all.reduce((a, b) => Math.max(a, b)), 1e100);
  if (!(low <= high)) return [1, 10];
  const room = Math.max((high / low) ** 0.05, high / low < 1.5 ? 1.25 : 1.02);
  return [low / room, high * room];
}

/** Ticks as in framework/chart/log_axis.cpp: equal steps within a decade, else powers of ten and few multiples. */
export function ticksOf([low, high], few) {
  const decades = Math.log10(high / low), ticks = [];
  if (decades < 1) {
    const raw = (high - low) / (few ? 4 : 7), unit = 10 ** Math.floor(Math.log10(raw));
    const step = unit * (raw / unit > 5 ? 10 : raw / unit > 2 ? 5 : raw / unit > 1 ? 2 : 1);
    for (let k = Math.ceil(low / step); k * step <= high; ++k) ticks.push(k * step);
    return ticks;
  }
  const every = Math.max(1, Math.floor(decades / (few ? 4 : 8)));
  for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); ++k) {
    if (k % every) continue;
    for (const m of [1, 2, 5]) if ((m === 1 || decades < (few ? 2 : 3)) && m * 10 ** k >= low && m * 10 ** k <= high) ticks.push(m * 10 ** k);
  }
  return ticks;
}

/** Lines of one product of error and time: who halves the one may double the other. */
function equalTimes(xs, ys) {
  const least = Math.log10(xs[0] * ys[0]), most = Math.log10(xs[1] * ys[1]);
  const step = Math.max(1, Math.ceil((most - least) / 8));
  const lines = [];
  for (let k = Math.ceil(least); k <= most; k += step) {
    const c = 10 ** k, x1 = Math.max(xs[0], c / ys[1]), x2 = Math.min(xs[1], c / ys[0]);
    if (x1 < x2) lines.push({ x1, y1: c / x1, x2, y2: c / x2, text: tick(c) });
  }
  return lines;
}

/** The step line of each group's front: up from its fastest point, right from its most exact one. */
function frontLines(points, [, right], [, top]) {
  const lines = [];
  for (const group of new Set(points.map((p) => p.item.group))) {
    const own = points.filter((p) => p.front && p.item.group === group);
    if (own.length === 0) continue;
    lines.push({ x: own[0].x, y: top, group }, ...own.map((p) => ({ x: p.x, y: p.y, group })), { x: right, y: own.at(-1).y, group });
  }
  return lines;
}

/**
 * @param {{points: ReturnType<typeof pointsOf>, width: number, height: number, theme: object, xLabel: string,
 *          yLabel: string, equal: boolean, bars: boolean, color: (item) => string, symbol: (item) => string,
 *          pins: {name: string, key: number}[], groups: string[]}} view
 */
export function draw(view) {
  const { points, theme } = view;
  const small = view.width < 560;
  const xs = domainOf(points.map((p) => p.x), points.map((p) => [p.x, p.xHigh]));
  const ys = domainOf(points.map((p) => p.y), points.flatMap((p) => [[p.y, p.yLow], [p.y, p.yHigh]]));
  const paint = (p) => view.color(p.item);
  const drawn = points.slice().sort((a, b) => a.front - b.front);  // the front's lie on top
  const pinned = view.pins.flatMap((pin) => points.filter((p) => p.item.key === pin.key).map((p) => ({ ...p, name: pin.name })));
  const bar = { stroke: paint, strokeWidth: 1.25, clip: true, strokeOpacity: (p) => (p.front ? 0.85 : 0.28) };
  const marks = [
    Plot.gridX({ ticks: ticksOf(xs, small), stroke: theme.line, strokeOpacity: 1 }),
    Plot.gridY({ ticks: ticksOf(ys, false), stroke: theme.line, strokeOpacity: 1 }),
  ];
  if (view.equal) {
    const lines = equalTimes(xs, ys);
    marks.push(
      Plot.link(lines, { x1: "x1", y1: "y1", x2: "x2", y2: "y2", stroke: theme.guide, strokeDasharray: "2 4", clip: true, className: "equal" }),
      Plot.text(lines, { x: "x2", y: "y2", text: "text", textAnchor: "end", dx: -4, dy: -7, fill: theme.soft, fontSize: 10 }),
    );
  }
  if (view.bars) {
    marks.push(
      Plot.ruleY(drawn.filter((p) => p.xHigh > p.x), { x1: "x", x2: "xHigh", y: "y", ...bar, className: "bar" }),
      Plot.ruleX(drawn.filter((p) => p.yHigh), { x: "x", y1: (p) => Math.max(p.yLow ?? 0, ys[0]), y2: (p) => Math.min(p.yHigh, ys[1]), ...bar, className: "bar" }),
    );
  }
  const fronts = frontLines(points, xs, ys), several = new Set(fronts.map((p) => p.group)).size > 1;
  marks.push(
    Plot.line(fronts, { x: "x", y: "y", z: "group", curve: "step-after", stroke: theme.front, strokeWidth: 1.5, clip: true, className: "front" }),
    Plot.dot(drawn, {
      x: "x", y: "y", fill: paint, symbol: (p) => view.symbol(p.item), r: (p) => (p.front ? 5.5 : 4),
      stroke: theme.paper, strokeWidth: 0.8, fillOpacity: (p) => (p.front ? 1 : 0.5),
      render(index, scales, values, dimensions, context, next) {
        const g = next(index, scales, values, dimensions, context);
        g.classList.add("points");
        [...g.children].forEach((node, i) => (node.dataset.key = drawn[index[i]].item.key));
        return g;
      },
    }),
    // Which scene a front is of, where there are several.
    Plot.text(several ? fronts.filter((p) => p.x === xs[1]) : [], {
      x: "x", y: "y", text: (p) => view.groups[p.group], textAnchor: "end", dx: -6, dy: -8, fill: theme.ink, stroke: theme.paper, strokeWidth: 4, fontWeight: 600,
    }),
    Plot.dot(pinned, { x: "x", y: "y", r: 10, stroke: theme.ink, strokeWidth: 1.5, className: "pins" }),
    Plot.text(pinned, { x: "x", y: "y", text: "name", dx: 14, dy: -11, fill: theme.ink, stroke: theme.paper, strokeWidth: 4, fontWeight: "bold", fontSize: 13 }),
    Plot.axisX({ ticks: ticksOf(xs, small), text: tick, label: `${view.xLabel} / ms →`, labelAnchor: "center", labelOffset: 38 }),
    Plot.axisY({ ticks: ticksOf(ys, false), text: tick, label: `↑ ${view.yLabel}`, labelAnchor: "top" }),
    Plot.ruleX([xs[0]], { stroke: theme.soft }),
    Plot.ruleY([ys[0]], { stroke: theme.soft }),
  );
  return Plot.plot({
    width: view.width, height: view.height,
    marginLeft: 64, marginBottom: 48, marginTop: 34, marginRight: 16,
    style: { background: theme.paper, color: theme.ink, fontSize: "12px", fontFamily: "system-ui, sans-serif", overflow: "visible" },
    x: { type: "log", domain: xs }, y: { type: "log", domain: ys },
    color: { type: "identity" }, symbol: { type: "identity" }, r: { type: "identity" }, opacity: { type: "identity" },
    marks,
  });
}
