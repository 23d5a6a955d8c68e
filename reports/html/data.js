// The records of the page, and what of them the filters let through.

const data = JSON.parse(document.getElementById("data").textContent);
for (const section of data.sections)
  section.rows = section.rows.map((row) => Object.fromEntries(data.columns.map((name, i) => [name, row[i]])));

const filter = {
  section: new Set(data.sections.keys()),
  spec: new Set(data.specs.keys()),
  batch: new Set(data.batches.keys()),
};

const shownSpecs = (section) => section.specs.filter((spec) => filter.spec.has(spec));
const shownBatches = (section) => section.batches.filter((batch) => filter.batch.has(batch));
const shownRows = (section) => section.rows.filter((row) => filter.spec.has(row.spec) && filter.batch.has(row.batch));
const rowOf = (section, spec, batch) => section.rows.find((row) => row.spec === spec && row.batch === batch);

const isFault = (row) => row.status !== "ok" || /WRONG|unexamined/.test(row.grade);

/// The fastest setting of the baseline's own kind on these rays, where there are several.
function envelopeOf(section, batch) {
  const kind = data.specs[section.baseline].structure;
  const rivals = section.rows.filter((row) => row.batch === batch && row.ratio !== null && data.specs[row.spec].structure === kind);
  return rivals.length > 1 ? rivals.reduce((a, b) => (b.ratio > a.ratio ? b : a)) : null;
}

const theme = () => {
  const style = getComputedStyle(document.documentElement);
  return (name) => style.getPropertyValue(`--${name}`).trim();
};
let colour = theme();
const colourOf = (spec) => colour(`c${data.specs[spec].colour}`);

/// Specs of one structure share its colour; dashes tell their lines apart.
const dashes = [[], [7, 3], [2, 2], [8, 3, 2, 3], [12, 3], [4, 2, 1, 2]];
function dashOf(section, spec) {
  const alike = section.specs.filter((other) => data.specs[other].structure === data.specs[spec].structure);
  return dashes[alike.indexOf(spec) % dashes.length];
}
