// Scatter plot of two columns, coloured by a third. The user selects designs by pointer or keys.
const MARGIN = { left: 76, right: 14, top: 10, bottom: 42 };
let PLACED = { px: new Float32Array(N), py: new Float32Array(N) };

function axisSpan(column) {
  const room = (column.high - column.low || Math.abs(column.high) || 1) * 0.04;
  return [column.low - room, column.high + room];
}
// The points are painted once; marks of the selected designs are drawn above them.
function drawScatter() {
  const { g, w, h } = kept("scatter", paintScatter), { px, py } = PLACED;
  g.save(); clip(g, w, h);
  if (STATE.lit >= 0) drawCut(g, LIMITS[STATE.lit].cut);
  for (const [row, name] of [[STATE.pinned, "--ink"], [STATE.hover, "--grey"], [STATE.a, "--accent"]]) if (row >= 0 && px[row] === px[row] && py[row] === py[row]) {
    g.strokeStyle = g.fillStyle = ink(name); g.lineWidth = 2;
    g.beginPath(); g.arc(px[row], py[row], 7, 0, 7); g.stroke();
    g.fillText(letter(row), px[row] + 9, py[row] - 6);
  }
  g.restore();
}
function clip(g, w, h) {
  const m = MARGIN;
  g.beginPath(); g.rect(m.left, m.top, w - m.left - m.right, h - m.top - m.bottom); g.clip();
}
function paintScatter(g, w, h) {
  const m = MARGIN;
  const x = COLUMNS[STATE.x], y = COLUMNS[STATE.y], c = COLUMNS[STATE.c];
  const [x0, x1] = spanOf(0), [y0, y1] = spanOf(1);
  const toX = (v) => m.left + (v - x0) / (x1 - x0) * (w - m.left - m.right);
  const toY = (v) => h - m.bottom - (v - y0) / (y1 - y0) * (h - m.top - m.bottom);
  drawFrame(g, w, h, x, y, toX, toY, [x0, x1, y0, y1]);
  const { px, py } = PLACED;
  g.save(); clip(g, w, h);
  const small = N > 500 ? 2 : 3.2;
  g.fillStyle = ink("--faint");
  for (let k = 0; k < N; k++) {
    px[k] = toX(held(x, x.values[k])); py[k] = toY(held(y, y.values[k]));
    if (!VISIBLE[k] && px[k] === px[k] && py[k] === py[k]) { g.beginPath(); g.arc(px[k], py[k], small, 0, 7); g.fill(); }
  }
  const size = N > 2500 ? 2.6 : 3.6;
  for (let k = 0; k < N; k++) if (VISIBLE[k] && px[k] === px[k] && py[k] === py[k]) {
    g.fillStyle = colour(c, c.values[k]);
    g.beginPath(); g.arc(px[k], py[k], size, 0, 7); g.fill();
  }
  const best = front();
  drawFront(g, best);
  drawRanges(g, toX, toY);
  g.restore();
  if (!COUNT) { g.fillStyle = ink("--grey"); g.textAlign = "center"; g.fillText("No design passes all that is asked for; those it cuts are faint.", w / 2, m.top + 16); }
  tellFront(best);
}
// Draw a cross over every design that a requirement excludes.
function drawCut(g, cut) {
  g.strokeStyle = ink("--bad"); g.lineWidth = 1;
  g.beginPath();
  for (let k = 0; k < N; k++) if (cut[k]) {
    const x = PLACED.px[k], y = PLACED.py[k];
    g.moveTo(x - 3, y - 3); g.lineTo(x + 3, y + 3); g.moveTo(x + 3, y - 3); g.lineTo(x - 3, y + 3);
  }
  g.stroke();
}
// Ticks within a span, each with its text, which has the digits that tell it from the next one.
function places(column, low, high, most) {
  if (column.texts) return column.texts.map((text, k) => [k, text]).filter(([k]) => k >= low && k <= high);
  const found = ticks(Math.max(low, -3e38), Math.min(high, 3e38), most), step = found[1] - found[0];
  const size = Math.max(...found.map(Math.abs)), digits = Math.min(Math.ceil(Math.log10(size / step)) + 1, 9);
  return found.map((v) => [v, digits > 4 ? trimmed(v, digits) : shown(column, v)]);
}
function drawFrame(g, w, h, x, y, toX, toY, [x0, x1, y0, y1]) {
  const m = MARGIN;
  g.strokeStyle = ink("--line"); g.lineWidth = 1; g.fillStyle = ink("--ink");
  g.strokeRect(m.left + 0.5, m.top + 0.5, w - m.left - m.right, h - m.top - m.bottom);
  g.textAlign = "center"; g.textBaseline = "top";
  let free = -Infinity;
  for (const [v, label] of places(x, x0, x1, Math.max(2, Math.floor((w - m.left) / 90)))) {
    const at = toX(v), text = fitted(g, label, 110), half = g.measureText(text).width / 2;
    g.beginPath(); g.moveTo(at, h - m.bottom); g.lineTo(at, h - m.bottom + 4); g.stroke();
    if (at - half > free) { g.fillText(text, at, h - m.bottom + 6); free = at + half + 6; }
  }
  g.fillText(fitted(g, x.head, w - m.left - m.right), (m.left + w - m.right) / 2, h - 16);
  g.textAlign = "right"; g.textBaseline = "middle";
  for (const [v, label] of places(y, y0, y1, 6)) {
    const at = toY(v);
    g.beginPath(); g.moveTo(m.left - 4, at); g.lineTo(m.left, at); g.stroke();
    g.fillText(fitted(g, label, m.left - 24), m.left - 6, at);
  }
  g.save(); g.translate(11, (m.top + h - m.bottom) / 2); g.rotate(-Math.PI / 2); g.textAlign = "center";
  g.fillText(fitted(g, y.head, h - m.top - m.bottom), 0, 0); g.restore();
  g.textBaseline = "alphabetic";
}
function fitted(g, text, room) {
  if (g.measureText(text).width <= room) return text;
  while (text.length > 1 && g.measureText(text + "…").width > room) text = text.slice(0, -1);
  return text + "…";
}
function drawLegend() {
  const { g, w } = canvas("legend"), c = COLUMNS[STATE.c];
  g.fillStyle = ink("--ink"); g.textBaseline = "top";
  g.fillText(fitted(g, `colour: ${c.head}`, w - MARGIN.left), MARGIN.left, 2);
  if (c.texts) {
    let at = MARGIN.left;
    for (let k = 0; k < c.texts.length && at < w - 60; k++) {
      g.fillStyle = KINDS[k % KINDS.length]; g.fillRect(at, 20, 10, 10);
      g.fillStyle = ink("--ink");
      const text = fitted(g, c.texts[k], 140);
      g.fillText(text, at + 14, 19); at += 30 + g.measureText(text).width;
    }
    return;
  }
  const wide = Math.min(w - MARGIN.left - 120, 320);
  for (let k = 0; k < wide; k++) {
    g.fillStyle = colour(c, c.low + (c.high - c.low) * k / Math.max(wide - 1, 1)); g.fillRect(MARGIN.left + k, 18, 1.5, 8);
  }
  g.fillStyle = ink("--ink");
  g.fillText(lowText(c), MARGIN.left, 30);
  g.textAlign = "right"; g.fillText(highText(c), MARGIN.left + wide, 30); g.textAlign = "left";
  if (c.values.some((v) => v !== v)) { g.fillStyle = NONE; g.fillRect(MARGIN.left + wide + 16, 18, 8, 8); g.fillStyle = ink("--ink"); g.fillText("none", MARGIN.left + wide + 28, 16); }
}
function nearest(event) {
  const box = byId("scatter").getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
  const m = MARGIN, within = (k) => PLACED.px[k] >= m.left && PLACED.px[k] <= box.width - m.right && PLACED.py[k] >= m.top && PLACED.py[k] <= box.height - m.bottom;
  let best = 18 * 18, found = -1;
  for (const wanted of [1, 0]) {
    for (let k = 0; k < N; k++) if (VISIBLE[k] === wanted && within(k)) {
      const d = (PLACED.px[k] - x) ** 2 + (PLACED.py[k] - y) ** 2;
      if (d < best) { best = d; found = k; }
    }
    if (found >= 0) return found;
  }
  return found;
}
// The next design in order of one column, then the other; only passing designs, if there are any.
function stepped(first, second, way) {
  const a = COLUMNS[first].values, b = COLUMNS[second].values, rows = [];
  for (let k = 0; k < N; k++) if ((VISIBLE[k] || !COUNT) && a[k] === a[k] && b[k] === b[k]) rows.push(k);
  if (!rows.length) return STATE.pinned;
  const before = (p, q) => a[p] - a[q] || b[p] - b[q] || p - q;
  rows.sort(before);
  if (way === "first") return rows[0];
  if (way === "last") return rows[rows.length - 1];
  if (STATE.pinned < 0) return rows[way > 0 ? 0 : rows.length - 1];
  if (way > 0) return rows.find((k) => before(k, STATE.pinned) > 0) ?? rows[rows.length - 1];
  return rows.findLast((k) => before(k, STATE.pinned) < 0) ?? rows[0];
}
function keyed(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const { x, y } = STATE;
  const ways = { ArrowRight: [x, y, 1], ArrowLeft: [x, y, -1], ArrowUp: [y, x, 1], ArrowDown: [y, x, -1],
    Home: [x, y, "first"], End: [x, y, "last"] };
  if (zoomKey(event)) { event.preventDefault(); return; }
  if (event.key === "Escape") pin(-1);
  else if (event.key === "p" || event.key === "P") { if (STATE.pinned >= 0) pinA(STATE.pinned); }
  else if (event.key === "Delete" || event.key === "Backspace") { for (const one of [x, y]) STATE.ranges.delete(one); refresh(); say(byId("count").textContent); }
  else if (ways[event.key]) { pin(stepped(...ways[event.key])); reveal(STATE.pinned); }
  else return;
  event.preventDefault();
}
