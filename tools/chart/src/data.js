/** What the program wrote into the page, made ready for the rest: items (one a configuration) and their dimensions. */
import { setting } from "./format.js";

/** Every parameter that is known of a configuration; a pass that ran is enabled. */
function parametersOf(data) {
  const all = { ...data.parameters, ...data.settings };
  for (const pass of data.passes) all[`${pass.name}.enabled`] ??= true;
  return new Map(Object.entries(all));
}

/**
 * One configuration. `times` and `errors` hold, for each axis, [value, low, high] or null.
 * @typedef {{key: number, data: object, file: object, group: number, parameters: Map<string, any>,
 *            times: (number[]|null)[], errors: (number[]|null)[], pictures: (string|undefined)[]}} Item
 */

/** @returns {{title: string, items: Item[], groups: string[], raw: object}} */
export function readItems(raw) {
  const groupOf = [];
  raw.groups.forEach((group, g) => group.configurations.forEach((i) => (groupOf[i] = g)));
  const items = raw.configurations.map((c, key) => ({
    key,
    data: c.data,
    file: raw.files[c.file],
    group: groupOf[key],
    parameters: parametersOf(c.data),
    times: c.times,
    errors: c.errors,
    pictures: c.pictures.map((i) => (i < 0 ? undefined : `data:image/png;base64,${raw.pictures[i]}`)),
  }));
  // A pass that is in one graph and never switched off there is no switch in another.
  return { title: raw.title, items, groups: raw.groups.map((g) => g.label), raw };
}

function compareValues(a, b) {
  if (a === undefined || b === undefined) return (a === undefined) - (b === undefined);
  if (typeof a === "number" && typeof b === "number") return a - b;
  if (typeof a === "boolean" && typeof b === "boolean") return b - a;
  return String(a).localeCompare(String(b), "en", { numeric: true });
}

/**
 * A way to tell items apart that tells at least two apart.
 * @typedef {{id: string, label: string, of: (item: Item) => any, values: {value: any, text: string, count: number}[],
 *            numeric: boolean}} Dimension
 */

function dimension(id, label, items, of) {
  const counts = new Map();
  for (const item of items) counts.set(of(item), (counts.get(of(item)) ?? 0) + 1);
  const values = [...counts].sort((a, b) => compareValues(a[0], b[0])).map(([value, count]) => ({ value, text: setting(value), count }));
  const given = values.filter((v) => v.value !== undefined);
  return { id, label, of, values, numeric: given.length > 0 && given.every((v) => typeof v.value === "number") };
}

/** @returns {Dimension[]} scene and graph always, the rest where it varies: device, back end, passes, parameters */
export function dimensions(items, groups) {
  const result = [
    dimension("scene", "Scene", items, (item) => groups[item.group]),
    dimension("graph", "Graph", items, (item) => item.data.graph),
  ];
  for (const [id, label] of [["device", "Device"], ["trace", "Rays by"], ["weir", "Version"]]) {
    const d = dimension(id, label, items, (item) => item.file[id]);
    if (d.values.length > 1) result.push(d);
  }
  const names = new Set();
  for (const item of items) for (const name of item.parameters.keys()) names.add(name);
  const parameters = [];
  for (const name of names) {
    const isSwitch = name.endsWith(".enabled");
    const d = dimension(`parameter ${name}`, isSwitch ? `Pass ${name.slice(0, -8)}` : name, items, (item) => item.parameters.get(name));
    if (d.values.filter((v) => v.value !== undefined).length > 1) parameters.push({ ...d, isSwitch });
  }
  parameters.sort((a, b) => b.isSwitch - a.isSwitch || a.label.localeCompare(b.label, "en", { numeric: true }));
  return result.concat(parameters);
}

/** Those dimensions in which these items differ, without the scene. */
export function settingsText(item, dims) {
  return dims
    .filter((d) => d.id !== "scene" && d.id !== "graph" && d.of(item) !== undefined)
    .map((d) => `${d.label} ${setting(d.of(item))}`)
    .join(", ");
}
