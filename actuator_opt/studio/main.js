// Paint what is known, and take what is done on the page.
const FIXED = 8;

function objectiveText(si, about) {
  const text = withUnit(trimmed(shown(S.goal, si), 4), S.goal.unit);
  return `${about ? "about " : ""}${S.goal.mass ? "" : `${S.goal.label} `}${text}`;
}
function paint() {
  const { shown: truthNow } = S, searching = S.searching === keyOf(S.changes), current = S.shownFor === keyOf(S.changes);
  const forecast = searching ? null : predicted(), design = truthNow.feasible || !S.good ? truthNow : S.good;
  document.body.classList.toggle("stale", searching || (!truthNow.feasible && current));
  document.body.classList.toggle("about", !searching && !current && !(forecast && forecast.section));
  const objective = forecast ? forecast.objective : design.objective;
  const nothing = current && !truthNow.feasible, near = current && typeof design.within === "number";
  // Beyond a value that reached no design, and after a wish that nothing fits, no mass is shown before it is known.
  const lost = !current && !forecast && (!truthNow.feasible || S.searching || beyond());
  const within = near ? `, within ${withUnit(trimmed(design.within * S.goal.factor, 2), S.goal.unit)}` : "";
  byId("objective").textContent = searching ? "no design found yet, searching …" : nothing ? "nothing fits" : objective === null ? "no objective" : lost ? "updating …" : `${objectiveText(objective, forecast || near)}${within}${current || forecast ? "" : ", updating …"}`;
  byId("objective").className = current && !near ? "" : "about";
  const pinned = S.A && S.A.shown;
  byId("against").textContent = pinned && !nothing && objective !== null && (current || forecast) ? `A ${objectiveText(pinned.objective)}, ${signed((objective - pinned.objective) * S.goal.factor, 3)}` : "";
  drawSection(forecast && forecast.section ? forecast.section : design.section, pinned && pinned.section);
  if ((searching || nothing) && S.good) byId("lengths").textContent = `The last design that fits is shown in grey: ${lastGood()}.`;
  else if (nothing) byId("lengths").textContent = "Nothing fits: the nearest miss is shown in grey.";
  byId("nothing").hidden = !nothing;
  if (design.advice) byId("advice").textContent = nothing || !design.advice.length ? "" : `advice not followed: ${design.advice.join(", ")}`;
  byId("card").textContent = nothing ? truthNow.card ?? `${truthNow.sentence}\nLooking for what would help …` : "";
  byId("disk").hidden = !truthNow.changed_on_disk;
  byId("disk").textContent = truthNow.changed_on_disk ? `${S.design.file} has changed on disk since it was opened. The studio goes on with what it read, and will not overwrite the file.` : "";
  if (current) { paintMasses(design, pinned); paintDimensions(design, pinned); paintHolds(truthNow); }
  paintPrices();
  paintButtons();
  for (const part of PARTS) part.painted?.();
}
// The last design that fits, and the wishes of it that differ from the present ones.
function lastGood() {
  const differ = [...new Set([...Object.keys(S.changes), ...Object.keys(S.goodFor)])].filter((path) => S.changes[path] !== S.goodFor[path]);
  const words = differ.slice(0, 2).map((path) => {
    const slider = S.sliders.get(path);
    return slider ? `${slider.row.label} ${slider.text(S.goodFor[path] ?? slider.file, 4)}` : String(S.goodFor[path] ?? control(path).file);
  });
  return `${objectiveText(S.good.objective)}${words.length ? `, at ${words.join(" and ")}` : ""}`;
}
const EXTENT = { left: Infinity, right: -Infinity, radius: 0 };
function drawSection(section, pinned) {
  const svg = byId("section");
  for (const one of [section, pinned]) if (one) widen(EXTENT, one.numbers);
  drawParts(svg, section, pinned, EXTENT, sizeOf(svg, 400, 190));
  byId("lengths").textContent = section.lengths;
  svg.setAttribute("aria-label", `Section to scale, retracted: ${section.lengths}${pinned ? "; A dashed where it differs" : ""}`);
}
function paintTable(id, rows) {
  const most = Math.max(...rows.flatMap((row) => [row.share, row.before ?? 0]), 1e-12);
  byId(id).replaceChildren(...rows.map((row) => {
    const bar = shape("svg", { viewBox: "0 0 100 10", preserveAspectRatio: "none", "aria-hidden": "true" });
    bar.append(shape("rect", { class: "now", x: 0, y: 1, width: 100 * Math.max(row.share, 0) / most, height: 8 }));
    if (row.before !== undefined) bar.append(shape("path", { class: "was", d: `M${100 * row.before / most} 0V10` }));
    return node("tr", {}, node("th", { scope: "row", textContent: row.name }), node("td", { className: "bar-cell" }, bar),
      node("td", { className: "number", textContent: row.now }), node("td", { className: "number a", textContent: row.was ?? "" }), node("td", { className: "number a", textContent: row.difference ?? "" }));
  }));
}
function compared(scale, now, was, digits = 4) {
  const text = (si) => withUnit(trimmed(shown(scale, si), digits), scale.unit), step = was === undefined ? 0 : (now - was) * scale.factor;
  return { now: text(now), ...(was === undefined ? {} : { was: text(was), difference: Math.abs(step) < 1e-6 * Math.abs(shown(scale, now)) ? "–" : signed(step, 3) }) };
}
function paintMasses(design, pinned) {
  const scale = { offset: 0, factor: 1000, unit: "g" }, before = new Map(pinned ? pinned.masses.map((one) => [one.part, one.mass]) : []);
  const gone = pinned ? pinned.masses.filter((one) => !design.masses.some((other) => other.part === one.part)).map((one) => ({ part: one.part, mass: 0 })) : [];
  const rows = [...design.masses, ...gone].map(({ part, mass }) => {
    const was = pinned ? before.get(part) ?? 0 : undefined;
    return { name: part, share: mass, before: was, ...compared(scale, mass, was) };
  });
  rows.sort((a, b) => b.share - a.share);
  paintTable("masses", rows);
  byId("masses").append(node("tr", {}, node("th", { scope: "row" }, node("strong", { textContent: "all" })), node("td", { className: "bar-cell" }),
    ...Object.entries(compared(scale, design.mass, pinned ? pinned.mass : undefined)).map(([key, text]) => node("td", { className: key === "now" ? "number" : "number a", textContent: text }))));
}
function paintDimensions(design, pinned) {
  paintTable("dimensions", S.design.dimensions.filter((row) => row.path in design.dimensions).map((row) => {
    const now = design.dimensions[row.path], was = pinned ? pinned.dimensions[row.path] : undefined;
    const share = (si) => Math.min(Math.max((si - row.low) / (row.high - row.low), 0), 1);
    return { name: row.label, share: share(now), before: was === undefined ? undefined : share(was), ...compared(row, now, was) };
  }));
}
function paintHolds(design) {
  byId("holds-title").textContent = design.feasible ? "What holds it" : "What is missed, and what holds it";
  byId("holds").replaceChildren(...design.holds.map((row) => node("tr", { className: row.missed ? "missed" : "" },
    node("td", { textContent: row.missed ? `${row.name}: ${row.value}, missed` : row.name }), node("td", { textContent: row.limit }), node("td", { textContent: row.where }))));
}
function paintPrices() {
  if (!S.goal) return;
  const goal = { ...S.goal, now: S.good ? S.good.objective : 1 };
  for (const [path, slider] of S.sliders) {
    const priced = S.priced && S.priced.prices.get(path), fits = priced && keyOf(S.priced.changes, path) === keyOf(S.changes, path);
    // A price of another design is not the price of a wish that nothing fits.
    const lost = S.searching === keyOf(S.changes) || !S.shown.feasible, old = Boolean(priced && !lost && S.priced.key !== keyOf(S.changes));
    const curve = curveOf(path), kept = !curve.length && old ? S.curves.get(path)?.points ?? curve : curve;
    const edges = slider.paint(fits || old ? priced : null, kept);
    slider.track.classList.toggle("old", old && !fits);
    slider.tell(lost ? null : priced, goal, edges, old, priced && S.priced.shown.reached?.[path]);
  }
  paintTrade();
}
function paintTrade() {
  const slider = S.sliders.get(byId("across").value), up = byId("up").value;
  if (!slider || !S.good) return;
  const best = bestOf(), dimension = S.design.dimensions.find((row) => row.path === up), scale = best || dimension || S.goal;
  const curve = curveAt(slider.row.path, best ? up : ""), y = (si) => (si === null || si === undefined ? null : shown(scale, si));
  const pick = (design) => y(best ? design.reached && design.reached[up] : dimension ? design.dimensions[up] : design.objective);
  const points = curve.points.map((one) => ({ x: one.x, y: y(one.y === null || !dimension ? one.y : one.dimensions[up]) }));
  const kept = best && curve.budget !== null ? ` at ${withUnit(trimmed(shown(S.goal, curve.budget), 4), S.goal.unit)}` : "";
  const marks = [], name = best ? best.label + kept : dimension ? dimension.label : S.goal.label;
  const mark = (x, design, kind, name) => { if (pick(design) !== null) marks.push({ x, y: pick(design), kind, name }); };
  if (S.A) mark(S.A.changes[slider.row.path] ?? slider.file, S.A.shown, "was", "A");
  if (S.shown.feasible && S.shownFor === keyOf(S.changes)) mark(slider.value, S.shown, "now", "now");
  const why = !best ? "" : up === slider.row.path ? "Choose two different limits." : curve.none ? "No design was found." : "";
  drawTrade(points, marks, withUnit(slider.row.label, slider.row.unit && `[${slider.row.unit}]`), withUnit(name, scale.unit && `[${scale.unit}]`), why);
  const found = points.filter((one) => one.y !== null), text = (one) => `${withUnit(trimmed(one.y), scale.unit)} at ${slider.text(one.x, 4)}`;
  const told = why || (found.length > 1 ? `${name}${best ? (S.goal.maximise ? " or more" : " or less") : ""}: ${text(found[0])}, ${text(found[found.length - 1])}. Every point is an optimum.` : "");
  byId("trade-text").textContent = told;
  byId("trade").setAttribute("aria-label", told || "No curve yet");
}
function paintButtons() {
  const current = S.shownFor === keyOf(S.changes), fits = S.shown && S.shown.feasible && current;
  byId("undo").disabled = !S.past.length;
  byId("redo").disabled = !S.future.length;
  byId("pin").disabled = !S.A && !fits;
  byId("pin").textContent = S.A ? "Unpin A" : "Pin A";
  byId("pin").setAttribute("aria-pressed", String(Boolean(S.A)));
  byId("swap").disabled = !S.A || !fits;
  FILES.enable(fits);
  document.body.classList.toggle("pinned", Boolean(S.A));
}
function announce() {
  const names = S.shown.holds.slice(0, 3).map((row) => row.name);
  byId("live").textContent = S.shown.feasible ? `${objectiveText(S.shown.objective)}, held by ${names.join(", ")}` : "Nothing fits.";
}
function note(text) {
  byId("note-text").textContent = text;
  byId("note").hidden = !text;
}

