/** Two pinned configurations: crops behind a slider or side by side, and their figures. */
import { element } from "./dom.js";
import { bytes, figure, milliseconds, setting } from "./format.js";

const PICTURES = ["frame", "reference", "FLIP map"];

export class Compare {
  /** @param {{into: HTMLElement, clear: (name?: string) => void, swap: () => void}} parts */
  constructor(parts) {
    Object.assign(this, parts);
    this.mode = "slider";
    this.split = 50;
    this.shows = { A: 0, B: 0 };
  }

  /** @param {{A?: Item, B?: Item}} pins */
  update(pins, dims, axes) {
    Object.assign(this, { pins, dims, axes });
    const focus = document.activeElement?.id;
    if (!pins.A && !pins.B) {
      this.into.replaceChildren(element("p", { class: "hint" }, "Click two points, or press Enter on them, and their crops and figures are compared here."));
      return;
    }
    this.stage = element("div", { class: `stage ${this.mode}` });
    this.into.replaceChildren(this.heads(), this.controls(), this.stage, this.figures());
    this.picture();
    if (focus) document.getElementById(focus)?.focus({ preventScroll: true });
  }

  heads() {
    return element("div", { class: "heads" }, ...["A", "B"].map((name) => {
      const item = this.pins[name];
      return element("div", { class: "head", "data-pin": name }, element("b", { class: "letter" }, name),
        item ? element("span", {}, item.data.graph, " ", element("code", {}, item.data.id)) : element("span", { class: "hint" }, "none yet: click a point"),
        item ? element("button", { type: "button", "aria-label": `remove ${name}`, onclick: () => this.clear(name) }, "×") : null);
    }), element("button", { type: "button", onclick: () => this.swap(), id: "swap" }, "swap"));
  }

  /** A radio group; the page is not built anew, so that the focus stays. */
  choice(label, id, options, current, chosen) {
    return element("fieldset", { class: "choice" }, element("legend", {}, label), ...options.map(([value, text]) =>
      element("label", {}, element("input", { type: "radio", name: id, id: `${id}-${value}`, value, checked: value === current, onchange: () => { chosen(value); this.picture(); } }), text)));
  }

  controls() {
    const options = PICTURES.map((text, i) => [i, text]);
    this.slider = element("input", { type: "range", id: "split", min: 0, max: 100, step: 1, value: this.split, "aria-label": "where A ends and B begins, in percent of the width" });
    this.slider.addEventListener("input", () => {
      this.split = Number(this.slider.value);
      this.place();
    });
    return element("div", { class: "controls" },
      this.choice("View", "mode", [["slider", "slider"], ["both", "side by side"]], this.mode, (v) => (this.mode = v)),
      this.choice("A shows", "showA", options, this.shows.A, (v) => (this.shows.A = v)),
      this.choice("B shows", "showB", options, this.shows.B, (v) => (this.shows.B = v)),
      element("label", { class: "split" }, element("span", {}, "A"), this.slider, element("span", {}, "B")));
  }

  side(name) {
    const item = this.pins[name], shown = this.shows[name], source = item?.pictures[shown];
    const text = `${name}: ${PICTURES[shown]}`;
    return element("div", { class: "side", "data-side": name },
      source ? element("img", { src: source, alt: item ? `${text} of ${item.data.graph} ${item.data.id}` : text, draggable: "false" })
        : element("p", { class: "hint" }, item ? `${name}: no ${PICTURES[shown]} in the file` : `${name}: none yet`),
      element("span", { class: "tag" }, text));
  }

  picture() {
    this.stage.className = `stage ${this.mode}`;
    this.slider.closest("label").hidden = this.mode !== "slider";
    const flip = this.shows.A === 2 || this.shows.B === 2;
    this.stage.replaceChildren(element("div", { class: "sides" }, this.side("A"), this.side("B"), element("div", { class: "edge", "aria-hidden": "true" })),
      ...(flip ? [element("div", { class: "ramp" }, "0", element("i"), "1 FLIP")] : []));
    this.place();
  }

  place() {
    // With one alone there is nothing to divide.
    const split = this.pins.A && this.pins.B ? this.split : this.pins.A ? 100 : 0;
    this.stage.style.setProperty("--split", `${split}%`);
  }

  figures() {
    const { A, B } = this.pins;
    const rows = [];
    const row = (label, of, text, isSetting = false) => {
      const [a, b] = [A && of(A), B && of(B)];
      if (a === undefined && b === undefined || a === null && b === null) return;
      rows.push({ label, a: text(a), b: text(b), different: isSetting && a !== b, ratio: !isSetting && a > 0 && b > 0 ? `${figure(b / a)}×` : "" });
    };
    for (const d of this.dims) row(d.label, (item) => d.of(item), setting, true);
    this.axes.times.forEach((axis, i) => row(axis.key.startsWith("pass.") ? `pass ${axis.key.slice(5)}` : axis.label, (item) => item.times[i]?.[0], milliseconds));
    this.axes.errors.forEach((axis, i) => row(axis.label, (item) => item.errors[i]?.[0], figure));
    row("correlation time / frames", (item) => item.data.error?.correlation_time?.value, figure);
    row("multiple of the floor", (item) => item.data.floor?.multiple, figure);
    row("rays of a frame", (item) => item.data.rays, figure);
    row("history", (item) => item.data.memory?.history_bytes, bytes);
    row("transient memory", (item) => item.data.memory?.transient_bytes, bytes);
    return element("div", { class: "scroll" }, element("table", { class: "figures" },
      element("thead", {}, element("tr", {}, ...["", "A", "B", "B / A"].map((text) => element("th", { scope: "col" }, text)))),
      element("tbody", {}, ...rows.map((r) => element("tr", { class: r.different && A && B ? "different" : undefined },
        element("th", { scope: "row" }, r.label), element("td", {}, r.a), element("td", {}, r.b), element("td", {}, r.ratio))))));
  }
}
