"use strict";
// Decode the data of the page: columns of numbers, limits, sections.
const DATA = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);

function decoded(text, kind) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return new kind(bytes.buffer);
}

const N = DATA.rows;
// Ends of a column's scale. A few outliers are drawn at the ends of the scale, so that the other
// values are distinguishable; `below` and `above` state whether there are outliers.
function ends(values, texts) {
  const sorted = values.filter(Number.isFinite).sort(), n = sorted.length;
  if (!n) return { low: 0, high: 1 };
  const first = sorted[0], last = sorted[n - 1];
  const from = sorted[Math.floor(0.1 * (n - 1))], to = sorted[Math.ceil(0.9 * (n - 1))], room = to - from;
  if (texts || !room) return { low: first, high: last };
  const below = first < from - room, above = last > to + room;
  return { low: below ? from - 0.1 * room : first, high: above ? to + 0.1 * room : last, below, above };
}
function held(column, value) { return value !== value ? value : Math.min(Math.max(value, column.low), column.high); }
function lowText(column) { return (column.below ? "≤ " : "") + shown(column, column.low); }
function highText(column) { return (column.above ? "≥ " : "") + shown(column, column.high); }
const COLUMNS = DATA.columns.map((one) => {
  const values = one.data !== undefined ? decoded(one.data, Float32Array)
    : one.codes !== undefined ? Float32Array.from(decoded(one.codes, Uint16Array))
    : new Float32Array(N).fill(one.value);
  return { ...one, values, ...ends(values, one.texts), head: one.unit ? `${one.label}, ${one.unit}` : one.label };
});
const LIMITS = DATA.limits.map((one) => {
  const margin = decoded(one.margin, Float32Array);
  const cut = new Uint8Array(N);
  let count = 0;
  for (let k = 0; k < N; k++) if (!(margin[k] >= -1e-6)) { cut[k] = 1; count++; }
  return { ...one, margin, cut, count, asked: DATA.start.asked };
});
const EXACT = DATA.exact.map((one) => one.data === undefined
  ? { ...one, codes: decoded(one.codes, Uint16Array) } : { ...one, values: decoded(one.data, Float64Array) });

function shown(column, value) {
  if (column.texts) return column.texts[value];
  return Number.isFinite(value) ? trimmed(value) : "–";
}
function trimmed(value, digits) {
  const size = Math.abs(value), far = size !== 0 && (size >= 1e6 || size < 1e-3);
  const number = Number(value.toPrecision(digits || (size >= 1000 && !far ? 6 : 4)));
  if (size === 0 || (size >= 1e-4 && size < 1e9)) return String(number).replace("-", "−");
  const [front, power] = number.toExponential().split("e");
  return `${front.replace("-", "−")}×10${[...power.replace("+", "")].map((c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]).join("")}`;
}

// Quote a word for a POSIX shell.
function quoted(word) {
  return /^[\w@%+=:,./-]+$/.test(word) ? word : "'" + word.replaceAll("'", "'\"'\"'") + "'";
}
function commandOf(row) {
  const words = [...DATA.command];
  words[1] = byId("verb").value;
  for (const one of EXACT) {
    const value = one.codes ? one.texts[one.codes[row]] : String(one.values[row]);
    words.push("--set", `${one.path}=${value}`);
  }
  return words.map(quoted).join(" ");
}

const STATE = { x: DATA.start.x, y: DATA.start.y, c: DATA.start.c, axes: DATA.start.axes.slice(),
  ranges: new Map(), pinned: -1, a: -1, hover: -1, lit: -1 };
let VISIBLE = new Uint8Array(N), COUNT = 0;
const MISSED = new Uint16Array(N);

function filter() {
  COUNT = 0;
  const asked = LIMITS.filter((one) => one.asked);
  for (let k = 0; k < N; k++) {
    MISSED[k] = 0;
    for (const one of asked) MISSED[k] += one.cut[k];
    let keep = MISSED[k] ? 0 : 1;
    if (keep) for (const [column, [low, high]] of STATE.ranges) {
      const v = COLUMNS[column].values[k];
      if (!(v >= low && v <= high)) { keep = 0; break; }
    }
    VISIBLE[k] = keep;
    COUNT += keep;
  }
}

// Follow the pointer until it is let go.
function dragging(move, done) {
  const up = () => {
    window.removeEventListener("pointermove", move);
    for (const kind of ["pointerup", "pointercancel"]) window.removeEventListener(kind, up);
    done();
  };
  window.addEventListener("pointermove", move);
  for (const kind of ["pointerup", "pointercancel"]) window.addEventListener(kind, up);
}

function ticks(low, high, most) {
  const rough = (high - low) / most || 1, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough) || rough;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && found.length < 50; k++) found.push(k * step);
  return found;
}
const STOPS = [[58, 91, 208], [34, 143, 190], [42, 168, 118], [186, 152, 28], [212, 92, 42]];
const NONE = "#888888";
const KINDS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8f7bd8", "#7a8a3a"];
function colour(column, value) {
  if (column.texts) return KINDS[value % KINDS.length];
  if (!Number.isFinite(value)) return NONE;
  const share = column.high > column.low ? (value - column.low) / (column.high - column.low) : 0.5;
  const at = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1), k = Math.min(Math.floor(at), STOPS.length - 2);
  const part = at - k;
  return `rgb(${STOPS[k].map((v, i) => Math.round(v + (STOPS[k + 1][i] - v) * part)).join(",")})`;
}
function ink(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }
function canvas(id) {
  const node = byId(id), box = node.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
  const w = Math.max(box.width, 1), h = Math.max(box.height, 1);
  const wide = Math.round(w * ratio), high = Math.round(h * ratio);
  if (node.width !== wide || node.height !== high) { node.width = wide; node.height = high; }
  const g = node.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  g.font = "12px system-ui, 'DejaVu Sans', sans-serif";
  return { g, w, h };
}
// Show a canvas as it was last painted; paint it again if that is out of date.
const KEPT = new Map();
function kept(id, paint) {
  const drawn = canvas(id), { g, w, h } = drawn;
  if (KEPT.has(id)) { g.drawImage(KEPT.get(id), 0, 0, w, h); return drawn; }
  paint(g, w, h);
  const copy = document.createElement("canvas"), node = byId(id);
  copy.width = node.width; copy.height = node.height;
  copy.getContext("2d").drawImage(node, 0, 0);
  KEPT.set(id, copy);
  return drawn;
}
