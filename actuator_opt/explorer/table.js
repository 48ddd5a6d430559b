// Table of the designs that pass, sorted by any column, and all their numbers as CSV.
const PAGE = 50;
const SORT = { column: DATA.start.y, way: COLUMNS[DATA.start.y].better > 0 ? -1 : 1, from: 0 };
let HEADS = [], STALE = true, ROWS = [];

function node(name, attributes, ...parts) {
  const made = document.createElement(name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  made.append(...parts);
  return made;
}
// What a column is sorted by: its number, or the place of its text in the alphabet.
function ranks(column) {
  if (column < 0) return null;
  const { texts, values } = COLUMNS[column];
  if (!texts) return values;
  const order = texts.map((_, k) => k).sort((p, q) => (texts[p] < texts[q] ? -1 : 1)), place = [];
  order.forEach((code, k) => { place[code] = k; });
  return values.map((code) => place[code]);
}
// The designs that pass, in the order of the table; those without a value come last either way.
function sortedRows() {
  const rows = [], values = ranks(SORT.column), way = SORT.way;
  for (let k = 0; k < N; k++) if (VISIBLE[k]) rows.push(k);
  if (!values) return way > 0 ? rows : rows.reverse();
  const lost = (k) => values[k] !== values[k];
  return rows.sort((p, q) => lost(p) - lost(q) || way * (values[p] - values[q]) || p - q);
}
function tableColumns() {
  return byId("all").checked && !PRINTING ? COLUMNS.map((_, k) => k) : STATE.axes;
}
function sortBy(column) {
  SORT.way = SORT.column === column ? -SORT.way : 1;
  SORT.column = column; SORT.from = 0;
  fillTable();
  say(`Sorted by ${headOf(column)}, ${SORT.way > 0 ? "ascending" : "descending"}`);
}
function headOf(column) { return column < 0 ? "design" : COLUMNS[column].head; }
function buildHeads() {
  HEADS = [-1, ...tableColumns()].map((column) => {
    const arrow = node("span", { "aria-hidden": "true" }), words = column < 0 ? "design" : broken(COLUMNS[column], COLUMNS[column].label);
    const button = node("button", { type: "button", title: `Sort by ${headOf(column)}` }, words, arrow);
    button.addEventListener("click", () => sortBy(column));
    return { column, arrow, head: node("th", { scope: "col", class: column < 0 || COLUMNS[column].texts ? "text" : "" }, button) };
  });
  byId("heads").replaceChildren(...HEADS.map((one) => one.head));
}
function fillTable() {
  ROWS = sortedRows();
  SORT.from = Math.min(SORT.from, Math.max(0, Math.ceil(ROWS.length / PAGE) - 1) * PAGE);
  const to = Math.min(SORT.from + PAGE, ROWS.length), way = SORT.way > 0 ? "ascending" : "descending";
  for (const { column, head, arrow } of HEADS) {
    if (column === SORT.column) head.setAttribute("aria-sort", way); else head.removeAttribute("aria-sort");
    arrow.textContent = column === SORT.column ? (SORT.way > 0 ? " ▲" : " ▼") : "";
  }
  byId("rows").replaceChildren(...ROWS.slice(SORT.from, to).map(tableRow));
  byId("shown-rows").textContent = ROWS.length ? `${SORT.from + 1} to ${to} of ${ROWS.length}, by ${headOf(SORT.column)}, ${way}` : "No design passes all that is asked for.";
  byId("before").disabled = SORT.from === 0;
  byId("after").disabled = to >= ROWS.length;
  byId("csv").textContent = `CSV of ${ROWS.length === 1 ? "this 1" : `these ${ROWS.length}`}`;
  byId("csv").disabled = !ROWS.length;
  markRows();
}
function tableRow(row) {
  const button = node("button", { type: "button", "aria-label": `Choose design ${row + 1}` }, String(row + 1));
  const line = node("tr", { "data-row": row }, node("th", { scope: "row" }, button, node("b", {})));
  for (const { column } of HEADS.slice(1)) {
    const one = COLUMNS[column];
    line.append(node("td", one.texts ? { class: "text" } : {}, shown(one, one.values[row])));
  }
  line.addEventListener("click", () => pin(row));
  return line;
}
// Mark the chosen design and A, without new rows: a button keeps the focus.
function markRows() {
  for (const line of byId("rows").children) {
    const row = Number(line.dataset.row), button = line.firstChild.firstChild;
    line.classList.toggle("chosen", row === STATE.pinned);
    if (row === STATE.pinned) button.setAttribute("aria-current", "true"); else button.removeAttribute("aria-current");
    line.firstChild.lastChild.textContent = letter(row);
  }
}
function drawTable() {
  if (!STALE) return;
  STALE = false;
  const columns = [-1, ...tableColumns()];
  if (HEADS.length !== columns.length || HEADS.some((one, k) => one.column !== columns[k])) buildHeads();
  fillTable();
}
function turn(way) {
  SORT.from = Math.min(Math.max(SORT.from + way * PAGE, 0), (Math.ceil(ROWS.length / PAGE) - 1) * PAGE);
  fillTable();
  byId("table-box").scrollTop = 0;
  say(byId("shown-rows").textContent);
}
// The shortest decimal number that is this number of single precision.
function exactly(value) {
  if (!Number.isFinite(value)) return "";
  for (let digits = 6; digits < 9; digits++) {
    const told = Number(value.toPrecision(digits));
    if (Math.fround(told) === value) return String(told);
  }
  return String(Number(value.toPrecision(9)));
}
// A text as a cell; an apostrophe keeps a spreadsheet from taking it for a formula.
function cell(text) {
  const safe = /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}
function csv(rows) {
  const lines = [["design", ...COLUMNS.map((one) => cell(one.csv))]];
  for (const row of rows) {
    lines.push([row + 1, ...COLUMNS.map((one) => (one.texts ? cell(one.texts[one.values[row]]) : exactly(one.values[row])))]);
  }
  return lines.map((line) => line.join(",") + "\n").join("");
}
function saveCsv() {
  const link = document.createElement("a"), name = DATA.name.replace(/[^\p{L}\p{N}-]+/gu, "_").slice(0, 80);
  link.href = URL.createObjectURL(new Blob([csv(ROWS)], { type: "text/csv" }));
  link.download = `${name}_${ROWS.length}_designs.csv`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  say(`${ROWS.length} designs saved as CSV`);
}
function buildTable() {
  byId("all").addEventListener("change", () => { STALE = true; redraw(true); });
  byId("before").addEventListener("click", () => turn(-1));
  byId("after").addEventListener("click", () => turn(1));
  byId("csv").addEventListener("click", saveCsv);
}
