// Start.

addFilters();
for (const figure of figures) {
  addTools(figure);
  reserve(figure);
}
redraw();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);

// On paper all is drawn, in the light colours, and as wide as an A4 page.
let beforePrint = null;
addEventListener("beforeprint", () => {
  const classes = document.documentElement.classList;
  beforePrint = classes.contains("dark") ? "dark" : classes.contains("light") ? "light" : "";
  setTheme("light");
  document.documentElement.classList.add("paper");
  Chart.defaults.font.size = 10;
  redraw();
  drawAll();
});
addEventListener("afterprint", () => {
  setTheme(beforePrint);
  document.documentElement.classList.remove("paper");
  Chart.defaults.font.size = 12;
  redraw();
});
