// The trade-off: a curve with the present design and A.
const ROOM = { left: 52, right: 14, top: 10, bottom: 34 };

function ticks(low, high) {
  const step = roundStep((high - low) / 4), found = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) found.push(exact(v));
  return found;
}
// points: [{x, y}] in display units, y null where no design was found; marks: [{x, y, kind, name}].
// `why` says why there is no curve.
function drawTrade(points, marks, across, up, why) {
  const svg = byId("trade"), [width, height] = sizeOf(svg, 400, 210);
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const ys = [...points, ...marks].map((one) => one.y).filter((y) => y !== null), xs = [...points, ...marks].map((one) => one.x);
  if (why || points.length < 2 || !ys.length) {
    svg.replaceChildren(shape("text", { x: 8, y: 24 }, why || "The curve is being calculated …"));
    return;
  }
  const x0 = Math.min(...xs), x1 = Math.max(...xs);
  let y0 = Math.min(...ys), y1 = Math.max(...ys);
  const room = Math.max((y1 - y0) * 0.08, Math.abs(y1) * 0.002, 1e-12);
  y0 -= room; y1 += room;
  const px = (x) => ROOM.left + (x - x0) / (x1 - x0) * (width - ROOM.left - ROOM.right);
  const py = (y) => height - ROOM.bottom - (y - y0) / (y1 - y0) * (height - ROOM.top - ROOM.bottom);
  const drawn = [];
  for (const v of ticks(y0, y1)) drawn.push(shape("path", { class: "axis", d: `M${ROOM.left} ${py(v)}H${width - ROOM.right}` }), shape("text", { x: ROOM.left - 6, y: py(v) + 4, "text-anchor": "end" }, trimmed(v)));
  for (const v of ticks(x0, x1)) drawn.push(shape("text", { x: px(v), y: height - ROOM.bottom + 15, "text-anchor": "middle" }, trimmed(v)));
  points.forEach((one, k) => {
    if (one.y !== null) return;
    const from = k ? (points[k - 1].x + one.x) / 2 : one.x, to = k + 1 < points.length ? (points[k + 1].x + one.x) / 2 : one.x;
    drawn.push(shape("rect", { class: "none", x: px(from), y: ROOM.top, width: Math.max(px(to) - px(from), 1), height: height - ROOM.top - ROOM.bottom }));
  });
  let d = "", open = false;
  for (const one of points) {
    if (one.y !== null) d += `${open ? "L" : "M"}${px(one.x).toFixed(1)} ${py(one.y).toFixed(1)}`;
    open = one.y !== null;
  }
  drawn.push(shape("path", { class: "line", d }));
  for (const one of points) if (one.y !== null) drawn.push(shape("circle", { class: "dot", cx: px(one.x), cy: py(one.y), r: 2 }));
  for (const mark of marks) {
    const dot = shape("circle", { class: mark.kind, cx: px(mark.x), cy: py(mark.y), r: 5.5 });
    dot.append(shape("title", {}, mark.name));
    drawn.push(dot);
  }
  drawn.push(shape("text", { x: width - ROOM.right, y: height - 4, "text-anchor": "end" }, across), shape("text", { x: 4, y: height - 4 }, `up: ${up}`));
  svg.replaceChildren(...drawn);
}
