// Parallel axes: a line for each design. Ranges are set by dragging, or by handles at their ends.
const TOP = 80, FOOT = 24;
let AXES = [];

function axisPlaces() {
  const box = byId("axes").getBoundingClientRect(), n = STATE.axes.length, side = Math.min(70, box.width / (2 * n));
  const apart = n > 1 ? (box.width - 2 * side) / (n - 1) : 0;
  return { apart: n > 1 ? apart : box.width - 20, low: box.height - FOOT, at: (k) => side + k * apart };
}
function shareOf(column, value) { return column.high > column.low ? (held(column, value) - column.low) / (column.high - column.low) : 0.5; }

const MOST = [4000, 10000];
// Designs to draw as lines, either excluded or passing. Of too many, every n-th; returns also n.
function thinned(visible) {
  const step = Math.ceil((visible ? COUNT : N - COUNT) / MOST[visible]), rows = [];
  for (let k = 0, seen = 0; k < N; k++) if (VISIBLE[k] === visible && seen++ % step === 0) rows.push(k);
  return [rows, step];
}
function drawLines() {
  const { g } = kept("lines", paintLines), { at, low } = axisPlaces();
  for (const [row, name] of [[STATE.hover, "--grey"], [STATE.pinned, "--ink"], [STATE.a, "--accent"]]) if (row >= 0) {
    g.lineWidth = 2.5; g.strokeStyle = ink(name); g.setLineDash(row === STATE.a ? [7, 4] : []);
    trace(g, STATE.axes.map((k) => COLUMNS[k]), at, low, row);
  }
  g.setLineDash([]);
}
function trace(g, columns, at, low, row) {
  let pen = false;
  g.beginPath();
  columns.forEach((column, k) => {
    const v = column.values[row];
    if (v !== v) { pen = false; return; }
    const y = low - shareOf(column, v) * (low - TOP);
    if (pen) g.lineTo(at(k), y); else g.moveTo(at(k), y);
    pen = true;
  });
  g.stroke();
}
function paintLines(g, w) {
  const { at, low } = axisPlaces(), columns = STATE.axes.map((k) => COLUMNS[k]), c = COLUMNS[STATE.c];
  const y = (column, v) => low - shareOf(column, v) * (low - TOP);
  const [cut, nth] = thinned(0), [left, every] = thinned(1);
  g.lineWidth = 1;
  g.strokeStyle = ink("--faint"); g.globalAlpha = Math.min(0.6, 250 / (cut.length + 1) + 0.06);
  for (const k of cut) trace(g, columns, at, low, k);
  g.globalAlpha = Math.min(0.9, 300 / (left.length + 1) + 0.15);
  for (const k of left) { g.strokeStyle = colour(c, c.values[k]); trace(g, columns, at, low, k); }
  g.globalAlpha = 1;
  columns.forEach((column, k) => drawAxis(g, w, column, at(k), low, y, STATE.ranges.get(STATE.axes[k])));
  byId("lines-drawn").textContent = [[every, "passes"], [nth, "is cut"]].filter(([step]) => step > 1)
    .map(([step, words]) => `One line in ${step} of what ${words} is drawn.`).join(" ");
}
function drawAxis(g, w, column, x, low, y, range) {
  g.lineWidth = 1.5; g.strokeStyle = ink("--ink");
  g.beginPath(); g.moveTo(x, TOP); g.lineTo(x, low); g.stroke();
  if (range) {
    const from = y(column, Math.min(range[1], column.high)), to = y(column, Math.max(range[0], column.low));
    g.fillStyle = ink("--accent"); g.globalAlpha = 0.3; g.fillRect(x - 8, from, 16, Math.max(to - from, 2)); g.globalAlpha = 1;
  }
  g.fillStyle = ink("--ink"); g.textAlign = "center";
  const room = Math.min(axisPlaces().apart - 4, 110);
  for (const [words, y] of [[highText(column), TOP - 9], [lowText(column), low + 18]]) {
    const text = fitted(g, words, room), half = g.measureText(text).width / 2;
    g.fillText(text, Math.min(Math.max(x, half), w - half), y);
  }
}

function setRange(column, low, high) {
  const one = COLUMNS[column];
  if (low > high) [low, high] = [high, low];
  if (low <= one.low && high >= one.high) STATE.ranges.delete(column);
  else STATE.ranges.set(column, [low <= one.low ? -Infinity : low, high >= one.high ? Infinity : high]);
  refresh();
}
// The selected range of a column, within its scale; a range may end where the scale ends.
function rangeOf(column) { return (STATE.ranges.get(column) || [-Infinity, Infinity]).map((v) => held(COLUMNS[column], v)); }

