// Charts with curves.

/// Ticks at powers of ten only.
const decades = (most) => ({
  type: "logarithmic",
  afterBuildTicks: (axis) => {
    axis.ticks = axis.ticks.filter((tick) => isPowerOfTen(tick.value));
    const every = Math.ceil(axis.ticks.length / most);
    axis.ticks = axis.ticks.filter((tick) => Math.round(Math.log10(tick.value)) % every === 0);
  },
});

function breakEvenPanels(section) {
  const counts = Array.from({ length: 29 }, (_, i) => 10 ** (3 + i / 4));
  return shownBatches(section).flatMap((batch) => {
    const rows = shownSpecs(section).map((spec) => rowOf(section, spec, batch)).filter((row) => row && row.build_s !== null && row.mrays_per_s > 0);
    if (!rows.length) return [];
    const datasets = rows.map((row) => ({
      label: data.specs[row.spec].label,
      data: counts.map((x) => ({ x, y: row.build_s + x / (row.mrays_per_s * 1e6) })),
      borderColor: colourOf(row.spec), backgroundColor: colourOf(row.spec), borderDash: dashOf(section, row.spec),
      borderWidth: row.spec === section.baseline ? 2.6 : 1.8, pointRadius: 0, pointHoverRadius: 4,
    }));
    return [{
      title: data.batches[batch], height: 290,
      legend: datasets.map((set) => ({ text: set.label, colour: set.borderColor, dash: set.borderDash })),
      csv: rows.flatMap((row, i) => datasets[i].data.map(({ x, y }) => ({ rays: data.batches[batch], structure: datasets[i].label, count: Math.round(x), seconds: y }))),
      config: {
        type: "line",
        data: { datasets },
        options: {
          interaction: { mode: "index", axis: "x", intersect: false },
          scales: {
            x: { ...decades(8), min: 1e3, max: 1e10, title: { display: true, text: "rays" }, ticks: { maxRotation: 0, callback: brief } },
            y: { ...decades(8), title: { display: true, text: "build + trace" }, ticks: { callback: briefSeconds } },
          },
          plugins: {
            tooltip: {
              itemSort: (a, b) => a.raw.y - b.raw.y,
              callbacks: { title: ([item]) => `${brief(item.raw.x)} rays`, label: (item) => `${seconds(item.raw.y)}  ${item.dataset.label}` },
            },
          },
        },
      },
    }];
  });
}

const pointStyles = ["circle", "rect", "triangle", "rectRot", "star", "crossRot"];

/// A panel with curves over a parameter. A line: {label, colour, dash, points: [{x, y, row}]}.
function curvePanel(title, unit, parameter, lines, marksLeast) {
  const drawn = lines.filter((line) => line.points.length);
  if (!drawn.length) return [];
  const xs = [...new Set(drawn.flatMap((line) => line.points.map((point) => point.x)))].sort((a, b) => a - b);
  const ys = drawn.flatMap((line) => line.points.map((point) => point.y));
  const isWide = xs[0] > 0 && xs.at(-1) / xs[0] >= 6;
  const isTall = Math.min(...ys) > 0 && Math.max(...ys) / Math.min(...ys) > 30;
  const datasets = drawn.map((line, i) => ({
    label: line.label, data: line.points, borderColor: line.colour, backgroundColor: line.colour, borderDash: line.dash,
    least: !marksLeast ? -1 : line.points.reduce((best, point, at) => (best < 0 || point.y < line.points[best].y ? at : best), -1),
    borderWidth: 1.8, pointRadius: 3, pointStyle: pointStyles[i % pointStyles.length], pointHoverRadius: 5,
  }));
  const x = { title: { display: true, text: parameter }, grid: { display: false }, ticks: { callback: brief, maxRotation: 0 } };
  return [{
    title: unit ? `${title} (${unit})` : title, height: 240,
    legend: drawn.length > 1 ? datasets.map((set) => ({ text: set.label, colour: set.borderColor, dash: set.borderDash })) : null,
    csv: datasets.flatMap((set) => set.data.map((point) => ({ measure: title, unit, curve: set.label, [parameter]: point.x, value: point.y }))),
    config: {
      type: "line",
      data: { datasets },
      options: {
        interaction: { mode: "nearest", intersect: false },
        layout: { padding: { top: 8, right: 14 } },
        scales: {
          x: isWide ? { ...x, type: "logarithmic", min: xs[0] / 1.15, max: xs.at(-1) * 1.15, afterBuildTicks: (axis) => { axis.ticks = xs.map((value) => ({ value })); } } : { ...x, type: "linear" },
          y: isTall ? { ...decades(8), ticks: { callback: brief } } : { beginAtZero: true, ticks: { callback: brief } },
        },
        plugins: {
          tooltip: {
            callbacks: {
              title: ([item]) => `${parameter} = ${item.raw.x}`,
              label: (item) => `${digits(item.raw.y)}${unit ? ` ${unit}` : ""}  ${item.dataset.label}${item.raw.row.note ? `  (${shortened(item.raw.row.note, 60)})` : ""}`,
            },
          },
        },
      },
      plugins: [leastMarks],
    },
  }];
}

