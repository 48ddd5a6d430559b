// Zoom of the scatter plot: the part of both scales that it shows, as shares of the whole scales.
const WHOLE = [[0, 1], [0, 1]], CLOSEST = 1000;
let VIEW = WHOLE;

// The shown part of the scale across (0) or up (1).
function spanOf(k) {
  const [low, high] = axisSpan(COLUMNS[k ? STATE.y : STATE.x]);
  return VIEW[k].map((share) => low + share * (high - low));
}
function look(view) {
  VIEW = view.every(([from, to]) => to - from >= 1 - 1e-9) ? WHOLE
    : view.map(([from, to]) => { const shift = Math.max(-from, 0) + Math.min(1 - to, 0); return [from + shift, to + shift]; });
  const times = 1 / (VIEW[0][1] - VIEW[0][0]);
  byId("times").textContent = VIEW === WHOLE ? "" : `${trimmed(Number(times.toPrecision(2)))}×`;
  byId("scatter").classList.toggle("zoomed", VIEW !== WHOLE);
  KEPT.delete("scatter");
  redraw(true);
}
// Zoom about a point, given as shares of the plot, or about the chosen design.
function zoom(factor, about = middle()) {
  look(VIEW.map(([from, to], k) => {
    const wide = Math.min(Math.max((to - from) / factor, 1 / CLOSEST), 1), start = from + about[k] * (to - from - wide);
    return [start, start + wide];
  }));
}
function pan(across, up) {
  const [wide, high] = VIEW.map(([from, to]) => to - from);
  look([VIEW[0].map((share) => share + across * wide), VIEW[1].map((share) => share + up * high)]);
}
function placeOf(row) {
  return [STATE.x, STATE.y].map((column, k) => {
    const [low, high] = spanOf(k), one = COLUMNS[column];
    return row < 0 ? NaN : (held(one, one.values[row]) - low) / (high - low);
  });
}
function inView(place) { return place.every((share) => share >= 0 && share <= 1); }
function middle() { const place = placeOf(STATE.pinned); return inView(place) ? place : [0.5, 0.5]; }
// Move the view until it shows a design.
function reveal(row) {
  const place = placeOf(row);
  if (VIEW !== WHOLE && place.every(Number.isFinite) && !inView(place)) pan(place[0] - 0.5, place[1] - 0.5);
}
function sayView() {
  say(VIEW === WHOLE ? "All designs in view" : [STATE.x, STATE.y].map((column, k) => {
    const one = COLUMNS[column], [low, high] = spanOf(k);
    return `${one.label} from ${trimmed(low)} to ${trimmed(high)} ${one.unit}`.trim();
  }).join(", "));
}
// The wheel zooms once the plot has the focus, or with Ctrl; else it scrolls the page.
function wheeled(event) {
  const pinch = event.ctrlKey;
  if (!pinch && (document.activeElement !== byId("scatter") || (VIEW === WHOLE && event.deltaY > 0))) return;
  event.preventDefault();
  zoom(2 ** (-event.deltaY * (event.deltaMode ? 30 : 1) * (pinch ? 5 : 1) / 300), onScatter(event));
}
const ZOOM_KEYS = { "+": () => zoom(1.5), "=": () => zoom(1.5), "-": () => zoom(1 / 1.5), 0: () => look(WHOLE) };
const PAN_KEYS = { ArrowRight: [0.2, 0], ArrowLeft: [-0.2, 0], ArrowUp: [0, 0.2], ArrowDown: [0, -0.2] };
function zoomKey(event) {
  const key = ZOOM_KEYS[event.key], way = event.shiftKey && PAN_KEYS[event.key];
  if (key) key(); else if (way) pan(...way); else return false;
  sayView();
  return true;
}
// Shift and drag, or a finger on a plot that is zoomed, moves the view.
function pans(event) { return VIEW !== WHOLE && (event.shiftKey || event.pointerType === "touch"); }
function panning(event) {
  const box = byId("scatter").getBoundingClientRect(), wide = box.width - MARGIN.left - MARGIN.right, high = box.height - MARGIN.top - MARGIN.bottom;
  let { clientX: x, clientY: y } = event;
  dragging((e) => {
    if (!DRAGGED && Math.hypot(e.clientX - x, e.clientY - y) < 5) return;
    DRAGGED = true;
    pan((x - e.clientX) / wide, (e.clientY - y) / high);
    ({ clientX: x, clientY: y } = e);
  }, () => { if (DRAGGED) sayView(); });
}
function buildZoom() {
  const scatter = byId("scatter");
  scatter.addEventListener("wheel", wheeled, { passive: false });
  for (const [id, change] of [["closer", () => zoom(1.5)], ["farther", () => zoom(1 / 1.5)], ["whole", () => look(WHOLE)]]) {
    byId(id).addEventListener("click", () => { change(); sayView(); });
  }
}
