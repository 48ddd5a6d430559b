// Requests to the worker of this page, which answers as the studio's server does. No server is needed.
class Unfit extends Error {}

function bar(text) {
  byId("bar").hidden = !text;
  if (byId("bar").textContent !== text) byId("bar").textContent = text;
}
const WAITING = new Map(), KNOWN = { rows: new Map(), units: {}, count: 0 };
const BROKEN = "This page cannot calculate in this browser. Open it in a current Firefox, Chrome, Edge or Safari.";

function started() {
  const address = URL.createObjectURL(new Blob([byId("worker").textContent], { type: "text/javascript" })), worker = new Worker(address);
  worker.onmessage = ({ data: { id, data } }) => { WAITING.get(id)(data); WAITING.delete(id); };
  worker.onerror = (event) => { event.preventDefault(); bar(BROKEN); };
  return worker;
}
const WORKER = (() => { try { return started(); } catch { return null; } })();
function sent(route, wish) {
  if (!WORKER) { bar(BROKEN); throw new Unfit(BROKEN); }
  return new Promise((done) => {
    const id = ++KNOWN.count;
    WAITING.set(id, (data) => {
      if (data.fault) bar(`This page has a fault: ${data.fault}`);
      done(data);
    });
    WORKER.postMessage({ id, route, wish });
  });
}
const OPENED = sent("open", { text: byId("data").textContent.trim() });

// The SI value of a text such as "9.4 kN/mm", as base/units.py reads it.
function parsed(text, row) {
  const match = /^\s*([+-]?(?:\d[\d_]*\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(.*?)\s*$/i.exec(text), units = KNOWN.units[row.dimension];
  if (!match) throw new Unfit(`"${text}" is not a number with a unit; write e.g. "${withUnit("12", row.typed)}"`);
  const number = Number(match[1].replaceAll("_", "")), plain = (name) => name.replace("**", "^").replace("²", "^2").replace("³", "^3").replace(/\s*([*/^]|·|⋅)\s*/g, (_, sign) => (sign === "·" || sign === "⋅" ? "*" : sign));
  if (!Number.isFinite(number)) throw new Unfit(`"${text}" is not a finite number`);
  const name = plain(match[2]);
  if (name in units) return number * units[name][0] + units[name][1];
  if (!name && row.typed === "") return number;
  const choices = Object.keys(units).slice(0, 5).join(", ") || "a bare number";
  const near = Object.keys(units).find((one) => one.toLowerCase() === name.toLowerCase());
  throw new Unfit(name ? `unknown unit "${match[2]}"; ${near ? `did you mean "${near}"?` : `use one of ${choices}`}` : `"${text}": unit missing; write e.g. "${text} ${row.typed}"`);
}
function inSi(changes) {
  const found = {};
  for (const [path, text] of Object.entries(changes)) {
    const row = KNOWN.rows.get(path), value = parsed(text, row), room = 1e-9 * Math.abs(row.value);
    const show = (si) => withUnit(trimmed(shown(row, si), 4), row.unit);
    if (!(value >= row.lower - room && value <= row.upper + room)) throw new Unfit(`This page covers ${show(row.lower)} to ${show(row.upper)}. Beyond, use actuator-opt itself.`);
    if (Math.abs(value - row.value) > 1e-14 * Math.abs(row.value)) found[path] = value;
  }
  return found;
}
async function ask(route, { changes, ...wish }) {
  await OPENED;
  const data = await sent(route, { ...wish, changes: inSi(changes) });
  if (data.fault) throw new Unfit(data.fault);
  if (data.design) {
    KNOWN.units = data.design.units;
    for (const row of data.design.numbers) KNOWN.rows.set(row.path, row);
    byId("left-out").textContent = data.design.left_out;
    byId("left-out").hidden = !data.design.left_out;
  }
  return data;
}
