/** What hovering or focusing a point shows: settings, figures and the crop. */
import { element } from "./dom.js";
import { figure, milliseconds, setting } from "./format.js";

const interval = (e) => (e[1] !== null && e[2] !== null ? ` (${figure(e[1])} to ${figure(e[2])})` : "");

/** All of a point as one sentence, for those who hear it. */
export function spoken(point, view, dims) {
  const { item } = point;
  const settings = dims.filter((d) => d.id !== "graph" && d.of(item) !== undefined).map((d) => `${d.label} ${setting(d.of(item))}`);
  return `${item.data.graph}, ${milliseconds(point.x)}, ${view.yLabel} ${figure(point.y)}${point.front ? ", on the Pareto front" : ""}; ${settings.join(", ")}`;
}

export class Tip {
  constructor(node) {
    this.node = node;
  }

  hide() {
    this.node.hidden = true;
  }

  /** `at`: the point's place inside of the figure, in pixels. */
  show(point, view, dims, at) {
    const { item } = point, error = item.errors[view.error];
    const rows = [
      ["time", milliseconds(point.x) + (point.xHigh > point.x ? ` (p95 ${figure(point.xHigh)})` : "")],
      ["error", figure(point.y) + interval(error)],
      ["error × ms", figure(point.x * point.y)],
    ];
    if (item.data.floor?.multiple) rows.push(["× floor", figure(item.data.floor.multiple)]);
    const varied = dims.filter((d) => d.id !== "graph" && d.of(item) !== undefined).map((d) => [d.label, setting(d.of(item))]);
    this.node.replaceChildren(
      element("div", { class: "words" },
        element("strong", {}, item.data.graph), point.front ? element("span", { class: "badge" }, "front") : null,
        element("dl", {}, ...rows.flatMap(([k, v]) => [element("dt", {}, k), element("dd", {}, v)])),
        element("dl", { class: "settings" }, ...varied.slice(0, 14).flatMap(([k, v]) => [element("dt", {}, k), element("dd", {}, v)])),
        element("p", {}, "click or Enter: compare")),
      item.pictures[0] ? element("img", { src: item.pictures[0], alt: "crop of a frame" }) : null);
    this.node.hidden = false;
    const box = this.node.closest("figure").getBoundingClientRect(), own = this.node.getBoundingClientRect();
    const left = at.x + 18 + own.width < box.width ? at.x + 18 : at.x - own.width - 18;
    this.node.style.left = `${Math.max(Math.min(left, box.width - own.width), 0)}px`;
    this.node.style.top = `${Math.max(Math.min(at.y - own.height / 2, box.height - own.height), 0)}px`;
  }
}
