/** Figures as text. */

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";
const exponent = (n) => (n < 0 ? "⁻" : "") + [...String(Math.abs(n))].map((d) => SUPERSCRIPTS[d]).join("");

/** Three digits: "0.0123", "4.56", "1.23×10⁻⁵". */
export function figure(value) {
  if (value === undefined || value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-4 && size < 1e5) return String(Number(value.toPrecision(3)));
  const [digits, power] = value.toExponential(2).split("e");
  return `${Number(digits)}×10${exponent(Number(power))}`;
}

/** A tick of a logarithmic axis: as short as it can be. */
export function tick(value) {
  const size = Math.abs(value);
  if (size >= 1e-4 && size < 1e5) return String(Number(value.toPrecision(6)));
  const [digits, power] = value.toExponential().split("e");
  return `${Number(digits) === 1 ? "" : `${Number(digits)}×`}10${exponent(Number(power))}`;
}

export const milliseconds = (value) => (Number.isFinite(value) ? `${figure(value)} ms` : "–");

export function bytes(value) {
  if (!Number.isFinite(value)) return "–";
  return `${figure(value / 2 ** 20)} MiB`;
}

/** A parameter's value: bools as switches. */
export function setting(value) {
  if (value === undefined) return "–";
  if (value === true) return "on";
  if (value === false) return "off";
  return typeof value === "number" ? String(Number(value.toPrecision(6))) : String(value);
}
