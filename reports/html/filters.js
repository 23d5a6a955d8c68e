// The bar of filters: scenes, structures, ray kinds.

function applyFilters() {
  const hides = (of, kind) => of.dataset[kind] !== undefined && !filter[kind].has(+of.dataset[kind]);
  for (const of of document.querySelectorAll("[data-spec], [data-batch], [data-section]"))
    of.hidden = hides(of, "spec") || hides(of, "batch") || hides(of, "section");
  redraw();
}

function choiceOf(title, set, labels, swatches) {
  const boxes = [];
  const summary = element("summary");
  const say = () => { summary.textContent = set.size === labels.length ? `${title}: all ${labels.length}` : `${title}: ${set.size} of ${labels.length}`; };
  const changed = () => {
    set.clear();
    boxes.forEach((box, i) => { if (box.checked) set.add(i); });
    say();
    applyFilters();
  };
  const choices = element("div", { className: "choices" });
  const all = (checked) => {
    const made = element("button", { type: "button", textContent: checked ? "all" : "none" });
    made.addEventListener("click", () => {
      boxes.forEach((box) => { box.checked = checked; });
      changed();
    });
    return made;
  };
  choices.append(element("div", { className: "both" }, all(true), all(false)));
  labels.forEach((label, i) => {
    const box = element("input", { type: "checkbox", checked: true });
    box.addEventListener("change", changed);
    boxes.push(box);
    const line = element("label", {}, box, " ");
    if (swatches) line.append(element("i", { className: `swatch c${swatches[i]}` }));
    line.append(label);
    choices.append(line);
  });
  say();
  return element("details", { className: "filter" }, summary, choices);
}

function addFilters() {
  const bar = document.getElementById("filters");
  const titles = data.sections.map((section) => section.title + (section.setting ? ` (${section.setting})` : ""));
  const scenes = choiceOf("Scenes", filter.section, titles);
  scenes.dataset.filter = "sections";
  const specs = choiceOf("Structures", filter.spec, data.specs.map((spec) => spec.label), data.specs.map((spec) => spec.colour));
  specs.dataset.filter = "specs";
  const batches = choiceOf("Rays", filter.batch, data.batches);
  batches.dataset.filter = "batches";
  const theme = element("button", { type: "button", textContent: "Light / dark", title: "Change between light and dark" });
  theme.addEventListener("click", () => {
    setTheme(isDark() ? "light" : "dark");
    redraw();
  });
  bar.append(scenes, specs, batches, element("span", { className: "filter theme" }, theme));
  document.addEventListener("click", (event) => {
    for (const open of bar.querySelectorAll("details[open]"))
      if (!open.contains(event.target)) open.open = false;
  });
}

const isDark = () => {
  const chosen = document.documentElement.classList;
  return chosen.contains("dark") || (!chosen.contains("light") && matchMedia("(prefers-color-scheme: dark)").matches);
};

function setTheme(name) {
  document.documentElement.classList.remove("light", "dark");
  if (name) document.documentElement.classList.add(name);
}
