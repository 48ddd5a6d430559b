// Two designs side by side: A is pinned, B is the chosen one.
function letter(row) { return row < 0 ? "" : row === STATE.a ? "A" : row === STATE.pinned && STATE.a >= 0 ? "B" : ""; }
function pinA(row) {
  STATE.a = row;
  describe(STATE.pinned); compared(); markRows();
  redraw(true);
  say(row < 0 ? "A let go" : `Design ${row + 1} is A. ${byId("differ").textContent}`);
}
function swap() {
  const row = STATE.a;
  STATE.a = STATE.pinned;
  pin(row);
}
// The difference of two numbers of single precision, with the digits that are known of it.
function difference(a, b) {
  const change = b - a, digits = Math.floor(Math.log10(Math.abs(change) / (Math.max(Math.abs(a), Math.abs(b)) * 2 ** -23)));
  return (change > 0 ? "+" : "") + trimmed(change, Math.min(Math.max(digits, 1), 4));
}
function share(a, b) {
  const percent = 100 * (b - a) / Math.abs(a);
  return Number.isFinite(percent) ? `${percent > 0 ? "+" : ""}${trimmed(percent, 3)} %` : "";
}
function comparison(column) {
  const { values, better, unit, texts, label } = column, a = values[STATE.a], b = values[STATE.pinned];
  const numbers = !texts && Number.isFinite(a) && Number.isFinite(b), good = better && numbers ? better * (b - a) > 0 : null;
  const line = node("tr", {}, node("th", { scope: "row" }, label));
  for (const text of [shown(column, a), shown(column, b), numbers ? difference(a, b) : ""]) line.append(node("td", {}, text));
  line.append(node("td", { class: "text" }, unit), node("td", {}, numbers && unit !== "%" ? share(a, b) : ""),
    node("td", { class: good === null ? "text" : `text ${good ? "good" : "bad"}` }, good === null ? "" : good ? "better" : "worse"));
  return line;
}
function compared() {
  const { a, pinned: b } = STATE, pair = a >= 0 && b >= 0 && a !== b;
  byId("compare").hidden = a < 0;
  byId("pair").hidden = byId("swap").hidden = !pair;
  byId("pin").disabled = b < 0;
  if (a < 0) { byId("differ").textContent = ""; return; }
  const same = (one) => one.values[a] === one.values[b] || (one.values[a] !== one.values[a] && one.values[b] !== one.values[b]);
  const differ = pair ? COLUMNS.filter((one) => !same(one)) : [], equal = COLUMNS.length - differ.length;
  byId("differ").textContent = pair ? `${differ.length} differ, ${equal} ${equal === 1 ? "is" : "are"} equal.` : `A is design ${a + 1}. Choose another design; it becomes B.`;
  byId("compared").replaceChildren(...differ.map(comparison));
  [["a-head", "A", a], ["b-head", "B", b]].forEach(([id, word, row]) => { byId(id).textContent = `${word}: design ${row + 1}`; });
  [["a-verdict", "A", a], ["b-verdict", "B", b]].forEach(([id, word, row]) => {
    const [kind, text] = pair ? verdictOf(row) : ["", ""];
    byId(id).className = kind; byId(id).textContent = text && `${word}: ${text}`;
  });
}
function buildCompare() {
  byId("pin").addEventListener("click", () => pinA(STATE.pinned));
  byId("swap").addEventListener("click", swap);
  byId("let-go").addEventListener("click", () => { pinA(-1); byId(STATE.pinned < 0 ? "scatter" : "pin").focus(); });
}