// ---- acts ----
const ACTS = {
  move(slider) {
    change(slider.row.path, slider.value);
    slider.refuse("");
    if (S.touched.path !== slider.row.path) S.touched = { path: slider.row.path, key: false, time: 0 };
    solve();
    paint();
  },
  commit(slider, key) { commit(slider.row.path, key); },
  focus(slider) {
    if (S.focused === slider.row.path) return;
    S.focused = slider.row.path;
    if (S.shown && !LINE.active) settle();
  },
  async typed(slider, text) {
    const { path } = slider.row;
    byId("main").setAttribute("aria-busy", "true");
    try {
      const data = await ask("solve", { changes: { ...wishes(S.changes), [path]: slider.typedWish(text) } });
      slider.refuse("");
      if (data.dropped) return;  // a slider was moved meanwhile
      change(path, path in data.changes ? exact(shown(slider.row, data.changes[path])) : slider.file);
      S.touched = { path, key: false, time: 0 };
      commit(path);
      slider.show(S.changes[path] ?? slider.file);
      LINE.latest++;
      truth(data, S.changes);
    } catch (fault) {
      if (!(fault instanceof Unfit)) throw fault;
      slider.refuse(fault.message);
      if (!LINE.active) byId("main").setAttribute("aria-busy", "false");
    }
  },
};
function pin() {
  if (!S.A && byId("pin").disabled) return;
  S.A = S.A ? null : { changes: S.changes, shown: S.shown };
  paint();
}
function swap() {
  if (byId("swap").disabled) return;
  const now = { changes: S.changes, shown: S.shown };
  S.changes = S.A.changes;
  S.A = now;
  commit();
  showChanges();
}
const undo = () => { if (!byId("undo").disabled) { travel(S.past, S.future); paintButtons(); } };
const redo = () => { if (!byId("redo").disabled) { travel(S.future, S.past); paintButtons(); } };

