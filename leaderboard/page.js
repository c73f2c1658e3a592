"use strict";

// A row: { id, type, rankable, oracle, ranked, search, title, values: { total: {...}, pick, nav } }.

/** The value of a row in a column, for a kind of task; null if it has none. */
function valueOf(row, column, kind) {
  if (column === "title") { return row.title; }
  const value = row.values[kind][column];
  return value === undefined ? null : value;
}

/** Rows sorted by a column; rows without a value come last either way, ties keep their order. */
function sortRows(rows, column, kind, direction) {
  const sign = direction === "ascending" ? 1 : -1;
  return rows
    .map((row, place) => ({ row, place, value: valueOf(row, column, kind) }))
    .sort((a, b) => {
      if (a.value === null || b.value === null) {
        return (a.value === null) - (b.value === null) || a.place - b.place;
      }
      const order = a.value < b.value ? -1 : a.value > b.value ? 1 : 0;
      return sign * order || a.place - b.place;
    })
    .map((each) => each.row);
}

const WANTED = {
  all: () => true,
  ours: (row) => row.type !== "paper",
  method: (row) => row.type === "method",
  plain: (row) => row.type === "method" && !row.oracle,
  ranked: (row) => row.ranked,
};

/** Rows of the wanted type that contain every word of a text. */
function filterRows(rows, text, show) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return rows.filter((row) => WANTED[show](row) && words.every((word) => row.search.includes(word)));
}

/** The rank of each ranked row, by success in new houses; equal rows share a rank. */
function ranks(rows, kind) {
  const ranked = rows.filter((row) => row.rankable && valueOf(row, "test-house", kind) !== null);
  const better = (row) => ranked.filter(
    (other) => valueOf(other, "test-house", kind) > valueOf(row, "test-house", kind)).length;
  return new Map(ranked.map((row) => [row.id, better(row) + 1]));
}

/** The direction after a click on a heading. */
function nextDirection(column, current) {
  if (current === "none") { return column === "title" ? "ascending" : "descending"; }
  return current === "descending" ? "ascending" : "descending";
}

const form = document.getElementById("filters");
const order = { column: "test-house", direction: "descending" };

function choice(name) {
  const checked = form.querySelector(`input[name="${name}"]:checked`);
  return checked === null ? "" : checked.value;
}

/** Show the chosen board in the chosen order. */
function draw(boards) {
  const kind = choice("kind"), chosen = choice("benchmark");
  for (const [name, rows] of Object.entries(boards)) {
    const section = document.querySelector(`.board[data-benchmark="${name}"]`);
    section.hidden = name !== chosen;
    if (section.hidden) { continue; }
    const table = section.querySelector(".results");
    table.classList.remove("show-total", "show-pick", "show-nav");
    table.classList.add(`show-${kind}`);
    const shown = new Set(
      filterRows(rows, document.getElementById("text").value, document.getElementById("show").value));
    const place = ranks(rows, kind);
    for (const row of sortRows(rows, order.column, kind, order.direction)) {
      const body = document.getElementById(row.id);
      body.hidden = !shown.has(row);
      body.querySelector(".rank").textContent = place.get(row.id) || "";
      table.append(body);
    }
    for (const heading of table.querySelectorAll("th[data-column]")) {
      const sorted = heading.dataset.column === order.column;
      heading.setAttribute("aria-sort", sorted ? order.direction : "none");
    }
    document.getElementById("count").textContent = `${shown.size} of ${rows.length} rows`;
  }
}

/** Open or close the details of a row. */
function setOpen(button, open) {
  button.setAttribute("aria-expanded", String(open));
  document.getElementById(button.getAttribute("aria-controls")).hidden = !open;
}

/** Open the row named by the URL's fragment, and show its board. */
function follow(boards) {
  const id = decodeURIComponent(location.hash.slice(1));
  for (const [name, rows] of Object.entries(boards)) {
    if (!rows.some((row) => row.id === id)) { continue; }
    for (const each of form.querySelectorAll('input[name="benchmark"]')) {
      each.checked = each.value === name;
    }
    draw(boards);
    const body = document.getElementById(id);
    const button = body.querySelector(".open");
    if (button) { setOpen(button, true); }
    body.scrollIntoView();
  }
}

/** Play a recording in the player, which is a document of its own. */
function play(button) {
  const dialog = document.getElementById("player");
  stop();
  const frame = document.createElement("iframe");
  frame.title = `Recording of ${button.dataset.title}`;
  frame.setAttribute("sandbox", "allow-scripts allow-same-origin");
  frame.src = `player/player.html#${button.dataset.script}`;
  document.getElementById("playing").textContent = button.dataset.title;
  dialog.append(frame);
  // The dialog returns the focus here: not every browser moves it with a click.
  button.focus();
  dialog.showModal();
}

/** Remove the player, which frees its memory. */
function stop() {
  const frame = document.querySelector("#player iframe");
  if (frame !== null) { frame.remove(); }
}

async function copy(button) {
  const code = button.previousElementSibling.firstElementChild;
  try {
    await navigator.clipboard.writeText(code.textContent);
    button.textContent = "Copied";
  } catch {
    // No access to the clipboard: the text is selected instead.
    getSelection().selectAllChildren(code);
    button.textContent = "Selected";
  }
}

function start() {
  const boards = JSON.parse(document.getElementById("data").textContent);
  const again = () => draw(boards);
  for (const heading of document.querySelectorAll("th[data-column]")) {
    heading.firstElementChild.addEventListener("click", () => {
      order.direction = nextDirection(heading.dataset.column, heading.getAttribute("aria-sort"));
      order.column = heading.dataset.column;
      again();
    });
  }
  for (const button of document.querySelectorAll(".open")) {
    button.disabled = false;
    button.addEventListener("click", () =>
      setOpen(button, button.getAttribute("aria-expanded") === "false"));
    setOpen(button, false);
  }
  for (const button of document.querySelectorAll(".play, .copy")) { button.hidden = false; }
  document.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (button === null) { return; }
    if (button.classList.contains("play")) { play(button); }
    if (button.classList.contains("copy")) { copy(button); }
  });
  const dialog = document.getElementById("player");
  document.getElementById("close").addEventListener("click", () => { dialog.close(); stop(); });
  // Also by Escape. The event may arrive late, when the next recording is already open.
  dialog.addEventListener("close", () => { if (!dialog.open) { stop(); } });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", again);
  form.hidden = false;
  addEventListener("hashchange", () => follow(boards));
  again();
  follow(boards);
}

start();
