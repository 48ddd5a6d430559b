// Answers of the page without a server: optima, prices and curves, as `model.py` gives them.
const KINDS = { extra: Int32Array, outputs: Int32Array, frozen: Uint8Array, constants: Float64Array };
const PLANES = [2, 2, 3, 3, 3];
const QUEUE = [];
let DATA = null, PROBLEM = null, DRAWN = null, VALLEYS = [], LAST = { key: "", best: null }, BUSY = false;

class Replaced extends Error {}
const CHANNEL = new MessageChannel();
// Let messages in; the work ends if the page wants another optimum meanwhile.
async function breathe() {
  await new Promise((done) => { CHANNEL.port1.onmessage = done; CHANNEL.port2.postMessage(0); });
  if (QUEUE.some((one) => one.route === "solve")) throw new Replaced();
}

// The data: a length, JSON, and the arrays of two programs; compressed.
async function opened(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = await new Response(stream).arrayBuffer(), length = new DataView(bytes).getUint32(0, true);
  const data = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  let at = 4 + length;
  const taken = (count, Kind) => {
    const size = count * Kind.BYTES_PER_ELEMENT, part = new Kind(bytes.slice(at, at + size));
    at += size;
    return part;
  };
  data.programs = data.programs.map((head) => {
    const columns = PLANES.map((count) => {
      const column = new Uint32Array(head.instructions);
      for (let place = 0; place < count; place++) taken(head.instructions, Uint8Array).forEach((byte, k) => { column[k] += byte * 256 ** place; });
      return column;
    });
    const [operations, results] = columns, code = new Uint16Array(5 * head.instructions);
    operations.forEach((operation, k) => {
      code.set([operation, results[k]], 5 * k);
      for (let j = 2; j < 5; j++) code[5 * k + j] = columns[j][k] % 2 ? columns[j][k] >> 1 : results[k - (columns[j][k] >> 1)];
    });
    return Machine.program({ ...head, code, ...Object.fromEntries(Object.keys(KINDS).map((name) => [name, taken(head.sizes[name], KINDS[name])])) });
  });
  return data;
}
async function open(text) {
  DATA = await opened(text);
  PROBLEM = new Problem(DATA.programs[0], DATA.problem);
  DRAWN = DATA.programs[1];
  const rows = (list) => list.map((row) => Float64Array.from(row)), present = Float64Array.from(DATA.present);
  VALLEYS = DATA.valleys.map((one) => {
    const prices = new Float64Array(PROBLEM.rows - 1 + 2 * PROBLEM.size);
    for (const [k, price] of one.prices) prices[k] = price;
    return { ...one, z: Float64Array.from(one.z), hessian: rows(one.hessian), prices, numbers: present };
  });
  DATA.present = present;
  DATA.place = new Map(DATA.paths.map((path, k) => [path, k]));
}

function numbersOf(changes) {
  const numbers = Float64Array.from(DATA.present);
  for (const path in changes) numbers[DATA.place.get(path)] = changes[path];
  return numbers;
}
async function bestOf(changes) {
  const key = JSON.stringify(Object.entries(changes).sort());
  if (LAST.key !== key) {
    const numbers = numbersOf(changes), best = await solved(PROBLEM, VALLEYS, numbers, breathe);
    LAST = { key, best: { ...best, numbers } };
  }
  return LAST.best;
}
const shownValue = (si) => (DATA.design.goal.maximise ? -si : si);

