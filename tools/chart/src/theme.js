/** Colours of the chart in light and dark. Those that tell things apart are Okabe and Ito's, made lighter or darker so
    that each has a contrast of 3:1 and more with the page. */
import { interpolatePlasma } from "d3";

export const THEMES = {
  light: {
    paper: "#ffffff", ink: "#1c2127", soft: "#5b6570", line: "#d9dee3", guide: "#8f99a3", front: "#1c2127",
    categories: ["#0072b2", "#d55e00", "#00805c", "#b5559a", "#8a6d00", "#2f86bf", "#6b4fa0"],
    other: "#6f7780", ramp: [0, 0.64],
  },
  dark: {
    paper: "#14181d", ink: "#e8ebee", soft: "#a7b0b9", line: "#2d343c", guide: "#6f7a85", front: "#e8ebee",
    categories: ["#56b4e9", "#f08a3c", "#2fc79a", "#e39fcf", "#e2c83d", "#8fb8ff", "#b79cf0"],
    other: "#939ca5", ramp: [0.4, 1],
  },
};

export const SYMBOLS = ["circle", "square", "triangle", "diamond", "cross", "star", "wye"];

/** A colour for each value: a ramp over numbers in their order, else categories; "other" beyond those. */
export function colorsOf(dimension, theme) {
  const given = dimension.values.filter((v) => v.value !== undefined);
  const [from, to] = theme.ramp;
  const colors = new Map();
  given.forEach((v, i) => {
    const ramp = dimension.numeric && given.length > 2;
    colors.set(v.value, ramp ? interpolatePlasma(from + ((to - from) * i) / (given.length - 1)) : theme.categories[i] ?? theme.other);
  });
  if (given.length < dimension.values.length) colors.set(undefined, theme.other);
  return colors;
}

/** The shape of each graph. */
export const symbolsOf = (graphs) => new Map(graphs.values.map((v, i) => [v.value, SYMBOLS[i % SYMBOLS.length]]));
