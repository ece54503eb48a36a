/** What colours and shapes stand for: beside the chart as HTML, and inside a saved SVG. */
import * as d3 from "d3";
import { setting } from "./format.js";

const SHAPES = { circle: d3.symbolCircle, square: d3.symbolSquare, triangle: d3.symbolTriangle, diamond: d3.symbolDiamond, cross: d3.symbolCross, star: d3.symbolStar, wye: d3.symbolWye };
const path = (name) => d3.symbol(SHAPES[name], 80)();

/**
 * Entries of two lists, or of one when colour and shape say the same.
 * @returns {{label: string, entries: {text: string, color?: string, symbol: string}[]}[]}
 */
export function legendOf(colorDimension, graphs, colors, symbols, theme) {
  const merged = colorDimension.id === "graph";
  const lists = [{
    label: colorDimension.label,
    entries: [...colors].map(([value, color]) => ({ text: value === undefined ? "not there" : setting(value), color, symbol: merged ? symbols.get(value) : "circle" })),
  }];
  if (!merged && graphs.values.length > 1)
    lists.push({ label: graphs.label, entries: [...symbols].map(([value, symbol]) => ({ text: setting(value), color: theme.soft, symbol })) });
  return lists;
}

const SVG = "http://www.w3.org/2000/svg";
function shape(entry) {
  const node = document.createElementNS(SVG, "path");
  node.setAttribute("d", path(entry.symbol));
  node.setAttribute("fill", entry.color);
  return node;
}

export function showLegend(into, lists) {
  into.replaceChildren(...lists.map((list) => {
    const ul = document.createElement("ul");
    const head = document.createElement("li");
    head.className = "head";
    head.textContent = list.label;
    ul.append(head, ...list.entries.map((entry) => {
      const li = document.createElement("li"), svg = document.createElementNS(SVG, "svg");
      svg.setAttribute("viewBox", "-8 -8 16 16");
      svg.setAttribute("aria-hidden", "true");
      svg.append(shape(entry));
      li.append(svg, entry.text);
      return li;
    }));
    return ul;
  }));
}

/** A whole document: title, chart, legend on its right. */
export function standalone(chart, lists, title, theme) {
  const width = Number(chart.getAttribute("width")), height = Number(chart.getAttribute("height"));
  const svg = document.createElementNS(SVG, "svg");
  const all = { width: width + 220, height: height + 40 };
  for (const [k, v] of Object.entries({ ...all, viewBox: `0 0 ${all.width} ${all.height}`, "font-family": "system-ui, sans-serif", "font-size": 12, fill: theme.ink }))
    svg.setAttribute(k, v);
  const add = (name, attributes, text) => {
    const node = document.createElementNS(SVG, name);
    for (const [k, v] of Object.entries(attributes)) node.setAttribute(k, v);
    if (text !== undefined) node.textContent = text;
    svg.append(node);
    return node;
  };
  add("title", {}, title);
  add("rect", { width: all.width, height: all.height, fill: theme.paper });
  add("text", { x: 16, y: 26, "font-size": 17, "font-weight": 600 }, title);
  chart.setAttribute("y", 40);
  svg.append(chart);
  let y = 80;
  for (const list of lists) {
    add("text", { x: width + 12, y, "font-weight": 600 }, list.label);
    for (const entry of list.entries) {
      y += 20;
      const node = shape(entry);
      node.setAttribute("transform", `translate(${width + 20} ${y - 4})`);
      svg.append(node);
      add("text", { x: width + 34, y }, entry.text);
    }
    y += 32;
  }
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(svg)}\n`;
}
