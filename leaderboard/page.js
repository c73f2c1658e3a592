"use strict";

// Pure: rows are { id, rankable, search, oracle, mark, values: { total: {...}, pick, nav } }.

/** The value of a row in a column, for a kind of task; null if it has none. */
function valueOf(row, column, kind) {
  const value = row.values[kind][column];
  return value === undefined ? null : value;
}

/** Rows in order of a column; what has no value comes last either way, ties keep their order. */
function sortRows(rows, column, kind, direction) {
  const sign = direction === "ascending" ? 1 : -1;
  return rows
    .map((row, place) => ({ row, place, value: valueOf(row, column, kind) }))
    .sort((a, b) => {
      if (a.value === null || b.value === null) {
        return (a.value === null) - (b.value === null) || a.place - b.place;
      }
      const order = typeof a.value === "string" ? (a.value < b.value ? -1 : a.value > b.value ? 1 : 0)
        : a.value - b.value;
      return sign * order || a.place - b.place;
    })
    .map((each) => each.row);
}

/** Rows that hold every word of a text and are of the wanted sort. */
function filterRows(rows, text, show) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return rows.filter((row) => {
    const wanted = show === "all" || (show === "oracle" && row.oracle) ||
      (show === "plain" && !row.oracle) || (show === "verified" && row.mark === "verified");
    return wanted && words.every((word) => row.search.includes(word));
  });
}

/** Rank of each row that bears one, by success in new houses; equals share a rank. */
function ranks(rows, kind) {
  const ranked = rows.filter((row) => row.rankable && valueOf(row, "test-house", kind) !== null);
  const better = (row) => ranked.filter(
    (other) => valueOf(other, "test-house", kind) > valueOf(row, "test-house", kind)).length;
  return Object.fromEntries(ranked.map((row) => [row.id, better(row) + 1]));
}

/** What a click on a heading makes of the direction. */
function nextDirection(column, current) {
  if (current === "none") { return column === "title" ? "ascending" : "descending"; }
  return current === "descending" ? "ascending" : "descending";
}

function start() {
  const rows = JSON.parse(document.getElementById("data").textContent).rows;
  const table = document.getElementById("results");
  const [text, kind, show] = ["text", "kind", "show"].map((id) => document.getElementById(id));
  const bodies = new Map(rows.map((row) => [row.id, document.getElementById(row.id)]));
  const reference = table.querySelector("tbody.reference");
  let column = "test-house", direction = "descending";

  function draw() {
    table.className = `show-${kind.value}`;
    const shown = new Set(filterRows(rows, text.value, show.value).map((row) => row.id));
    const place = ranks(rows, kind.value);
    for (const row of sortRows(rows, column, kind.value, direction)) {
      const body = bodies.get(row.id);
      body.hidden = !shown.has(row.id);
      body.querySelector(".rank").textContent = place[row.id] ? `${place[row.id]}. ` : "";
      table.insertBefore(body, reference);
    }
    for (const heading of table.querySelectorAll("th[data-column]")) {
      heading.setAttribute("aria-sort", heading.dataset.column === column ? direction : "none");
    }
    document.getElementById("count").textContent = `${shown.size} of ${rows.length} rows`;
  }

  for (const heading of table.querySelectorAll("th[data-column]")) {
    heading.firstElementChild.addEventListener("click", () => {
      direction = nextDirection(heading.dataset.column, heading.getAttribute("aria-sort"));
      column = heading.dataset.column;
      draw();
    });
  }
  for (const button of table.querySelectorAll(".open")) {
    const details = document.getElementById(button.getAttribute("aria-controls"));
    const set = (open) => {
      button.setAttribute("aria-expanded", String(open));
      details.hidden = !open;
    };
    button.disabled = false;
    button.addEventListener("click", () => set(details.hidden));
    set(false);
  }
  for (const button of document.querySelectorAll(".copy")) {
    button.hidden = false;
    button.addEventListener("click", () => copy(button));
  }
  document.getElementById("filters").addEventListener("submit", (event) => event.preventDefault());
  text.addEventListener("input", draw);
  kind.addEventListener("change", draw);
  show.addEventListener("change", draw);
  document.getElementById("filters").hidden = false;
  draw();
}

async function copy(button) {
  const code = button.previousElementSibling.firstElementChild;
  try {
    await navigator.clipboard.writeText(code.textContent);
    button.textContent = "Copied";
  } catch {
    // No clipboard for this page: the words are selected instead.
    getSelection().selectAllChildren(code);
    button.textContent = "Selected";
  }
}

if (typeof document !== "undefined") { start(); }
if (typeof module !== "undefined") { module.exports = { filterRows, nextDirection, ranks, sortRows }; }
