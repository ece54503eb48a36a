// What of the page needs no browser: the front, figures as text, dimensions and filters.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { dimensions, readItems } from "../../tools/chart/src/data.js";
import { Filters } from "../../tools/chart/src/filters.js";
import { bytes, figure, setting, tick } from "../../tools/chart/src/format.js";
import { paretoFront } from "../../tools/chart/src/pareto.js";

const { cases } = JSON.parse(readFileSync(new URL("pareto_cases.json", import.meta.url), "utf8"));
for (const { name, points, front } of cases)
  test(`front: ${name}`, () => {
    const on = paretoFront(points.map(([x, y]) => ({ x, y })));
    assert.deepEqual(on.flatMap((is, i) => (is ? [i] : [])), front);
  });

test("figures have three digits and no machine notation", () => {
  assert.deepEqual([0, 1, 4.5678, 123456, 0.0123456, 1.234e-5, -2e-9, null, NaN].map(figure), ["0", "1", "4.57", "1.23×10⁵", "0.0123", "1.23×10⁻⁵", "-2×10⁻⁹", "–", "–"]);
  assert.deepEqual([0.001, 0.02, 5, 1e-6, 2e-6, 1e12].map(tick), ["0.001", "0.02", "5", "10⁻⁶", "2×10⁻⁶", "10¹²"]);
  assert.equal(bytes(3 * 2 ** 20), "3 MiB");
  assert.deepEqual([true, false, undefined, 0.1 + 0.2, "even"].map(setting), ["on", "off", "–", "0.3", "even"]);
});

const raw = (...settings) => ({
  title: "t", groups: [{ label: "s", configurations: settings.map((_, i) => i) }], files: [{ device: "d" }], pictures: [],
  configurations: settings.map(([graph, values, passes]) => ({
    file: 0, pictures: [-1, -1, -1], times: [], errors: [], data: { graph, settings: values, parameters: { same: 1 }, passes: passes.map((name) => ({ name })) },
  })),
});

test("dimensions are what differs, numbers in their order, passes first", () => {
  const { items, groups } = readItems(raw(["a", { "p.n": 10, "q.enabled": true }, ["p", "q"]], ["a", { "p.n": 9, "q.enabled": false }, ["p"]], ["b", {}, ["r"]]));
  const dims = dimensions(items, groups);
  assert.deepEqual(dims.map((d) => d.label), ["Scene", "Graph", "Pass q", "p.n"]);
  assert.deepEqual(dims[3].values.map((v) => v.value), [9, 10, undefined]);
  assert.deepEqual(dims[2].values.map((v) => [v.text, v.count]), [["on", 1], ["off", 1], ["–", 1]]);
});

test("a filter hides values, and counts what the other filters leave", () => {
  const { items, groups } = readItems(raw(["a", { "p.n": 1 }, []], ["a", { "p.n": 2 }, []], ["b", { "p.n": 2 }, []]));
  const dims = dimensions(items, groups), filters = new Filters(dims, () => {});
  const shown = () => items.filter((item) => filters.passes(item)).map((item) => item.key);
  assert.deepEqual(shown(), [0, 1, 2]);
  filters.set("graph", "a", false);
  assert.deepEqual(shown(), [2]);
  assert.equal(filters.counts(dims.find((d) => d.label === "p.n"), items).get(1), undefined);
  assert.equal(filters.counts(dims.find((d) => d.id === "graph"), items).get("a"), 2);
  filters.reset();
  assert.deepEqual(shown(), [0, 1, 2]);
});
