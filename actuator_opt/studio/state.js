// What is asked now, what was answered, and the way from one to the other.
// Changes are kept in display units by PATH, relative to the file.
const PATIENCE = 400, CALM = 250, MOST_UNDO = 200, CHUNK = 5, MERGE = 800;
const S = {
  design: null, goal: null, sliders: new Map(), menus: new Map(), describedFor: "", changes: {}, committed: {}, past: [], future: [],
  shown: null, shownFor: "", searching: "", good: null, goodFor: {}, lost: {}, A: null, priced: null, curves: new Map(), focused: "", touched: { path: "", key: false, time: 0 },
};

const keyOf = (changes, without) => JSON.stringify(Object.keys(changes).filter((path) => path !== without).sort().map((path) => [path, changes[path]]));
const control = (path) => S.sliders.get(path) ?? S.menus.get(path);
const wishes = (changes) => Object.fromEntries(Object.entries(changes).map(([path, value]) => [path, control(path).wish(value)]));
// The words among some changes: with other words a design has other numbers, dimensions and menus.
const wordsOf = (changes) => keyOf(Object.fromEntries(Object.entries(changes).filter(([, value]) => typeof value === "string")));

function change(path, value) {
  const next = { ...S.changes };
  if (value === control(path).file) delete next[path];
  else next[path] = value;
  S.changes = next;
  note("");
}

// ---- one request under way; the newest wish waits, or replaces a slow one ----
const LINE = { latest: 0, active: 0, started: 0, waiting: false, timer: 0 };

function solve() {
  clearTimeout(REST.timer);
  const left = PATIENCE - (performance.now() - LINE.started);
  if (LINE.active && left > 0) {
    LINE.waiting = true;
    if (!LINE.timer) LINE.timer = setTimeout(() => { LINE.timer = 0; if (LINE.waiting) solve(); }, left);
    return;
  }
  LINE.waiting = false;
  request();
}
async function request() {
  const serial = ++LINE.latest, changes = S.changes;
  LINE.active++;
  LINE.started = performance.now();
  byId("main").setAttribute("aria-busy", "true");
  let data = null, why = "";
  try { data = await ask("solve", { changes: wishes(changes), ...(wordsOf(changes) === S.describedFor ? {} : { describe: true }) }); } catch (fault) { why = fault.message; }
  LINE.active--;
  const newest = serial === LINE.latest;
  if (LINE.waiting && !LINE.active) { LINE.waiting = false; clearTimeout(LINE.timer); LINE.timer = 0; request(); }
  if (!newest) return;
  if (!data) {
    control(S.touched.path)?.refuse(why);
    return;
  }
  if (data.dropped) { setTimeout(solve, CALM); return; }
  truth(data, changes);
}
function truth(data, changes) {
  control(S.touched.path)?.refuse("");
  if (data.design) { S.describedFor = wordsOf(changes); describe(data.design); }
  if (data.searching) { search(changes); return; }
  S.searching = "";
  S.shown = data;
  S.shownFor = keyOf(changes);
  if (data.feasible) {
    S.good = data;
    S.goodFor = changes;
    for (const [path, slider] of S.sliders) slider.fits = changes[path] ?? slider.file;
  } else S.lost = changes;
  paint();
  if (S.shownFor === keyOf(S.changes)) {
    byId("main").setAttribute("aria-busy", "false");
    settle();
  }
}

// The steps from the optimum reached no design: search for one, until a newer wish ends that.
async function search(changes) {
  const serial = LINE.latest;
  S.searching = keyOf(changes);
  S.lost = changes;
  paint();
  let data = { dropped: true };
  try { data = await ask("solve", { changes: wishes(changes), whole: true }); } catch (fault) { if (!(fault instanceof Unfit)) throw fault; }
  if (serial !== LINE.latest || S.searching !== keyOf(S.changes)) return;
  if (data.dropped) setTimeout(solve, CALM);
  else truth(data, changes);
}

