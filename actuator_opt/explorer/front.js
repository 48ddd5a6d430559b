// Additions to the scatter plot: its Pareto line, and the selection of both ranges by dragging.
// Passing designs that no other passing design beats in both columns, ordered by the first column.
function front() {
  const x = COLUMNS[STATE.x], y = COLUMNS[STATE.y], a = x.values, b = y.values, rows = [];
  if (!x.better || !y.better) return rows;
  for (let k = 0; k < N; k++) if (VISIBLE[k] && a[k] === a[k] && b[k] === b[k]) rows.push(k);
  rows.sort((p, q) => x.better * (a[q] - a[p]) || y.better * (b[q] - b[p]) || p - q);
  let best = -Infinity;
  return rows.filter((k) => { const good = y.better * b[k] > best; if (good) best = y.better * b[k]; return good; });
}
// Draw the Pareto line as stairs; a point behind it is worse than some design in both columns.
function drawFront(g, rows) {
  if (!rows.length) return;
  const { px, py } = PLACED;
  g.strokeStyle = g.fillStyle = ink("--bad"); g.lineWidth = 1.6;
  g.beginPath(); g.moveTo(px[rows[0]], py[rows[0]]);
  for (let k = 1; k < rows.length; k++) { g.lineTo(px[rows[k]], py[rows[k - 1]]); g.lineTo(px[rows[k]], py[rows[k]]); }
  g.stroke();
  for (const k of rows) { g.beginPath(); g.arc(px[k], py[k], 2.2, 0, 7); g.fill(); }
}
function tellFront(rows) {
  const pair = [...new Set([COLUMNS[STATE.x], COLUMNS[STATE.y]])], unsaid = pair.filter((one) => !one.better);
  const ways = pair.map((one) => `${one.better > 0 ? "more" : "less"} ${one.label}`).join(", ");
  const without = pair.map((one) => [one, one.values.reduce((sum, v) => sum + (v !== v), 0)]).filter(([, count]) => count);
  byId("front").textContent = [
    unsaid.length ? `No Pareto line: nothing says which way ${unsaid.map((one) => one.label).join(" or ")} is better.`
      : rows.length ? `Line: ${rows.length === 1 ? "the design that betters all" : `${rows.length} designs that none betters in both`} (${ways}); ${COUNT} pass${COUNT === 1 ? "es" : ""}${DATA.thinned ? " of those shown" : ""}.` : "",
    ...without.map(([one, count]) => `${count} designs have no ${one.label} and are not drawn.`),
  ].filter(Boolean).join(" ");
}
// Draw the ranges of both columns as a frame.
function drawRanges(g, toX, toY) {
  const span = (column, at) => rangeOf(column).map(at).sort((p, q) => p - q);
  if (!STATE.ranges.has(STATE.x) && !STATE.ranges.has(STATE.y)) return;
  const [x0, x1] = span(STATE.x, toX), [y0, y1] = span(STATE.y, toY);
  g.strokeStyle = ink("--accent"); g.lineWidth = 1.5; g.setLineDash([5, 4]);
  g.strokeRect(x0, y0, x1 - x0, y1 - y0); g.setLineDash([]);
}
// Drag a frame with the mouse, also in a view that is zoomed; a touch scrolls the page instead.
function brushFrame(event) {
  DRAGGED = false;
  if (event.button) return;
  if (pans(event)) { panning(event); return; }
  if (event.pointerType === "touch") return;
  const from = onScatter(event), columns = [STATE.x, STATE.y];
  const value = (k, share) => { const [low, high] = spanOf(k); return low + share * (high - low); };
  const move = (e) => {
    const to = onScatter(e);
    if (!DRAGGED && Math.hypot(e.clientX - event.clientX, e.clientY - event.clientY) < 5) return;
    if (!DRAGGED) { DRAGGED = true; hover(-1); showAxes(columns); }
    columns.forEach((column, k) => {
      let ends = [value(k, from[k]), value(k, to[k])].sort((p, q) => p - q);
      if (COLUMNS[column].texts) ends = [Math.ceil(ends[0] - 0.5), Math.floor(ends[1] + 0.5)];
      setRange(column, ...ends);
    });
  };
  dragging(move, () => { if (DRAGGED) say(`${COUNT} of ${N} designs left`); });
}
// Position of the pointer, as shares of the two axes.
function onScatter(event) {
  const box = byId("scatter").getBoundingClientRect(), m = MARGIN, within = (v) => Math.min(Math.max(v, 0), 1);
  return [within((event.clientX - box.left - m.left) / (box.width - m.left - m.right)),
    within((box.bottom - m.bottom - event.clientY) / (box.height - m.top - m.bottom))];
}
let DRAGGED = false;
