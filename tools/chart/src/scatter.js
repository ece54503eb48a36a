/** The chart as one sees and steers it: drawing into the page, pointer, keyboard. */
import { draw } from "./plot.js";
import { spoken } from "./tip.js";

export class Scatter {
  /** @param {{into: HTMLElement, tip: import("./tip.js").Tip, pin: (item) => void}} parts */
  constructor(parts) {
    Object.assign(this, parts);
    this.into.addEventListener("pointermove", (event) => this.hover(event));
    this.into.addEventListener("pointerleave", () => this.leave());
    this.into.addEventListener("click", (event) => {
      const point = this.near(event);
      if (point) this.pin(point.item);
    });
    this.into.addEventListener("keydown", (event) => this.key(event));
    this.into.addEventListener("focusin", (event) => event.target.dataset?.key && this.show(this.byKey.get(Number(event.target.dataset.key))));
    this.into.addEventListener("focusout", () => this.leave());
  }

  /** @param {object} view as draw() takes it, with points in the order that the keyboard goes through */
  update(view, dims) {
    const focused = document.activeElement?.closest?.("#chart") ? document.activeElement.dataset.key : undefined;
    Object.assign(this, { view, dims });
    const svg = draw(view);
    svg.setAttribute("role", "listbox");
    svg.setAttribute("aria-multiselectable", "true");
    svg.setAttribute("aria-label", `${view.yLabel} against ${view.xLabel}, ${view.points.length} configurations. Arrow keys go from point to point, Enter takes one to the comparison.`);
    for (const child of svg.children) if (!child.classList.contains("points")) child.setAttribute("aria-hidden", "true");
    this.svg = svg;
    this.nodes = new Map();
    this.byKey = new Map(view.points.map((p) => [p.item.key, p]));
    const pinned = new Set(view.pins.map((pin) => pin.key));
    for (const node of svg.querySelectorAll(".points > *")) {
      const key = Number(node.dataset.key);
      this.nodes.set(key, node);
      node.classList.add("point");
      node.setAttribute("role", "option");
      node.setAttribute("tabindex", "-1");
      node.setAttribute("aria-selected", String(pinned.has(key)));
      node.setAttribute("aria-label", spoken(this.byKey.get(key), view, dims));
      if (this.byKey.get(key).front) node.dataset.front = "";
    }
    const x = svg.scale ?? (() => undefined);
    this.places = view.points.map((p) => ({ p, x: x("x").apply(p.x), y: x("y").apply(p.y) }));
    this.into.replaceChildren(svg);
    // One stop for Tab; the arrow keys do the rest.
    this.stop(this.nodes.has(Number(focused)) ? Number(focused) : this.byKey.has(this.current) ? this.current : view.points[0]?.item.key);
    if (focused !== undefined) this.nodes.get(this.current)?.focus({ preventScroll: true });
    else this.leave();
  }

  stop(key) {
    this.nodes.get(this.current)?.setAttribute("tabindex", "-1");
    this.current = key;
    this.nodes.get(key)?.setAttribute("tabindex", "0");
  }

  place(event) {
    const box = this.svg.getBoundingClientRect(), scale = box.width / Number(this.svg.getAttribute("width"));
    return { x: (event.clientX - box.left) / scale, y: (event.clientY - box.top) / scale };
  }

  /** The nearest point within a finger's reach. */
  near(event) {
    if (!this.svg) return undefined;
    const at = this.place(event);
    let best, least = 24 ** 2;
    for (const place of this.places) {
      const d = (place.x - at.x) ** 2 + (place.y - at.y) ** 2;
      if (d < least) [best, least] = [place.p, d];
    }
    return best;
  }

  hover(event) {
    const point = this.near(event);
    if (point) this.show(point);
    else this.leave();
  }

  show(point) {
    this.leave();
    const place = this.places.find((p) => p.p === point);
    this.nodes.get(point.item.key).classList.add("shown");
    const figure = this.into.closest("figure").getBoundingClientRect(), own = this.svg.getBoundingClientRect();
    const scale = own.width / Number(this.svg.getAttribute("width"));
    this.tip.show(point, this.view, this.dims, { x: place.x * scale + own.left - figure.left, y: place.y * scale + own.top - figure.top });
  }

  leave() {
    this.tip.hide();
    for (const node of this.into.querySelectorAll(".shown")) node.classList.remove("shown");
  }

  /** From the table: where is it in the chart? */
  mark(key) {
    this.leave();
    this.nodes.get(key)?.classList.add("shown");
  }

  key(event) {
    const points = this.view.points, at = points.findIndex((p) => p.item.key === this.current);
    const fronts = points.map((p, i) => (p.front ? i : -1)).filter((i) => i >= 0);
    const to = {
      ArrowRight: Math.min(at + 1, points.length - 1), ArrowLeft: Math.max(at - 1, 0), Home: 0, End: points.length - 1,
      ArrowDown: fronts.find((i) => i > at) ?? at, ArrowUp: fronts.findLast((i) => i < at) ?? at,
    }[event.key];
    if (to !== undefined) {
      event.preventDefault();
      this.stop(points[to].item.key);
      this.nodes.get(this.current).focus();
    } else if (event.key === "Enter" || event.key === " ") {
      event.preventDefault();
      this.pin(points[at].item);
    } else if (event.key === "Escape") {
      this.leave();
    }
  }
}