// ---- forecast: by the price as long as it holds, else along the curve ----
function predicted() {
  const now = keyOf(S.changes);
  if (!S.priced || now === S.shownFor) return null;
  const paths = [...new Set([...Object.keys(S.changes), ...Object.keys(S.priced.changes)])];
  const different = paths.filter((path) => S.changes[path] !== S.priced.changes[path]);
  if (different.length !== 1) return null;
  const [path] = different, slider = S.sliders.get(path), price = S.priced.prices.get(path);
  if (!slider) return null;  // a word has no price
  const si = (slider.value - slider.row.offset) / slider.row.factor;
  if (price && !beyond() && (price.low === null || si >= price.low) && (price.high === null || si <= price.high)) {
    const step = si - price.value, slope = step > 0 ? price.up : price.down, { section, objective } = S.priced.shown;
    if (slope !== null) return {
      objective: objective + slope * step,
      section: price.section && { ...section, numbers: section.numbers.map((one, k) => one + step * price.section[k]) },
    };
  }
  if (beyond()) return null;
  const points = curveOf(path), k = points.findIndex((one) => one.x >= slider.value);
  if (k < 1 || points[k].y === null || points[k - 1].y === null) return null;
  const [from, to] = [points[k - 1], points[k]], share = (slider.value - from.x) / (to.x - from.x);
  return { objective: from.y + share * (to.y - from.y), section: null };
}

// Whether the wish is as far from the last design that fits as a value that is known to have none.
function beyond() {
  const { path } = S.touched, slider = S.sliders.get(path);
  if (!slider) return false;
  const from = S.goodFor[path] ?? slider.file, to = slider.value;
  const gaps = curveOf(path).filter((one) => one.y === null).map((one) => one.x);
  if ((S.searching || !S.shown.feasible) && path in S.lost) gaps.push(S.lost[path]);
  return gaps.some((gap) => gap !== from && (gap - from) * (to - gap) >= 0);
}

// ---- at rest: prices, the card if nothing fits, curves nearest first ----
const UNKNOWN = { points: [], budget: null, none: false };
const REST = { timer: 0, ranked: new Map(), done: false };
// Parts that not every page has, each with some of these: described(design), painted(), and
// rest(changes, stale), which asks for more at rest and returns false if it has to ask again.
const PARTS = [];

