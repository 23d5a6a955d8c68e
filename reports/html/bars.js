// Charts with a row for each structure.

const rowHeight = 24;

/// What is common to them: structures down the side, one scale across.
function rowChart(specs, bars, colours, marks, x, tooltip) {
  return {
    type: "bar",
    data: {
      labels: specs.map((spec) => shortened(data.specs[spec].label, 26)),
      datasets: [{ data: bars, backgroundColor: colours, barThickness: 13, minBarLength: 1 }],
      marks,
    },
    options: {
      indexAxis: "y",
      interaction: { mode: "y", intersect: false },
      layout: { padding: { top: 14 } },
      scales: { x, y: { grid: { display: false }, ticks: { color: colour("ink"), autoSkip: false } } },
      plugins: { tooltip: { callbacks: tooltip } },
    },
    plugins: [rowMarks],
  };
}

/// A panel: a title, a chart and its height, and the rows of its CSV.
function ratioPanels(section) {
  const rows = shownRows(section);
  const most = Math.max(1, ...rows.map((row) => row.ratio_high ?? row.ratio ?? 0));
  return shownBatches(section).flatMap((batch) => {
    const shown = shownSpecs(section).map((spec) => rowOf(section, spec, batch)).filter(Boolean);
    if (!shown.length) return [];
    const marks = shown.map((row) => ({
      interval: row.ratio_low === null ? null : [row.ratio_low, row.ratio_high],
      text: row.ratio === null ? row.grade + (row.status === "ok" ? ", no ratio" : "")
        : `${digits(row.ratio)}${row.noisy ? " ~" : ""}${isFault(row) ? `  ${row.grade}` : ""}`,
      textAt: row.ratio === null ? 0 : row.ratio_high ?? row.ratio,
      bad: isFault(row),
    }));
    const config = rowChart(shown.map((row) => row.spec), shown.map((row) => row.ratio),
      shown.map((row) => (row.noisy ? stripes(colourOf(row.spec)) : colourOf(row.spec))), marks,
      { min: 0, max: most * 1.22, ticks: { callback: (value) => (value > most * 1.15 ? "" : brief(value)) } },
      {
        title: ([item]) => data.specs[shown[item.dataIndex].spec].label,
        label: (item) => {
          const row = shown[item.dataIndex];
          return [
            row.ratio === null ? "no ratio" : `ratio ${digits(row.ratio)}${row.ratio_low === null ? "" : ` (${digits(row.ratio_low)} to ${digits(row.ratio_high)})`}`,
            row.mrays_per_s === null ? "" : `${digits(row.mrays_per_s)} Mray/s`,
            `answers: ${row.grade}`, row.noisy ? "noisy" : "", shortened(row.note || "", 90),
          ].filter(Boolean);
        },
      });
    const best = envelopeOf(section, batch);
    config.data.rules = [{ at: 1, dash: [], text: "" }];
    if (best && best.ratio > 1.02)
      config.data.rules.push({ at: best.ratio, dash: [4, 3], text: `envelope: ${shortened(data.specs[best.spec].label, 30)}` });
    return [{
      title: data.batches[batch], config, height: shown.length * rowHeight + 50,
      csv: shown.map((row) => ({ rays: data.batches[batch], structure: data.specs[row.spec].label, ratio: row.ratio,
        ratio_low: row.ratio_low, ratio_high: row.ratio_high, mrays_per_s: row.mrays_per_s, noisy: row.noisy, grade: row.grade })),
    }];
  });
}