// ---- what the page shows of a point ----
function parts(inputs, seeds) {
  const { values, slopes } = Machine.run(DRAWN, inputs, seeds), all = seeds ? slopes : values, width = seeds ? seeds.length : 1;
  let at = 0;
  const taken = (count) => {
    const part = all.slice(at * width, (at + count) * width);
    at += count;
    return part;
  };
  return { masses: taken(DATA.masses.length), sizes: taken(DATA.section.origin.length), limits: taken(DATA.limits.length), fixed: taken(DATA.fixed.length), lengths: taken(DATA.lengths.length) };
}
// Coordinates of the section, linear in the sizes of the parts: `size` gives each; with `from` null, their changes.
function coordinates(size, from = DATA.section.origin) {
  const { zero, slopes, origin } = DATA.section, numbers = from ? [...zero] : zero.map(() => 0);
  if (!origin.every((_, k) => Number.isFinite(size(k)))) return numbers;
  for (const [row, k, slope] of slopes) numbers[row] += slope * (size(k) - (from ? from[k] : 0));
  return numbers;
}
function held(point, { limits, fixed }) {
  const rows = [], text = (scale, si) => withUnit(grouped(trimmed(shown(scale, si), 4)), scale.unit);
  DATA.limits.forEach((limit, k) => {
    const size = limit.size && limits[k] === 0 ? limit.size : Math.abs(limits[k]) || 1;
    const margins = [...limit.rows.map((row) => point.rows[row]), ...limit.fixed.map((row) => fixed[row])];
    const margin = Math.min(...margins), missed = margin < -MET;
    if (!(limit.rows.length ? margin <= ACTIVE : missed)) return;
    rows.push({ name: limit.name, limit: `${limit.sense === "min" ? "≥" : "≤"} ${text(limit, limits[k])}`, missed,
      value: text(limit, limits[k] + (limit.sense === "min" ? 1 : -1) * size * margin), where: limit.where[margins.indexOf(margin)] });
  });
  rows.sort((a, b) => b.missed - a.missed);
  PROBLEM.free.forEach((k, j) => {
    const side = point.z[j] - PROBLEM.low[j] <= ACTIVE ? "lower" : PROBLEM.high[j] - point.z[j] <= ACTIVE ? "upper" : "", row = DATA.design.dimensions[k];
    if (side) rows.push({ name: row.label, limit: `${side} bound`, value: text(row, point.x[k]), where: "", missed: false });
  });
  return rows;
}
function design(best) {
  const point = best.point || best.least || PROBLEM.at(VALLEYS[0].z, best.numbers), drawn = parts(point.inputs);
  const unmet = drawn.fixed.some((margin, k) => DATA.fixed[k] && margin < -MET), feasible = Boolean(best.point) && !unmet;
  const masses = DATA.masses.map((part, k) => ({ part, mass: drawn.masses[k] })), holds = held(point, drawn);
  return {
    feasible, holds, masses, whole: true,
    sentence: feasible ? "" : sentence(best, holds),
    objective: Number.isFinite(point.objective) ? shownValue(point.objective) : null,
    within: feasible && !best.optimum ? promised(PROBLEM, best.descent) : null,
    section: { parts: DATA.section.parts, numbers: coordinates((k) => drawn.sizes[k]), lengths: `${DATA.lengths.map((words, k) => `${words} ${trimmed(1000 * drawn.lengths[k], 4)}`).join(" · ")} mm` },
    mass: masses.reduce((sum, one) => sum + one.mass, 0),
    dimensions: Object.fromEntries(DATA.design.dimensions.map((row, k) => [row.path, point.x[k]])),
    changed_on_disk: false,
  };
}
function sentence(best, holds) {
  const missed = holds.filter((row) => row.missed).map((row) => `  ${row.name} ${row.value}, asked ${row.limit}`);
  const why = best.known ? "No design was found near the known ones." : "This page cannot calculate such designs: its models were recorded for others.";
  return [why, ...(missed.length ? ["Nearest miss:", ...missed] : []), "This page searches only near the optima that it was made with.",
    "“Command …” gives the command of a full search, which also says what would help."].join("\n");
}

// ---- requests ----
const ROUTES = {
  async solve({ changes, describe, explain }) {
    const data = design(await bestOf(changes));
    return { ...data, changes, ...(describe ? { design: DATA.design } : {}), ...(explain && !data.feasible ? { card: data.sentence } : {}) };
  },
  async prices({ changes, paths, draw }) {
    const best = await bestOf(changes);
    if (!best.optimum) return best.point ? { prices: [] } : { infeasible: true };
    const prices = new Prices(PROBLEM, best.point, best.numbers, DATA.labels), places = paths.map((path) => DATA.place.get(path));
    await prices.prepare(breathe);
    const direct = prices.direct(places), rows = [];
    for (const [k, path] of paths.entries()) {
      await breathe();
      const { value, down, up, low, high, moves } = prices.of(places[k], direct[k]), sign = (x) => (x === null ? null : shownValue(x));
      const [[lowest, below], [highest, above]] = [low || [null, null], high || [null, null]];
      rows.push({ path, value, down: sign(down), up: sign(up), low: lowest, high: highest, below, above, moves });
    }
    const seeds = draw ? rows.map((row, k) => {
      const seed = unit(DRAWN.inputs, PROBLEM.count + places[k]);
      PROBLEM.free.forEach((place, j) => { seed[place] = row.moves[j]; });
      return seed;
    }) : [];
    const moved = seeds.length ? parts(best.point.inputs, seeds).sizes : null;
    return { prices: rows.map(({ moves, ...row }, k) => ({ ...row,
      movement: Object.fromEntries(PROBLEM.free.map((place, j) => [DATA.design.dimensions[place].path, moves[j]])),
      ...(moved ? { section: coordinates((j) => moved[j * seeds.length + k], null) } : {}) })) };
  },
  async curve({ changes, path, values }) {
    const objectives = [], dimensions = [];
    for (const value of values) {
      await breathe();
      const data = design({ ...(await solved(PROBLEM, VALLEYS, numbersOf({ ...changes, [path]: value }), breathe)), numbers: numbersOf({ ...changes, [path]: value }) });
      objectives.push(data.feasible && data.within === null ? data.objective : null);
      dimensions.push(data.feasible ? data.dimensions : {});
    }
    return { values, objectives, dimensions };
  },
};
// One request at a time: the newest optimum asked for comes first, and older ones are dropped.
async function serve() {
  if (BUSY) return;
  BUSY = true;
  while (QUEUE.length) {
    const newest = QUEUE.map((one) => one.route).lastIndexOf("solve"), { id, route, wish } = QUEUE.splice(Math.max(newest, 0), 1)[0];
    for (let k = QUEUE.length - 1; route === "solve" && k >= 0; k--)
      if (QUEUE[k].route === "solve") postMessage({ id: QUEUE.splice(k, 1)[0].id, data: { dropped: true } });
    let data;
    try { data = await ROUTES[route](wish); } catch (fault) { data = fault instanceof Replaced ? { dropped: true } : { fault: String(fault) }; }
    postMessage({ id, data });
  }
  BUSY = false;
}
onmessage = async ({ data: { id, route, wish } }) => {
  if (route !== "open") { QUEUE.push({ id, route, wish }); serve(); return; }
  let data = {};
  try { await open(wish.text); } catch (fault) { data = { fault: String(fault) }; }
  postMessage({ id, data });
};