function settle() {
  clearTimeout(REST.timer);
  REST.timer = setTimeout(() => rest().catch((fault) => { if (!(fault instanceof Unfit)) throw fault; }), CALM);
}
async function rest() {
  const key = keyOf(S.changes), changes = wishes(S.changes), stale = () => key !== keyOf(S.changes) || LINE.active;
  if (stale() || !S.shown) return;
  if (!S.shown.feasible) {
    announce();
    if (S.shown.card === undefined) {
      const data = await ask("solve", { changes, explain: true });
      if (stale()) return;
      if (data.dropped) settle();
      else truth(data, S.changes);
    }
    return;
  }
  if (!S.shown.whole) {
    const data = await ask("solve", { changes, whole: true });
    if (stale()) return;
    if (data.dropped) { settle(); return; }
    S.shown = data;
    if (data.feasible) S.good = data;
    paint();
    if (!data.feasible) { settle(); return; }
  }
  if (S.shown.searched === false) {
    const data = await ask("solve", { changes, search: true });
    if (stale()) return;
    if (data.dropped) settle();
    else truth(data, S.changes);
    return;
  }
  for (const part of PARTS) if (part.rest && !(await part.rest(changes, stale))) return;
  const standing = { key, changes: S.changes, shown: S.shown };
  const answer = await ask("prices", { changes, paths: [...S.sliders].filter(([, slider]) => !slider.box.hidden).map(([path]) => path), draw: true });
  if (stale()) return;
  if (answer.dropped) { settle(); return; }
  if (answer.infeasible) return;
  S.priced = { ...standing, prices: new Map(answer.prices.map((one) => [one.path, one])) };
  paintPrices();
  announce();
  if (!REST.done && !(await rank(changes, stale))) return;
  const across = byId("across").value, best = bestOf();
  for (const path of new Set([S.focused, best ? "" : across])) if (path && !(await trace(path, changes, stale))) return;
  if (best && best.path !== across) await trace(across, changes, stale, best.path);
}
// The limit whose best value the trade-off shows; undefined if it shows something else.
const bestOf = () => S.design.best.find((row) => row.path === byId("up").value);
// Price all fixed numbers once; those that matter most get sliders.
async function rank(changes, stale) {
  const left = S.design.numbers.filter((row) => !row.asked && !REST.ranked.has(row.path));
  while (left.length) {
    const rows = left.splice(0, 2 * CHUNK), paths = rows.map((row) => row.path), answer = await ask("prices", { changes, paths });
    if (stale()) return false;
    if (answer.dropped || answer.infeasible) { settle(); return false; }
    const found = new Map(answer.prices.map((one) => [one.path, one]));
    for (const row of rows) {
      const price = found.get(row.path);
      REST.ranked.set(row.path, price ? Math.max(Math.abs(price.up ?? Infinity), Math.abs(price.down ?? Infinity)) * row.size / row.factor : 0);
    }
  }
  REST.done = true;
  addFixed(REST.ranked);
  settle();
  return false;
}
// The curve of a number, as points in display units in order; empty if other numbers have changed.
// That of the best value of a limit also depends on the number's own present value.
const keyOfCurve = (path, best) => (best ? keyOf(S.changes) : keyOf(S.changes, path));
function curveAt(path, best = "") {
  const curve = S.curves.get(path + best);
  return curve && curve.key === keyOfCurve(path, best) ? curve : UNKNOWN;
}
const curveOf = (path) => curveAt(path).points;
async function trace(path, changes, stale, best = "") {
  const slider = S.sliders.get(path);
  let curve = curveAt(path, best);
  if (curve === UNKNOWN) S.curves.set(path + best, curve = { key: keyOfCurve(path, best), points: [], budget: null, none: false });
  const enter = (added) => {
    const others = curve.points.filter((one) => added.every((other) => other.x !== one.x));
    curve.points = [...others, ...added].sort((a, b) => a.x - b.x);
    paintPrices();
  };
  const here = slider.value, found = (v) => curve.points.some((one) => one.x === v);
  const si = (v) => (v - slider.row.offset) / slider.row.factor;
  const near = slider.values().sort((a, b) => Math.abs(a - here) - Math.abs(b - here));
  for (;;) {
    const gaps = curve.points.filter((one) => one.y === null).map((one) => one.x);
    const beyond = (v) => gaps.some((gap) => (v < here ? v < gap && gap < here : v > gap && gap > here));
    const left = near.filter((v) => !found(v));
    const values = left.filter((v) => !beyond(v)).slice(0, CHUNK);
    if (!values.length) {
      const edges = curve.points.filter((one) => one.y === null && !one.sought && !beyond(one.x));
      if (edges.length) {
        const [edge] = edges, answer = await ask("curve", { changes, path, best, values: [si(edge.x)], search: true });
        if (stale()) return false;
        if (answer.dropped) { settle(); return false; }
        enter([{ x: edge.x, y: answer.objectives[0], dimensions: answer.dimensions[0], sought: true }]);
        continue;
      }
      enter(left.map((x) => ({ x, y: null, dimensions: {} })));
      return true;
    }
    const answer = await ask("curve", { changes, path, best, values: values.map(si) });
    if (stale()) return false;
    if (answer.dropped) { settle(); return false; }
    if (answer.infeasible) { curve.none = true; paintPrices(); return false; }
    curve.budget = answer.budget ?? null;
    enter(values.map((x, k) => ({ x, y: answer.objectives[k], dimensions: answer.dimensions[k] })));
  }
}

// ---- whole drags can be undone ----
// Steps by keys that follow each other closely count as one.
function commit(path = "", key = false) {
  if (keyOf(S.changes) === keyOf(S.committed)) return;
  const now = performance.now(), merged = key && S.touched.key && S.touched.path === path && now - S.touched.time < MERGE;
  if (!merged) S.past = [...S.past, S.committed].slice(-MOST_UNDO);
  S.committed = S.changes;
  S.future = [];
  S.touched = { path, key, time: now };
  paintButtons();
}
function travel(from, to) {
  if (!from.length) return;
  to.push(S.committed);
  S.changes = S.committed = from.pop();
  S.touched = { path: "", key: false, time: 0 };
  showChanges();
}
function showChanges() {
  for (const [path, slider] of S.sliders) slider.restore(S.changes[path] ?? slider.file);
  note("");
  solve();
  paint();
}