// ---- keys ----
addEventListener("keydown", (event) => {
  const typing = event.target.matches("input[type=text]");
  if (document.querySelector("dialog[open]")) {
    FILES.typed(event);
    return;
  }
  const letter = event.key.toLowerCase();
  if ((event.ctrlKey || event.metaKey) && !typing && (letter === "z" || letter === "y")) {
    event.preventDefault();
    (letter === "y" || event.shiftKey ? redo : undo)();
  } else if (!event.ctrlKey && !event.metaKey && !event.altKey && !typing && !event.target.matches("select")) {
    const act = { p: pin, x: swap, ...FILES.keys, "?": () => byId("help-dialog").showModal() }[letter];
    if (act) { event.preventDefault(); act(); }
  }
});
for (const [id, act] of Object.entries({ undo, redo, pin, swap, ...FILES.acts })) byId(id).addEventListener("click", act);
byId("note-close").addEventListener("click", () => note(""));
byId("skip").addEventListener("click", () => document.querySelector("#asked input[type=range]")?.focus());
byId("help").addEventListener("click", () => byId("help-dialog").showModal());
byId("help-close").addEventListener("click", () => byId("help-dialog").close());
byId("across").addEventListener("change", () => { paintTrade(); settle(); });
byId("up").addEventListener("change", () => { paintTrade(); settle(); });
const SIZED = new ResizeObserver(() => { SIZES.clear(); if (S.shown) paint(); });
for (const id of ["section", "trade"]) SIZED.observe(byId(id));

