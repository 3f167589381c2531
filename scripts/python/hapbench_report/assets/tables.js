// Sorts tables after a click on a heading, and shows only rows that match the filters.

const sortKey = (cell) => {
  const key = cell.dataset.sort ?? cell.textContent;
  return key === "" || Number.isNaN(Number(key)) ? key.toLowerCase() : Number(key);
};

/** Orders numbers before words and missing values last, in both directions. `direction`: 1 ascending, -1 descending. */
function compareKeys(a, b, direction) {
  if (a === "" || b === "") return (a === "") - (b === "");
  if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
  return direction * (typeof a === "number" ? a - b : a.localeCompare(b));
}

function sortTable(table, heading) {
  const column = heading.cellIndex, up = heading.getAttribute("aria-sort") !== "ascending";
  table.querySelectorAll("th").forEach((th) => th.removeAttribute("aria-sort"));
  heading.setAttribute("aria-sort", up ? "ascending" : "descending");
  const rows = [...table.tBodies[0].rows].map((row) => [sortKey(row.cells[column]), row]);
  rows.sort((a, b) => compareKeys(a[0], b[0], up ? 1 : -1));
  table.tBodies[0].append(...rows.map(([, row]) => row));
}

document.querySelectorAll("table.sortable").forEach((table) => {
  table.querySelectorAll("thead th").forEach((heading) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => sortTable(table, heading));
  });
});

/** Shows the rows that match every filter of a group: each word of a text field occurs in the row, and each menu's
 *  value equals the cell in the menu's column. */
function filterTable(filters) {
  const table = document.getElementById(filters.dataset.filters);
  const controls = [...filters.querySelectorAll("input, select")];
  let shown = 0;
  for (const row of table.tBodies[0].rows) {
    row.hidden = !controls.every((control) => {
      const wanted = control.value.toLowerCase();
      if (control.tagName === "INPUT") return wanted.split(/\s+/).every((word) => row.textContent.toLowerCase().includes(word));
      return !wanted || row.cells[Number(control.dataset.column)].textContent.toLowerCase() === wanted;
    });
    shown += !row.hidden;
  }
  filters.querySelector("output").textContent = `${shown} of ${table.tBodies[0].rows.length}`;
}

document.querySelectorAll("[data-filters]").forEach((filters) => {
  const table = document.getElementById(filters.dataset.filters);
  filters.querySelectorAll("select").forEach((menu) => {
    const values = new Set([...table.tBodies[0].rows].map((row) => row.cells[Number(menu.dataset.column)].textContent));
    [...values].sort().forEach((value) => menu.add(new Option(value, value)));
  });
  filters.addEventListener("input", () => filterTable(filters));
  filterTable(filters);
});

/** Unfolds the details around the target of the page's address, and scrolls to the target. */
function openTarget() {
  const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (!target) return;
  for (let node = target; node; node = node.parentElement) if (node.tagName === "DETAILS") node.open = true;
  target.scrollIntoView();
}
addEventListener("hashchange", openTarget);
openTarget();
