/** Every configuration in figures, sortable, with the command that measures it again. */
import { copy, element } from "./dom.js";
import { figure, setting } from "./format.js";

const MOST = 500;

export class Table {
  /** @param {{table: HTMLElement, more: HTMLElement, copied: HTMLElement, pin: (item, name) => void, mark: (key) => void}} parts */
  constructor(parts) {
    Object.assign(this, parts);
    this.sort = { column: "product", up: true };
    this.all = false;
  }

  columns(view, dims) {
    const time = (item) => item.times[view.time], error = (item) => item.errors[view.error];
    const several = (d) => new Set(view.items.map(d.of)).size > 1;
    const columns = dims.filter((d) => d.id === "graph" || (d.id === "scene" ? several(d) : d.values.length > 1)).map((d) => ({ id: d.id, label: d.label, of: d.of, text: setting, number: d.numeric }));
    columns.push(
      { id: "time", label: "ms", of: (i) => time(i)?.[0], text: figure, number: true },
      { id: "p95", label: "p95", of: (i) => time(i)?.[2] ?? undefined, text: figure, number: true },
      { id: "error", label: "error", of: (i) => error(i)?.[0], text: figure, number: true },
      { id: "interval", label: "95 % interval", of: (i) => (error(i) && error(i)[2] !== null ? error(i)[2] - (error(i)[1] ?? 0) : undefined), number: true,
        text: (_, i) => (error(i) && error(i)[2] !== null ? `${figure(error(i)[1])} … ${figure(error(i)[2])}` : "–") },
      { id: "product", label: "error × ms", of: (i) => (time(i) && error(i) ? time(i)[0] * error(i)[0] : undefined), text: figure, number: true });
    if (view.items.some((i) => i.data.floor?.multiple)) columns.push({ id: "floor", label: "× floor", of: (i) => i.data.floor?.multiple, text: figure, number: true });
    columns.push({ id: "front", label: "front", of: (i) => (view.front.has(i.key) ? true : undefined), text: (v) => (v ? "●" : ""), number: false });
    return columns;
  }

  sorted(items, columns) {
    const column = columns.find((c) => c.id === this.sort.column) ?? columns.at(-1);
    const sign = this.sort.up ? 1 : -1;
    // Whatever has no figure stays at the end, either way.
    return items.map((item) => [item, column.of(item)]).sort(([a, x], [b, y]) => {
      if (x === undefined || y === undefined) return (x === undefined) - (y === undefined) || a.key - b.key;
      const order = typeof x === "number" && typeof y === "number" ? x - y : String(x).localeCompare(String(y), "en", { numeric: true });
      return sign * order || a.key - b.key;
    }).map(([item]) => item);
  }

  /** @param {{items: Item[], front: Set<number>, time: number, error: number, pins: object}} view */
  update(view, dims) {
    Object.assign(this, { view, dims });
    const columns = this.columns(view, dims), focus = document.activeElement?.dataset?.column;
    const head = columns.map((c) => {
      const current = this.sort.column === c.id;
      return element("th", { scope: "col", "aria-sort": current ? (this.sort.up ? "ascending" : "descending") : undefined, class: c.number ? "number" : undefined },
        element("button", { type: "button", "data-column": c.id, onclick: () => this.by(c.id) }, c.label, element("span", { "aria-hidden": "true" }, current ? (this.sort.up ? " ▲" : " ▼") : "")));
    });
    const rows = this.sorted(view.items, columns), shown = this.all ? rows : rows.slice(0, MOST);
    this.table.replaceChildren(
      element("thead", {}, element("tr", {}, element("th", { scope: "col" }, element("span", { class: "hidden" }, "compare, copy the command")), ...head, element("th", { scope: "col" }, "command"))),
      element("tbody", {}, ...shown.map((item) => this.row(item, columns))));
    if (focus) this.table.querySelector(`[data-column="${CSS.escape(focus)}"]`)?.focus({ preventScroll: true });
    this.more.replaceChildren(rows.length > shown.length
      ? element("button", { type: "button", onclick: () => { this.all = true; this.update(this.view, this.dims); } }, `Show all ${rows.length} rows`) : "");
  }

  by(id) {
    this.sort = { column: id, up: this.sort.column === id ? !this.sort.up : true };
    this.update(this.view, this.dims);
  }

  row(item, columns) {
    const pin = (name) => element("button", {
      type: "button", class: "pin", "aria-pressed": String(this.view.pins[name] === item), "aria-label": `${item.data.id} as ${name}`, onclick: () => this.pin(item, name),
    }, name);
    const command = item.data.command;
    const copyButton = command && element("button", { type: "button", class: "copy", "aria-label": `copy the command of ${item.data.id}`, onclick: () => this.copy(item) }, "copy");
    const tr = element("tr", { class: this.view.front.has(item.key) ? "front" : undefined, "data-key": item.key },
      element("td", { class: "pins" }, pin("A"), pin("B"), copyButton),
      ...columns.map((c) => {
        const text = c.text(c.of(item), item);
        return element("td", { class: c.number ? "number" : undefined, title: c.id === "graph" ? `${item.data.name} ${item.data.id}` : c.number ? undefined : text }, text);
      }),
      element("td", { class: "command" }, command ? element("code", { title: command }, command) : "–"));
    tr.addEventListener("pointerenter", () => this.mark(item.key));
    tr.addEventListener("pointerleave", () => this.mark(undefined));
    return tr;
  }

  /** Only what is pinned has changed. */
  showPins(pins) {
    this.view.pins = pins;
    for (const button of this.table.querySelectorAll(".pin")) {
      const item = pins[button.textContent];
      button.setAttribute("aria-pressed", String(item !== undefined && String(item.key) === button.closest("tr").dataset.key));
    }
  }

  async copy(item) {
    const done = await copy(item.data.command);
    this.copied.textContent = done ? `Copied the command of ${item.data.id}` : "The browser did not allow copying";
    const button = this.table.querySelector(`[data-key="${item.key}"] .copy`);
    if (!button) return;
    button.textContent = done ? "copied" : "no";
    setTimeout(() => (button.textContent = "copy"), 1500);
  }
}
