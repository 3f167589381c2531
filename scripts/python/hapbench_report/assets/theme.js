// Light, dark, or as the system has it. The choice lasts as long as the page.

const themeMenu = document.getElementById("theme");
themeMenu.addEventListener("change", () => {
  if (themeMenu.value === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = themeMenu.value;
  document.dispatchEvent(new Event("themechange"));
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => document.dispatchEvent(new Event("themechange")));

// Paper is white: draw for it, and then again for the screen.
addEventListener("beforeprint", () => {
  document.documentElement.dataset.theme = "light";
  document.dispatchEvent(new Event("themechange"));
});
addEventListener("afterprint", () => themeMenu.dispatchEvent(new Event("change")));