const measures = [
  ["time per ray", "ns", (row) => (row.mrays_per_s ? 1e3 / row.mrays_per_s : null)],
  ["steps per ray", "", (row) => row.steps_per_ray],
  ["tests per ray", "", (row) => row.tests_per_ray],
  ["memory held", "MB", (row) => (row.bytes === null ? null : row.bytes / 1e6)],
  ["build time", "ms", (row) => (row.build_s === null ? null : row.build_s * 1e3)],
];
const dependsOnRays = (title) => /per ray/.test(title);

/// A structure over one parameter of its own: a line for each ray kind.
function sweepPanels(section, sweep) {
  const batches = shownBatches(section);
  const specs = sweep.specs.filter((spec) => filter.spec.has(spec));
  if (!specs.length) return [];
  const own = colour(`c${data.specs[specs[0]].colour}`);
  return measures.flatMap(([title, unit, value]) => curvePanel(title, unit, sweep.parameter,
    (dependsOnRays(title) ? batches : batches.slice(0, 1)).map((batch, i) => ({
      label: dependsOnRays(title) ? data.batches[batch] : "", colour: own, dash: dashes[i % dashes.length],
      points: specs.map((spec) => ({ spec, row: rowOf(section, spec, batch) })).filter(({ row }) => row && value(row) !== null)
        .map(({ spec, row }) => ({ x: sweep.values[sweep.specs.indexOf(spec)], y: value(row), row })),
    })), true));
}

/// Structures over one parameter of the scenes: a line for each structure, a panel for each ray kind.
function scenePanels(sweep) {
  const shown = sweep.sections.map((index, i) => ({ index, section: data.sections[index], x: sweep.values[i] })).filter(({ index }) => filter.section.has(index));
  if (!shown.length) return [];
  const all = [...new Set(shown.flatMap(({ section }) => section.specs))];
  const specs = all.filter((spec) => filter.spec.has(spec));
  const batches = [...new Set(shown.flatMap(({ section }) => shownBatches(section)))];
  return measures.flatMap(([title, unit, value]) => (dependsOnRays(title) ? batches : batches.slice(0, 1)).flatMap((batch) =>
    curvePanel(dependsOnRays(title) ? `${title}: ${data.batches[batch]}` : title, unit, sweep.parameter, specs.map((spec) => ({
      label: data.specs[spec].label, colour: colourOf(spec), dash: dashOf({ specs: all }, spec),
      points: shown.map(({ section, x }) => ({ x, row: rowOf(section, spec, batch) })).filter(({ row }) => row && value(row) !== null)
        .map(({ x, row }) => ({ x, y: value(row), row })),
    })), false)));
}
