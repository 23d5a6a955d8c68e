// Start.

addFilters();
for (const figure of figures) {
  addTools(figure);
  reserve(figure);
}
redraw();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);

// On paper all is drawn, in the light colours.
let beforePrint = null;
addEventListener("beforeprint", () => {
  const classes = document.documentElement.classList;
  beforePrint = classes.contains("dark") ? "dark" : classes.contains("light") ? "light" : "";
  setTheme("light");
  redraw();
  drawAll();
});
addEventListener("afterprint", () => {
  setTheme(beforePrint);
  redraw();
});
