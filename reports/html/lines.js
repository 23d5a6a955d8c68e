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

/// A structure over one parameter: time, steps and tests for each ray kind, memory and build time.
function sweepPanels(section, sweep) {
  const batches = shownBatches(section);
  const specs = sweep.specs.filter((spec) => filter.spec.has(spec));
  if (!specs.length || !batches.length) return [];
  const xOf = (spec) => sweep.values[sweep.specs.indexOf(spec)];
  const own = colour(`c${data.specs[specs[0]].colour}`);
  const isWide = xOf(specs[0]) > 0 && xOf(specs.at(-1)) / xOf(specs[0]) >= 6;
  const measures = [
    ["time per ray", "ns", (row) => (row.mrays_per_s ? 1e3 / row.mrays_per_s : null), batches],
    ["steps per ray", "", (row) => row.steps_per_ray, batches],
    ["tests per ray", "", (row) => row.tests_per_ray, batches],
    ["memory held", "MB", (row) => (row.bytes === null ? null : row.bytes / 1e6), batches.slice(0, 1)],
    ["build time", "ms", (row) => (row.build_s === null ? null : row.build_s * 1e3), batches.slice(0, 1)],
  ];
  const points = ["circle", "rect", "triangle", "rectRot", "star", "crossRot"];
  return measures.flatMap(([title, unit, value, over]) => {
    const datasets = over.map((batch, i) => {
      const curve = specs.map((spec) => ({ spec, row: rowOf(section, spec, batch) })).filter(({ row }) => row && value(row) !== null)
        .map(({ spec, row }) => ({ x: xOf(spec), y: value(row), row }));
      const least = curve.reduce((best, point, at) => (best < 0 || point.y < curve[best].y ? at : best), -1);
      return {
        label: over.length > 1 ? data.batches[batch] : "", data: curve, least, borderColor: own, backgroundColor: own,
        borderDash: dashes[i % dashes.length], borderWidth: 1.8, pointRadius: 3, pointStyle: points[i % points.length], pointHoverRadius: 5,
      };
    }).filter((set) => set.data.length);
    if (!datasets.length) return [];
    return [{
      title: unit ? `${title} (${unit})` : title, height: 240,
      legend: over.length > 1 ? datasets.map((set) => ({ text: set.label, colour: own, dash: set.borderDash })) : null,
      csv: datasets.flatMap((set) => set.data.map(({ x, y }) => ({ measure: title, unit, rays: set.label, [sweep.parameter]: x, value: y }))),
      config: {
        type: "line",
        data: { datasets },
        options: {
          interaction: { mode: "nearest", intersect: false },
          layout: { padding: { top: 8, right: 14 } },
          scales: {
            x: isWide
              ? { type: "logarithmic", title: { display: true, text: sweep.parameter }, grid: { display: false },
                afterBuildTicks: (axis) => { axis.ticks = specs.map((spec) => ({ value: xOf(spec) })); }, ticks: { callback: brief, maxRotation: 0 } }
              : { type: "linear", title: { display: true, text: sweep.parameter }, grid: { display: false }, ticks: { callback: brief } },
            y: { beginAtZero: true, ticks: { callback: brief }, title: { display: false } },
          },
          plugins: {
            tooltip: {
              callbacks: {
                title: ([item]) => `${sweep.parameter} = ${item.raw.x}`,
                label: (item) => `${digits(item.raw.y)}${unit ? ` ${unit}` : ""}  ${item.dataset.label}${item.raw.row.note ? `  (${shortened(item.raw.row.note, 60)})` : ""}`,
              },
            },
          },
        },
        plugins: [leastMarks],
      },
    }];
  });
}
