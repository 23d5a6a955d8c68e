// Numbers for people: three digits, units, SI prefixes.

function digits(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "-";
  const size = Math.abs(value);
  if (size !== 0 && size < 0.01) return value.toExponential(1);
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3).replace(/\B(?=(\d{3})+$)/g, size >= 1000 ? "," : "");
}

const seconds = (value) =>
  value >= 1 ? `${digits(value)} s` : value >= 1e-3 ? `${digits(value * 1e3)} ms` : `${digits(value * 1e6)} µs`;

/// 1k, 20M, 0.5: for the ticks of axes.
function brief(value) {
  if (value === 0) return "0";
  for (const [size, suffix] of [[1e9, "G"], [1e6, "M"], [1e3, "k"]])
    if (Math.abs(value) >= size) return `${+(value / size).toPrecision(3)}${suffix}`;
  return `${+value.toPrecision(3)}`;
}

const briefSeconds = (value) =>
  value >= 1 ? `${brief(value)} s` : value >= 1e-3 ? `${brief(value * 1e3)} ms` : `${brief(value * 1e6)} µs`;

/// NaN of no values.
const geometricMean = (values) => Math.exp(values.reduce((sum, value) => sum + Math.log(value), 0) / values.length);

const shortened = (text, most) => (text.length > most ? `${text.slice(0, most - 1)}…` : text);

const isPowerOfTen = (value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;
