// Adds buttons that copy commands, enlarges figures, marks tables that scroll sideways, and prepares printing.

document.querySelectorAll("pre.command").forEach((line) => {
  const button = Object.assign(document.createElement("button"), {type: "button", className: "copy", textContent: "Copy"});
  button.setAttribute("aria-label", "Copy this command");
  button.addEventListener("click", async () => {
    const code = line.querySelector("code");
    try {
      await navigator.clipboard.writeText(code.textContent);
      button.textContent = "Copied";
    } catch {  // a page that was opened from a file may not have access to the clipboard: select the text
      getSelection().selectAllChildren(code);
      button.textContent = "Selected";
    }
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  });
  line.append(button);
});

/** Dialog that shows one figure in the whole window. The arrow keys show the previous and next figure. */
const enlarged = document.getElementById("enlarged");
const figureButtons = [...document.querySelectorAll(".enlarge")];
let shownFigure = 0;

function showFigure(index) {
  shownFigure = (index + figureButtons.length) % figureButtons.length;
  const source = figureButtons[shownFigure].querySelector("img");
  enlarged.querySelector(".frame").replaceChildren(Object.assign(new Image(), {src: source.src, alt: source.alt}));
  enlarged.querySelector("b").textContent = figureButtons[shownFigure].closest("figure").querySelector("h3").textContent;
  if (!enlarged.open) enlarged.showModal();
}

figureButtons.forEach((button, index) => button.addEventListener("click", () => showFigure(index)));
enlarged.addEventListener("click", (event) => {
  const step = event.target.dataset.step;
  if (step) showFigure(shownFigure + Number(step));
  else if (event.target === enlarged) enlarged.close();
});
enlarged.addEventListener("keydown", (event) => {
  const step = {ArrowLeft: -1, ArrowRight: 1}[event.key];
  if (step) showFigure(shownFigure + step);
});

const tellScrolling = () => document.querySelectorAll(".wide").forEach((wide) =>
  wide.classList.toggle("scrolls", wide.scrollWidth > wide.clientWidth + 1));
addEventListener("resize", tellScrolling);
document.addEventListener("toggle", tellScrolling, true);
tellScrolling();

// Unfold details with the class "printed" while the page is printed.
document.getElementById("print").addEventListener("click", () => print());
const unfolded = [];
addEventListener("beforeprint", () => document.querySelectorAll("details.printed:not([open])").forEach((part) => {
  part.open = true;
  unfolded.push(part);
}));
addEventListener("afterprint", () => unfolded.splice(0).forEach((part) => { part.open = false; }));
