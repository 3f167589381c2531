// Theme of the page: light, dark, or the system's theme. The choice is not saved.

const themeMenu = document.getElementById("theme");
themeMenu.addEventListener("change", () => {
  if (themeMenu.value === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = themeMenu.value;
  document.dispatchEvent(new Event("themechange"));
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => document.dispatchEvent(new Event("themechange")));

// Draw with the light theme for printing, because paper is white, and with the chosen theme after printing.
addEventListener("beforeprint", () => {
  document.documentElement.dataset.theme = "light";
  document.dispatchEvent(new Event("themechange"));
});
addEventListener("afterprint", () => themeMenu.dispatchEvent(new Event("change")));