// The name of a column, as text that may break after the separators of a PATH.
function broken(column, name = column.name) {
  const words = document.createElement("span");
  for (const part of (column.unit ? `${name}, ${column.unit}` : name).split(/(?<=[._\]])/)) {
    words.append(part, document.createElement("wbr"));
  }
  return words;
}
// Show axes of these columns, so that their ranges are visible.
function showAxes(columns) {
  for (const column of columns) if (!STATE.axes.includes(column)) CHOICES[column].click();
}
// Build the names of the axes, and two sliders for each axis.
function buildAxes() {
  const box = byId("axes");
  for (const one of AXES) for (const node of [one.name, ...one.handles]) node.remove();
  box.style.minWidth = `${76 * STATE.axes.length}px`;
  AXES = STATE.axes.map((column) => {
    const name = document.createElement("div");
    name.className = "axis-name"; name.append(broken(COLUMNS[column])); name.title = COLUMNS[column].head;
    const handles = ["least", "most"].map((word, end) => {
      const node = document.createElement("div");
      node.className = "handle"; node.tabIndex = 0;
      node.setAttribute("role", "slider"); node.setAttribute("aria-orientation", "vertical");
      node.setAttribute("aria-label", `${word} ${COLUMNS[column].head}`);
      node.addEventListener("keydown", (event) => slide(event, column, end));
      node.addEventListener("pointerdown", (event) => { event.preventDefault(); node.focus(); brush(event, column, end); });
      return node;
    });
    box.append(name, ...handles);
    return { column, name, handles };
  });
  placeAxes();
}
function placeAxes() {
  const { at, low, apart } = axisPlaces(), { width } = byId("axes").getBoundingClientRect();
  const across = (x) => `${100 * x / width}%`;
  AXES.forEach((one, k) => {
    const column = COLUMNS[one.column], wide = Math.min(apart - 8, 170);
    one.name.style.width = across(wide); one.name.style.left = across(Math.max(at(k) - wide / 2, 0));
    rangeOf(one.column).forEach((value, end) => {
      const node = one.handles[end], share = column.high > column.low ? shareOf(column, value) : end;
      node.style.left = across(at(k)); node.style.top = `${low - share * (low - TOP) + (end ? -1 : 1)}px`;
      node.setAttribute("aria-valuemin", column.low); node.setAttribute("aria-valuemax", column.high);
      node.setAttribute("aria-valuenow", value);
      node.setAttribute("aria-valuetext", `${shown(column, column.texts ? Math.round(value) : value)} ${column.unit || ""}`.trim());
    });
  });
}
function slide(event, column, end) {
  const one = COLUMNS[column], span = one.high - one.low, range = rangeOf(column).slice();
  const step = one.texts ? 1 : span / 50, far = one.texts ? 1 : span / 5;
  const moves = { ArrowUp: step, ArrowRight: step, ArrowDown: -step, ArrowLeft: -step, PageUp: far, PageDown: -far };
  if (event.key === "Delete" || event.key === "Backspace" || event.key === "Escape") setRange(column, one.low, one.high);
  else if (event.key === "Home") { range[end] = end ? range[0] : one.low; setRange(column, ...range); }
  else if (event.key === "End") { range[end] = end ? one.high : range[1]; setRange(column, ...range); }
  else if (moves[event.key]) {
    let value = Math.min(Math.max(range[end] + moves[event.key], one.low), one.high);
    value = end ? Math.max(value, range[0]) : Math.min(value, range[1]);
    if (Math.abs(value - one.low) < span * 1e-6) value = one.low;
    if (Math.abs(value - one.high) < span * 1e-6) value = one.high;
    range[end] = value; setRange(column, ...range);
  } else return;
  event.preventDefault();
  say(`${COUNT} of ${N} designs left`);
}
// Drag a new range, or one end of the existing range.
function brush(event, column, end) {
  const one = COLUMNS[column], box = byId("axes").getBoundingClientRect(), { low } = axisPlaces();
  const value = (e) => one.low + Math.min(Math.max((low - (e.clientY - box.top)) / (low - TOP), 0), 1) * (one.high - one.low);
  const started = value(event), from = event.clientY;
  let moved = false;
  const move = (e) => {
    if (Math.abs(e.clientY - from) < 4 && !moved) return;
    moved = true;
    let range = [started, value(e)];
    if (end !== undefined) { range = rangeOf(column).slice(); range[end] = end ? Math.max(value(e), range[0]) : Math.min(value(e), range[1]); }
    if (one.texts) range = [Math.ceil(Math.min(...range) - 0.5), Math.floor(Math.max(...range) + 0.5)];
    setRange(column, ...range);
  };
  dragging(move, () => {
    if (!moved && end === undefined) setRange(column, one.low, one.high);
    say(`${COUNT} of ${N} designs left`);
  });
}
function onLines(event) {
  const box = byId("axes").getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
  const { at, low } = axisPlaces();
  const k = STATE.axes.findIndex((_, i) => Math.abs(at(i) - x) < 12);
  if (k >= 0 && y > TOP - 10 && y < low + 10) { event.preventDefault(); brush(event, STATE.axes[k]); return; }
  const i = STATE.axes.findIndex((_, j) => j + 1 < STATE.axes.length && at(j) < x && x < at(j + 1));
  if (i < 0) return;
  const a = COLUMNS[STATE.axes[i]], b = COLUMNS[STATE.axes[i + 1]], part = (x - at(i)) / (at(i + 1) - at(i));
  let best = 8, found = -1;
  for (let row = 0; row < N; row++) if (VISIBLE[row]) {
    const share = shareOf(a, a.values[row]) * (1 - part) + shareOf(b, b.values[row]) * part;
    const d = Math.abs(low - share * (low - TOP) - y);
    if (d < best) { best = d; found = row; }
  }
  if (found >= 0) pin(found);
}
