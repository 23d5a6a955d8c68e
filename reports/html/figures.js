// Figures: panels of charts, drawn when they are about to be seen; their legends, and their PNG and CSV.

const builders = {
  overview: () => overviewPanels(),
  ratio: (section) => ratioPanels(section),
  work: (section) => workPanels(section),
  "break-even": (section) => breakEvenPanels(section),
  sweep: (section, index) => sweepPanels(section, section.sweeps[index]),
  scenes: (section, index) => scenePanels(data.sceneSweeps[index]),
};

const figures = [...document.querySelectorAll("figure[data-chart]")].map((element) => ({
  element,
  section: data.sections[+element.dataset.of],
  charts: [],
  panels: [],
  isDrawn: false,
}));

function element(tag, attributes = {}, ...children) {
  const made = Object.assign(document.createElement(tag), attributes);
  made.append(...children);
  return made;
}

function legendOf(entries) {
  const legend = element("div", { className: "legend" });
  for (const { text, colour: stroke, dash } of entries) {
    const key = element("span");
    key.innerHTML = '<svg viewBox="0 0 26 8"><line x1="0" x2="26" y1="4" y2="4" stroke-width="2.4"/></svg>';
    key.querySelector("line").setAttribute("stroke", stroke);
    key.querySelector("line").setAttribute("stroke-dasharray", dash.join(" "));
    key.append(text);
    legend.append(key);
  }
  return legend;
}

function draw(figure) {
  const place = figure.element.querySelector(".panels");
  figure.charts.forEach((chart) => chart.destroy());
  figure.panels = builders[figure.element.dataset.chart](figure.section, +figure.element.dataset.index);
  place.replaceChildren();
  figure.element.querySelector(".legend")?.remove();
  const legend = figure.panels.find((panel) => panel.legend)?.legend;
  if (legend) place.before(legendOf(legend));
  if (!figure.panels.length) place.append(element("p", { className: "empty", textContent: "Nothing to show: see the filters." }));
  figure.charts = figure.panels.map((panel) => {
    const canvas = element("canvas");
    const box = element("div", { className: "canvas" }, canvas);
    box.style.height = `${panel.height}px`;
    const holder = element("div", { className: "panel" });
    if (panel.title) holder.append(element("h4", { textContent: panel.title }));
    holder.append(box);
    place.append(holder);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${titleOf(figure)}, ${panel.title}: see the table of numbers below`);
    return new Chart(canvas, panel.config);
  });
  figure.isDrawn = true;
}

const titleOf = (figure) => figure.element.querySelector("h3").textContent;

/// Room for charts that are not drawn yet, so that the page does not jump: two panels to a row, about.
function reserve(figure) {
  figure.element.querySelector(".panels").style.minHeight = figure.isDrawn ? "" : "240px";
}

const watcher = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    const figure = figures.find((candidate) => candidate.element === target);
    if (isIntersecting && !figure.isDrawn) {
      draw(figure);
      reserve(figure);
    }
  }
}, { rootMargin: "400px" });

function drawAll() {
  for (const figure of figures) {
    if (figure.element.closest("[hidden]") || figure.isDrawn) continue;
    draw(figure);
    reserve(figure);
  }
}

/// Draws again what is in sight, and forgets the rest until it is.
function redraw() {
  takeColours();
  for (const figure of figures) {
    figure.isDrawn = false;
    const place = figure.element.getBoundingClientRect();
    if (place.height && place.top < innerHeight + 400 && place.bottom > -400) {
      draw(figure);
      reserve(figure);
    }
    watcher.unobserve(figure.element);
    watcher.observe(figure.element);
  }
}

function save(name, blob) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const isOfAll = (figure) => ["overview", "scenes"].includes(figure.element.dataset.chart);
const fileName = (figure, extension) =>
  `${[isOfAll(figure) ? "" : figure.section.title, titleOf(figure)].filter(Boolean).join(" ").replace(/[^\p{L}\p{N}.=-]+/gu, "-")}.${extension}`;

function csvOf(figure) {
  const rows = figure.panels.flatMap((panel) => panel.csv);
  const names = [...new Set(rows.flatMap((row) => Object.keys(row)))];
  const field = (value) => (/[",\r\n]/.test(value ?? "") ? `"${value.replaceAll('"', '""')}"` : `${value ?? ""}`);
  return [names, ...rows.map((row) => names.map((name) => row[name]))].map((line) => line.map(field).join(",")).join("\n") + "\n";
}

/// All panels of a figure on one canvas, with title and legend.
function pictureOf(figure) {
  const scale = Chart.defaults.devicePixelRatio, gap = 24, titleHeight = 30, panelTitle = 22;
  const columns = figure.charts.length > 1 ? 2 : 1;
  const width = Math.max(...figure.charts.map((chart) => chart.width));
  const legend = figure.panels.find((panel) => panel.legend)?.legend ?? [];
  const rowHeights = [];
  figure.charts.forEach((chart, i) => {
    const row = Math.floor(i / columns);
    rowHeights[row] = Math.max(rowHeights[row] ?? 0, chart.height + panelTitle + 8);
  });
  const total = columns * width + (columns + 1) * gap;
  const canvas = element("canvas");
  const context = canvas.getContext("2d");
  const keys = [];
  let x = gap, y = gap + titleHeight + 8;
  context.font = `13px ${Chart.defaults.font.family}`;
  for (const entry of legend) {
    const wide = context.measureText(entry.text).width + 52;
    if (x + wide > total && x > gap) [x, y] = [gap, y + 20];
    keys.push({ ...entry, x, y });
    x += wide;
  }
  const top = legend.length ? y + 16 : gap + titleHeight;
  canvas.width = total * scale;
  canvas.height = (top + rowHeights.reduce((a, b) => a + b, 0) + gap) * scale;
  context.scale(scale, scale);
  context.fillStyle = colour("paper");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = colour("ink");
  context.font = `600 16px ${Chart.defaults.font.family}`;
  context.fillText(isOfAll(figure) ? titleOf(figure) : `${figure.section.title}: ${titleOf(figure)}`, gap, gap + 14, total - 2 * gap);
  context.font = `13px ${Chart.defaults.font.family}`;
  for (const key of keys) {
    context.strokeStyle = key.colour;
    context.lineWidth = 2.4;
    context.setLineDash(key.dash);
    context.beginPath();
    context.moveTo(key.x, key.y - 4);
    context.lineTo(key.x + 28, key.y - 4);
    context.stroke();
    context.fillText(key.text, key.x + 34, key.y);
  }
  y = top;
  figure.charts.forEach((chart, i) => {
    const left = gap + (i % columns) * (width + gap);
    context.font = `600 13px ${Chart.defaults.font.family}`;
    context.fillText(figure.panels[i].title, left, y + 14);
    context.drawImage(chart.canvas, left, y + panelTitle, chart.width, chart.height);
    if (i % columns === columns - 1) y += rowHeights[Math.floor(i / columns)];
  });
  return canvas;
}

function addTools(figure) {
  const button = (text, hint, act) => {
    const made = element("button", { type: "button", textContent: text, title: hint });
    made.addEventListener("click", () => {
      if (!figure.isDrawn) draw(figure);
      act();
    });
    return made;
  };
  figure.element.querySelector("figcaption").append(element("span", { className: "tools" },
    button("PNG", "Save as a picture", () => pictureOf(figure).toBlob((blob) => save(fileName(figure, "png"), blob))),
    button("CSV", "Save the numbers shown", () => save(fileName(figure, "csv"), new Blob([csvOf(figure)], { type: "text/csv" })))));
}
