// Connect the parts of the page: they share one state, and are drawn again when it changes.
let WAITING = false;
const CHOICES = [];
// Redraw everything; with `above`, only the marks above the painted pictures.
function redraw(above) {
  if (above !== true) KEPT.clear();
  if (WAITING) return;
  WAITING = true;
  requestAnimationFrame(() => { WAITING = false; draw(); });
}
function draw() { drawScatter(); drawLegend(); drawLines(); placeAxes(); drawTable(); }
let PRINTING = false;
// Draw for print: dark on white, at the width of a sheet.
function printing(on) {
  document.documentElement.classList.toggle("printing", on);
  PRINTING = on; STALE = true;
  KEPT.clear(); draw();
}
function say(text) { byId("live").textContent = text; }
function refresh() {
  filter();
  byId("count").textContent = `${COUNT} of ${N} designs meet what is asked for${STATE.ranges.size ? " and lie in the ranges" : ""}`;
  byId("scatter").setAttribute("aria-label", `${COLUMNS[STATE.y].head} over ${COLUMNS[STATE.x].head}, ${COUNT} of ${N} designs`);
  LIMITS.forEach((one) => { one.note.textContent = noteOf(one); });
  STALE = true;
  redraw();
}
// How many designs a limit excludes, and how many of them no other selected limit excludes.
function noteOf(limit) {
  let alone = 0;
  for (let k = 0; k < N; k++) if (limit.cut[k] && MISSED[k] === (limit.asked ? 1 : 0)) alone++;
  return limit.count ? `cuts ${limit.count}, ${alone} of them alone` : "cuts none";
}
function describe(row) {
  byId("design-title").textContent = row < 0 ? "No design chosen" : `Design ${row + 1} of ${N}`;
  drawSection(row);
  [byId("verdict").className, byId("verdict").textContent] = row < 0 ? ["", ""] : verdictOf(row);
  byId("numbers").replaceChildren(...(row < 0 ? [] : COLUMNS.map((column) => {
    const line = document.createElement("tr"), head = document.createElement("th");
    head.scope = "row"; head.textContent = column.label;
    const [value, unit] = [shown(column, column.values[row]), column.unit || ""].map((text) => {
      const cell = document.createElement("td"); cell.textContent = text; return cell;
    });
    line.append(head, value, unit);
    return line;
  })));
  byId("command").textContent = row < 0 ? "" : commandOf(row);
  byId("copy").disabled = row < 0;
}
// Whether a design meets all limits: the kind of the answer, and the answer.
function verdictOf(row) {
  const missed = LIMITS.filter((one) => one.cut[row]).sort((a, b) => a.margin[row] - b.margin[row]);
  const more = missed.length > 5 ? ` and ${missed.length - 5} more` : "";
  if (missed.length) return ["bad", `Misses ${missed.slice(0, 5).map((one) => `${one.name} (${marginText(one, row)})`).join(", ")}${more}.`];
  const tight = LIMITS.filter((one) => one.margin[row] < one.reserve).map((one) => one.name).join(", ");
  return [tight ? "doubt" : "good", `Meets every requirement and check${tight ? `; without reserve: ${tight}` : ""}.`];
}
function marginText(limit, row) {
  const margin = limit.margin[row];
  if (!Number.isFinite(margin)) return "no answer";
  return limit.plain ? trimmed(margin) : `${trimmed(Number((100 * margin).toPrecision(3)))} %`;
}
function pin(row) {
  STATE.pinned = row; STATE.hover = -1;
  describe(row); compared(); markRows();
  redraw(true);
  const x = COLUMNS[STATE.x], y = COLUMNS[STATE.y];
  say(row < 0 ? "No design chosen" : `Design ${row + 1}: ${x.label} ${shown(x, x.values[row])} ${x.unit}, ${y.label} ${shown(y, y.values[row])} ${y.unit}. ${byId("verdict").textContent}`);
}
function hover(row) {
  if (row === STATE.hover) return;
  STATE.hover = row;
  describe(row < 0 ? STATE.pinned : row);
  redraw(true);
}
async function copy(text, button) {
  let done = true;
  try { await navigator.clipboard.writeText(text); } catch {
    const area = document.createElement("textarea");
    area.value = text; document.body.append(area); area.select();
    done = document.execCommand("copy");
    area.remove(); button.focus();
  }
  const word = button.textContent;
  button.textContent = done ? "Copied" : "Select it, please";
  say(done ? "Copied" : "Not copied: select the text instead");
  setTimeout(() => { button.textContent = word; }, 1500);
}
function ticked(node, text, checked, change, note) {
  const label = document.createElement("label"), box = document.createElement("input");
  box.type = "checkbox"; box.checked = checked;
  box.addEventListener("change", () => change(box.checked));
  const words = document.createElement("span");
  words.textContent = text;
  label.append(box, words);
  if (note) { words.append(document.createElement("br"), note); }
  node.append(label);
  return { label, box };
}
function buildLimits() {
  for (const [number, one] of LIMITS.entries()) {
    one.note = document.createElement("small");
    const { label, box } = ticked(byId("limits"), one.text, one.asked, (on) => { one.asked = on; refresh(); say(byId("count").textContent); }, one.note);
    one.box = box;
    const light = (lit) => () => { STATE.lit = lit; redraw(true); };
    label.addEventListener("pointerenter", light(number)); label.addEventListener("pointerleave", light(-1));
    box.addEventListener("focus", () => { if (box.matches(":focus-visible")) light(number)(); }); box.addEventListener("blur", light(-1));
  }
  const all = (on) => () => { for (const one of LIMITS) { one.asked = on; one.box.checked = on; } refresh(); say(byId("count").textContent); };
  byId("every").addEventListener("click", all(true));
  byId("none").addEventListener("click", all(false));
  byId("held").textContent = DATA.held;
}
function buildChoices() {
  for (const key of ["x", "y", "c"]) {
    const list = byId(key);
    COLUMNS.forEach((column, k) => { const one = document.createElement("option"); one.value = k; one.textContent = column.head; list.append(one); });
    list.value = STATE[key];
    list.addEventListener("change", () => { STATE[key] = Number(list.value); if (key !== "c") look(WHOLE); refresh(); });
  }
  COLUMNS.forEach((column, k) => CHOICES.push(ticked(byId("choose"), column.head, STATE.axes.includes(k), (on) => {
    STATE.axes = on ? [...STATE.axes, k].sort((a, b) => a - b) : STATE.axes.filter((one) => one !== k);
    if (!on) STATE.ranges.delete(k);
    buildAxes(); refresh();
  }).box));
}
function begin() {
  byId("name").textContent = DATA.name;
  byId("summary").textContent = DATA.summary;
  byId("where").textContent = DATA.where;
  byId("base").textContent = DATA.design;
  buildChoices(); buildLimits(); buildAxes(); buildZoom(); buildTable(); buildCompare();
  const scatter = byId("scatter");
  scatter.addEventListener("pointermove", (event) => hover(nearest(event)));
  scatter.addEventListener("pointerleave", () => hover(-1));
  scatter.addEventListener("click", (event) => { if (DRAGGED) DRAGGED = false; else pin(nearest(event)); });
  scatter.addEventListener("pointerdown", brushFrame);
  scatter.addEventListener("keydown", keyed);
  byId("lines").addEventListener("pointerdown", onLines);
  byId("clear").addEventListener("click", () => { STATE.ranges.clear(); refresh(); say(byId("count").textContent); });
  byId("verb").addEventListener("change", () => describe(STATE.pinned));
  byId("copy").addEventListener("click", () => copy(byId("command").textContent, byId("copy")));
  byId("copy-base").addEventListener("click", () => copy(DATA.design, byId("copy-base")));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  window.addEventListener("beforeprint", () => printing(true));
  window.addEventListener("afterprint", () => printing(false));
  new ResizeObserver(redraw).observe(byId("axes"));
  new ResizeObserver(redraw).observe(scatter);
  refresh();
  describe(-1);
  if (DATA.start.row >= 0) pin(DATA.start.row);
}
begin();
