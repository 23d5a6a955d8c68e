// Uses a report's page as a person would, in a browser without a screen; reports_tests puts it at the end of the
// page and reads what it writes into #outcome. Ahead of it, page_errors holds what went wrong since the start.
(async () => {
  const failures = [];
  let checks = 0;
  const check = (right, what) => { ++checks; if (!right) failures.push(what); };
  const soon = (milliseconds = 60) => new Promise((resolve) => setTimeout(resolve, milliseconds));
  const find = (chart) => figures.find((figure) => figure.element.dataset.chart === chart);
  const isInked = (canvas) => {
    const { data: pixels } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return pixels.some((value, i) => i % 4 === 3 && value > 0);
  };
  try {
    // Drawn
    check(find("overview").isDrawn || innerWidth < 500, "what is in sight is drawn at once");
    drawAll();
    for (const figure of figures) {
      const name = figure.element.dataset.chart;
      check(figure.charts.length > 0, `${name}: has charts`);
      for (const chart of figure.charts) check(isInked(chart.canvas), `${name}: is drawn`);
    }
    const named = document.querySelector("section.scene h2").textContent;
    check(named === data.sections[0].title && named.includes("<" + "/script>"), "a hostile name is text");
    check(window.alerted === undefined, "no script of a name has run");

    // Hover
    const ratio = find("ratio").charts[0];
    ratio.canvas.scrollIntoView();
    await soon();
    const bar = ratio.getDatasetMeta(0).data[1];
    const place = ratio.canvas.getBoundingClientRect();
    ratio.canvas.dispatchEvent(new MouseEvent("mousemove", { clientX: place.left + (bar.base + bar.x) / 2, clientY: place.top + bar.y, bubbles: true }));
    for (let i = 0; i < 40 && !ratio.tooltip?.opacity; ++i) await soon();
    check(ratio.tooltip.opacity > 0, "hover shows a tooltip");
    check(ratio.tooltip.title[0] === data.specs[1].label, `of the structure under the pointer: ${ratio.tooltip.title}`);
    const said = ratio.tooltip.body.flatMap((item) => item.lines).join("\n");
    check(/ratio 0\.300 \(0\.294 to 0\.306\)/.test(said) && /Mray\/s/.test(said), `with exact values and units: ${said}`);

    // Saving
    const csv = csvOf(find("ratio")).trim().split("\n");
    check(csv[0].startsWith("rays,structure,ratio,ratio_low,ratio_high"), `CSV has names: ${csv[0]}`);
    check(csv.length === 1 + 2 * 5, `CSV has a line for each race: ${csv.length}`);
    check(pictureOf(find("break-even")).toDataURL().startsWith("data:image/png"), "PNG");
    for (const figure of figures) {
      const buttons = figure.element.querySelectorAll(".tools button");
      check(buttons.length === 2, "two buttons to a figure");
    }

    // Filters
    const boxes = (name) => [...document.querySelectorAll(`[data-filter=${name}] input`)];
    const press = (name, text) => [...document.querySelectorAll(`[data-filter=${name}] button`)].find((button) => button.textContent === text).click();
    const visible = (selector) => [...document.querySelectorAll(selector)].filter((of) => !of.closest("[hidden]")).length;
    boxes("specs")[3].click();
    await soon();
    check(visible('tr[data-spec="3"]') === 0, "a structure filtered out leaves the tables");
    check(visible('tr[data-spec="2"]') > 0, "the others stay");
    drawAll();
    check(find("ratio").charts[0].data.labels.length === 4, "and the charts");
    boxes("sections")[1].click();
    check(visible('section[data-section="1"]') === 0 && visible('section[data-section="0"]') === 1, "a scene filtered out goes");
    press("batches", "none");
    await soon();
    drawAll();
    check(find("work").charts.length === 0 && /Nothing to show/.test(find("work").element.textContent), "no rays: said");
    for (const name of ["specs", "sections", "batches"]) press(name, "all");
    await soon();
    drawAll();
    check(find("ratio").charts[0].data.labels.length === 5 && visible("section.scene") === 2, "all is back");

    // Themes and paper
    const before = Chart.defaults.color;
    document.querySelector("#filters .theme button").click();
    check(Chart.defaults.color !== before, "the other theme has other colours");
    dispatchEvent(new Event("beforeprint"));
    check(figures.every((figure) => figure.isDrawn) && !isDark(), "on paper all is drawn, and light");
    dispatchEvent(new Event("afterprint"));

    check(document.documentElement.scrollWidth <= innerWidth, `nothing sticks out of the page: ${document.documentElement.scrollWidth}`);
    check(performance.getEntriesByType("resource").every((entry) => entry.name.startsWith("data:")), "nothing is fetched");
  } catch (error) {
    failures.push(`${error} ${error.stack}`);
  }
  failures.push(...pageErrors);
  document.body.append(element("pre", { id: "outcome", textContent: failures.length ? `FAILED ${failures.join(" | ")}` : `${checks} checks passed` }));
})();
