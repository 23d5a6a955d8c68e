// What is set for all charts, and the marks that Chart.js has not.

Chart.defaults.animation = false;
Chart.defaults.maintainAspectRatio = false;
Chart.defaults.devicePixelRatio = Math.max(2, window.devicePixelRatio || 1);  // sharp on paper, too
Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
Chart.defaults.font.size = 12;
Chart.defaults.plugins.legend.display = false;
Chart.defaults.plugins.tooltip.displayColors = false;
Chart.defaults.plugins.tooltip.titleFont = { weight: "600" };
Chart.defaults.plugins.tooltip.padding = 8;

function takeColours() {
  colour = theme();
  Chart.defaults.color = colour("soft");
  Chart.defaults.borderColor = colour("grid");
  Object.assign(Chart.defaults.plugins.tooltip, {
    backgroundColor: colour("ink"), titleColor: colour("paper"), bodyColor: colour("paper"),
  });
}

/// Stripes of a colour: what is noisy.
function stripes(of) {
  const tile = document.createElement("canvas");
  tile.width = tile.height = 8;
  const context = tile.getContext("2d");
  context.fillStyle = of;
  context.globalAlpha = 0.35;
  context.fillRect(0, 0, 8, 8);
  context.globalAlpha = 1;
  context.strokeStyle = of;
  context.lineWidth = 2.5;
  context.beginPath();
  for (const at of [-8, 0, 8]) {
    context.moveTo(at, 8);
    context.lineTo(at + 8, 0);
  }
  context.stroke();
  return context.createPattern(tile, "repeat");
}

/// Draws what the dataset `marks` of a chart with horizontal bars says of each row: {interval: [a, b]},
/// {line: [a, b], tick: c, dot: d} in units of x, and {text, textAt, bad}: a label after x = textAt.
const rowMarks = {
  id: "rowMarks",
  afterDatasetsDraw(chart) {
    const { ctx, scales: { x, y }, chartArea } = chart;
    const at = (value) => (value === Infinity ? chartArea.right : Math.min(x.getPixelForValue(value), chartArea.right));
    const line = (x1, y1, x2, y2, width) => {
      ctx.lineWidth = width;
      ctx.beginPath();
      ctx.moveTo(x1, y1);
      ctx.lineTo(x2, y2);
      ctx.stroke();
    };
    ctx.save();
    ctx.textBaseline = "middle";
    ctx.font = `${Chart.defaults.font.size}px ${Chart.defaults.font.family}`;
    // Lines across all rows: the baseline, its envelope.
    for (const rule of chart.data.rules || []) {
      ctx.strokeStyle = colour("soft");
      ctx.setLineDash(rule.dash);
      line(x.getPixelForValue(rule.at), chartArea.top, x.getPixelForValue(rule.at), chartArea.bottom, 1.2);
      ctx.setLineDash([]);
      ctx.fillStyle = colour("soft");
      ctx.textAlign = x.getPixelForValue(rule.at) > (chartArea.left + chartArea.right) / 2 ? "right" : "left";
      if (rule.text) ctx.fillText(rule.text, x.getPixelForValue(rule.at) + (ctx.textAlign === "left" ? 4 : -4), chartArea.top - 7);
    }
    ctx.textAlign = "left";
    chart.data.marks.forEach((mark, row) => {
      const middle = y.getPixelForValue(row);
      ctx.strokeStyle = ctx.fillStyle = colour("ink");
      if (mark.interval) {
        const [low, high] = mark.interval.map(at);
        line(low, middle, high, middle, 1.3);
        for (const end of [low, high]) line(end, middle - 4, end, middle + 4, 1.3);
      }
      if (mark.line) {
        ctx.strokeStyle = mark.colour;
        line(at(mark.line[0]), middle, at(mark.line[1]), middle, 1.3);
        line(at(mark.line[1]), middle - 4, at(mark.line[1]), middle + 4, 1.3);
        ctx.strokeStyle = colour("ink");
        line(at(mark.tick), middle - 6, at(mark.tick), middle + 6, 1.3);
        ctx.beginPath();
        ctx.arc(at(mark.dot), middle, 3.6, 0, 7);
        ctx.fill();
        ctx.strokeStyle = colour("paper");
        ctx.lineWidth = 1.2;
        ctx.stroke();
      }
      if (mark.text) {
        ctx.strokeStyle = colour("paper");  // so that lines across do not disturb it
        ctx.lineWidth = 4;
        ctx.strokeText(mark.text, at(mark.textAt) + 6, middle + 0.5);
        ctx.fillStyle = mark.bad ? colour("bad") : colour("ink");
        ctx.fillText(mark.text, at(mark.textAt) + 6, middle + 0.5);
      }
    });
    ctx.restore();
  },
};

/// Writes the x of each curve's least point beside it (`least` of the dataset: its index).
const leastMarks = {
  id: "leastMarks",
  afterDatasetsDraw(chart) {
    const { ctx, chartArea } = chart;
    ctx.save();
    ctx.font = `600 11px ${Chart.defaults.font.family}`;
    const places = [];
    chart.data.datasets.forEach((dataset, i) => {
      if (dataset.least === undefined || dataset.least < 0) return;
      const { x, y } = chart.getDatasetMeta(i).data[dataset.least];
      ctx.strokeStyle = colour("ink");
      ctx.lineWidth = 1.5;
      ctx.beginPath();
      ctx.arc(x, y, 6, 0, 7);
      ctx.stroke();
      // One label for curves that have their least at the same place, beside the outermost ring.
      const near = places.find((place) => Math.abs(place.x - x) < 1 && y - place.bottom < 40 && place.top - y < 40);
      if (near) Object.assign(near, { top: Math.min(near.top, y), bottom: Math.max(near.bottom, y) });
      else places.push({ x, top: y, bottom: y, text: brief(dataset.data[dataset.least].x) });
    });
    for (const { x, top, bottom, text } of places) {
      ctx.textAlign = x > chartArea.right - 40 ? "right" : x < chartArea.left + 20 ? "left" : "center";
      ctx.strokeStyle = colour("paper");
      ctx.lineWidth = 4;
      const y = bottom > chartArea.bottom - 24 ? top - 11 : bottom + 19;
      ctx.strokeText(text, x, y);
      ctx.fillStyle = colour("ink");
      ctx.fillText(text, x, y);
    }
    ctx.restore();
  },
};