/// Steps and tests: mean and distribution, on a logarithmic scale that has a place for 0.
function workPanels(section) {
  const zero = 0.5;
  const place = (value) => Math.max(value ?? 0, zero);
  const panels = [];
  for (const batch of shownBatches(section)) {
    for (const what of ["steps", "tests"]) {
      const shown = shownSpecs(section).map((spec) => rowOf(section, spec, batch)).filter((row) => row && row.steps_per_ray !== null);
      if (!shown.length) continue;
      const most = Math.max(4, ...shown.map((row) => row[`${what}_max`]));
      const marks = shown.map((row) => ({
        line: [place(row[`${what}_p50`]), place(row[`${what}_max`])],
        tick: place(row[`${what}_p90`] ?? row[`${what}_p99`]),
        dot: place(row[`${what}_per_ray`]),
        colour: colourOf(row.spec),
        text: digits(row[`${what}_per_ray`]),
        textAt: place(row[`${what}_max`]),
      }));
      const config = rowChart(shown.map((row) => row.spec),
        shown.map((row) => [place(row[`${what}_p50`]), Math.max(place(row[`${what}_p99`]), place(row[`${what}_p50`]) * 1.02)]),
        shown.map((row) => colourOf(row.spec)), marks,
        {
          type: "logarithmic", min: zero, max: most * 4,
          afterBuildTicks: (axis) => {
            axis.ticks = [{ value: zero }];
            for (let value = 1; value <= most * 2; value *= 10) axis.ticks.push({ value });
          },
          ticks: { callback: (value) => (value === zero ? "0" : brief(value)) },
        },
        {
          title: ([item]) => data.specs[shown[item.dataIndex].spec].label,
          label: (item) => {
            const row = shown[item.dataIndex];
            return [`mean ${digits(row[`${what}_per_ray`])} ${what} per ray`,
              ...["p50", "p90", "p99", "max"].map((of) => `${of} ${row[`${what}_${of}`]?.toLocaleString("en") ?? "-"}`)];
          },
        });
      panels.push({
        title: `${what} per ray: ${data.batches[batch]}`, config, height: shown.length * rowHeight + 46,
        csv: shown.map((row) => ({ rays: data.batches[batch], structure: data.specs[row.spec].label, measure: what,
          mean: row[`${what}_per_ray`], p50: row[`${what}_p50`], p90: row[`${what}_p90`], p99: row[`${what}_p99`], max: row[`${what}_max`] })),
      });
    }
  }
  return panels;
}

/// All ratios of the page: a dot for each scene and ray kind, a diamond for their geometric mean.
function overviewPanels() {
  const sections = data.sections.filter((section, i) => filter.section.has(i));
  const points = sections.flatMap((section) =>
    shownRows(section).filter((row) => row.ratio > 0).map((row) => ({ section, row })));
  const specs = [...data.specs.keys()].filter((spec) => filter.spec.has(spec) && sections.some((section) => section.specs.includes(spec)));
  if (!points.length) return [];
  const dots = points.map(({ section, row }) => ({ x: row.ratio, y: specs.indexOf(row.spec), section, row }));
  const means = specs.map((spec, y) => ({ x: geometricMean(dots.filter((dot) => dot.y === y).map((dot) => dot.x)), y, spec }))
    .filter((mean) => mean.x > 0);
  const low = Math.min(...dots.map((dot) => dot.x)), high = Math.max(...dots.map((dot) => dot.x), 1);
  const config = {
    type: "scatter",
    data: {
      datasets: [
        { data: means, pointStyle: "rectRot", radius: 8, hoverRadius: 9, borderWidth: 1.5, borderColor: colour("paper"),
          backgroundColor: means.map((mean) => colourOf(mean.spec)) },
        { data: dots, radius: 3.5, hoverRadius: 5, borderWidth: 0, backgroundColor: dots.map((dot) => `${colourOf(dot.row.spec)}99`) },
      ],
      marks: specs.map((spec, y) => {
        const mean = means.find((candidate) => candidate.y === y);
        return mean ? { text: digits(mean.x), textAt: Infinity } : { text: "failed", textAt: Infinity, bad: true };
      }),
      rules: [{ at: 1, dash: [], text: "" }],
    },
    options: {
      layout: { padding: { top: 6, right: 54 } },
      scales: {
        x: {
          type: "logarithmic", min: low * 0.85, max: high * 1.15,
          afterBuildTicks: (axis) => {
            axis.ticks = [];
            for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power)
              for (const step of high / low > 300 ? [1] : [1, 2, 5])
                if (step * 10 ** power >= low * 0.85 && step * 10 ** power <= high * 1.1) axis.ticks.push({ value: step * 10 ** power });
          },
          ticks: { callback: (value) => brief(value) },
        },
        y: {
          min: -0.6, max: specs.length - 0.4, reverse: true, grid: { display: false },
          afterBuildTicks: (axis) => { axis.ticks = specs.map((spec, value) => ({ value })); },
          ticks: { color: colour("ink"), autoSkip: false, callback: (value) => shortened(data.specs[specs[value]].label, 26) },
        },
      },
      plugins: {
        tooltip: {
          callbacks: {
            title: ([{ raw }]) => data.specs[raw.spec ?? raw.row.spec].label,
            label: ({ raw }) => (raw.row
              ? [`ratio ${digits(raw.x)}`, `${shortened(raw.section.title, 50)}, ${data.batches[raw.row.batch]}`]
              : `geometric mean ${digits(raw.x)}`),
          },
        },
      },
    },
    plugins: [rowMarks],
  };
  return [{
    title: "", config, height: Math.max(120, specs.length * 30 + 44),
    csv: dots.map((dot) => ({ scene: dot.section.title, rays: data.batches[dot.row.batch], structure: data.specs[dot.row.spec].label, ratio: dot.x })),
  }];
}