// ---- start ----
function add(box, row) {
  if (!S.sliders.has(row.path)) {
    S.sliders.set(row.path, new Slider(row, ACTS));
    byId("across").append(node("option", { value: row.path, textContent: row.label }));
  }
  const slider = S.sliders.get(row.path);
  slider.box.hidden = false;
  byId(box).append(slider.box);
}
function addFixed(ranked) {
  const dearest = S.design.numbers.filter((row) => ranked.get(row.path) > 0).sort((a, b) => ranked.get(b.path) - ranked.get(a.path)).slice(0, FIXED);
  const changed = S.design.numbers.filter((row) => !row.asked && row.path in S.changes && S.sliders.has(row.path) && !dearest.includes(row));
  for (const slider of S.sliders.values()) if (!slider.row.asked) slider.box.hidden = true;
  byId("fixed").replaceChildren();
  for (const row of [...dearest, ...changed]) add("fixed", row);
  if (!dearest.length) byId("fixed").append(node("p", { className: "hint", textContent: "No fixed number changes the optimum." }));
}
// Names and numbers of the design with the present words.
function describe(design) {
  const up = byId("up").value, listed = (one) => one.numbers.map((row) => row.path).join();
  if (listed(S.design) !== listed(design)) { REST.done = false; REST.ranked.clear(); }
  S.design = design;
  S.goal = design.goal;
  const group = (label, rows) => node("optgroup", { label }, ...rows.map((row) => node("option", { value: row.path, textContent: row.label })));
  byId("up").replaceChildren(node("option", { value: "", textContent: S.goal.label }), ...(design.best.length ? [group(`with the same ${S.goal.label}`, design.best)] : []), group("dimensions", design.dimensions));
  byId("up").value = [...design.best, ...design.dimensions].some((row) => row.path === up) ? up : "";
  for (const part of PARTS) part.described?.(design);
}
async function start() {
  const hatching = shape("svg", { class: "hidden", "aria-hidden": "true", width: 0, height: 0 });
  const pattern = shape("pattern", { id: "hatch", width: 5, height: 5, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" });
  pattern.append(shape("rect", { class: "hatched", width: 5, height: 5 }), shape("path", { class: "hatching", d: "M0 0V5" }));
  hatching.append(pattern);
  document.body.append(hatching);
  const data = await ask("solve", { changes: {}, describe: true });
  if (data.dropped) { setTimeout(start, CALM); return; }
  S.design = data.design;
  document.title = `${S.design.name}: studio`;
  byId("name").textContent = S.design.name;
  FILES.open(S.design);
  const limit = (row) => row.path.startsWith("requirements.");
  for (const row of S.design.numbers) if (row.asked && limit(row)) add("asked", row);
  for (const row of S.design.numbers) if (row.asked && !limit(row)) add("asked", row);
  S.describedFor = wordsOf({});
  truth(data, {});
}
start().catch((fault) => { if (!(fault instanceof Unfit)) throw fault; });
