/** Checkboxes of every value of every dimension. */
import { element } from "./dom.js";

export class Filters {
  /** @param {import("./data.js").Dimension[]} dimensions */
  constructor(dimensions, changed) {
    this.dimensions = dimensions.filter((d) => d.values.length > 1);
    this.hidden = new Map(this.dimensions.map((d) => [d.id, new Set()]));
    this.changed = changed;
  }

  passes(item) {
    return this.dimensions.every((d) => !this.hidden.get(d.id).has(d.of(item)));
  }

  set(id, value, shown) {
    const set = this.hidden.get(id);
    if (shown) set.delete(value);
    else set.add(value);
  }

  reset() {
    for (const set of this.hidden.values()) set.clear();
  }

  /** Items that a value would show, were it the only one that is chosen: the others' choice stays. */
  counts(dimension, items) {
    const counts = new Map();
    for (const item of items) {
      if (this.dimensions.some((d) => d !== dimension && this.hidden.get(d.id).has(d.of(item)))) continue;
      counts.set(dimension.of(item), (counts.get(dimension.of(item)) ?? 0) + 1);
    }
    return counts;
  }

  /** Builds the controls once; update() keeps them current, so that the focus stays where it is. */
  show(into) {
    this.rows = [];
    into.replaceChildren(...this.dimensions.map((d) => {
      const fieldset = element("fieldset", {}, element("legend", {}, d.label));
      for (const v of d.values) {
        const box = element("input", { type: "checkbox" });
        box.addEventListener("change", () => {
          this.set(d.id, v.value, box.checked);
          this.changed();
        });
        const count = element("span", { class: "count" });
        const text = v.value === undefined ? "not there" : v.text;
        const only = element("button", { type: "button", class: "only", "aria-label": `only ${d.label} ${text}` }, "only");
        only.addEventListener("click", () => {
          for (const other of d.values) this.set(d.id, other.value, other === v);
          this.changed();
        });
        fieldset.append(element("div", { class: "value" }, element("label", { title: text }, box, element("span", { class: "text" }, text), count), only));
        this.rows.push({ d, v, box, count });
      }
      return fieldset;
    }));
  }

  update(items) {
    const counts = new Map(this.dimensions.map((d) => [d, this.counts(d, items)]));
    for (const { d, v, box, count } of this.rows) {
      box.checked = !this.hidden.get(d.id).has(v.value);
      count.textContent = counts.get(d).get(v.value) ?? 0;
    }
  }
}
