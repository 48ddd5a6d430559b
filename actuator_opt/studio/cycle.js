// A duty cycle: traces over time and force over speed with one marker, and where its energy goes.
const FRAME = { left: 50, right: 12, top: 20, bottom: 30 }, SHORTEST = 2, LONGEST = 10;
const C = { data: null, key: "", sample: 0, markers: [], playing: 0 };

// Draw a panel; return the function that puts its marker on a sample. `least` marks a time.
function drawPanel(svg, panel, least) {
  const time = least !== undefined;
  const width = svg.clientWidth || 400, height = svg.clientHeight || 150, [x0, x1] = panel.x, [y0, y1] = panel.y;
  const px = (x) => FRAME.left + (x - x0) / (x1 - x0 || 1) * (width - FRAME.left - FRAME.right);
  const py = (y) => height - FRAME.bottom - (y - y0) / (y1 - y0 || 1) * (height - FRAME.top - FRAME.bottom);
  const inside = (y) => Math.min(Math.max(y, y0), y1), point = (x, y) => `${px(x).toFixed(1)} ${py(inside(y)).toFixed(1)}`;
  const drawn = [shape("text", { x: 2, y: 13, class: "title" }, panel.title)];
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("aria-label", `${panel.title}, over ${panel.label}`);
  for (const v of ticks(y0, y1)) drawn.push(shape("path", { class: v === 0 ? "zero" : "axis", d: `M${FRAME.left} ${py(v)}H${width - FRAME.right}` }), shape("text", { x: FRAME.left - 5, y: py(v) + 4, "text-anchor": "end" }, trimmed(v)));
  for (const v of ticks(x0, x1)) drawn.push(shape("text", { x: px(v), y: height - FRAME.bottom + 14, "text-anchor": "middle" }, trimmed(v)));
  drawn.push(shape("text", { x: width - FRAME.right, y: height - 3, "text-anchor": "end" }, panel.label));
  for (const { low, high, xs } of panel.curves) {
    if (!low.length) continue;
    const rows = xs.map((x, k) => [x, low[k], high[k]]).filter((row) => row.every((v) => v !== null));
    drawn.push(shape("path", { class: "region", d: `M${[...rows.map(([x, y]) => point(x, y)), ...rows.reverse().map(([x, , y]) => point(x, y))].join("L")}Z` }));
  }
  for (const { value, words, limit } of panel.levels) {
    if (value < y0 || value > y1) continue;
    drawn.push(shape("path", { class: limit ? "limit" : "level", d: `M${FRAME.left} ${py(value)}H${width - FRAME.right}` }));
    if (words) drawn.push(shape("text", { x: width - FRAME.right - 2, y: py(value) - 3, "text-anchor": "end" }, words));
  }
  if (time) drawn.push(shape("path", { class: "least", d: `M${px(panel.curves[0].xs[least])} ${FRAME.top}V${height - FRAME.bottom}` }));
  let named = 0;
  for (const { xs, ys, along, words } of panel.curves) {
    let d = "", open = false;
    xs.forEach((x, k) => {
      const seen = ys[k] !== null && x !== null && ys[k] >= y0 - 1e-9 && ys[k] <= y1 + 1e-9;
      if (seen) d += `${open ? "L" : "M"}${point(x, ys[k])}`;
      open = seen;
    });
    const rank = along ? named : "bound";
    drawn.push(shape("path", { class: `trace trace-${rank}`, d }));
    if (words && along && panel.curves.length > 1 && time) drawn.push(shape("text", { x: width - FRAME.right - 90 * named, y: 13, "text-anchor": "end", class: `name-${rank}` }, words));
    if (along) named += 1;
  }
  const taken = [];
  for (const { x, y, words } of panel.points) {
    const left = px(x) > width / 2, cx = px(x), cy = py(inside(y));
    let at = cy + (cy < FRAME.top + 14 ? 14 : -6);
    while (taken.some(([a, b]) => Math.abs(a - cx) < 110 && Math.abs(b - at) < 13)) at += 14;
    taken.push([cx, at]);
    drawn.push(shape("circle", { class: "spot", cx, cy, r: 4 }), shape("text", { x: cx + (left ? -7 : 7), y: at, "text-anchor": left ? "end" : "start" }, words));
  }
  const own = panel.curves.find((curve) => curve.along), dot = shape("circle", { class: "marker", r: 5.5 }), line = shape("path", { class: "marker-line" });
  svg.replaceChildren(...drawn, ...(time ? [line] : []), dot);
  return (k) => {
    const x = own.xs[k], y = own.ys[k];
    dot.setAttribute("visibility", y === null || y === undefined ? "hidden" : "visible");
    if (y !== null && y !== undefined) { dot.setAttribute("cx", px(x)); dot.setAttribute("cy", py(inside(y))); }
    if (time) line.setAttribute("d", `M${px(x)} ${FRAME.top}V${height - FRAME.bottom}`);
  };
}
function paintCycle() {
  const { data } = C;
  if (!data || !byId("duty").open) return;
  const at = (id) => data.strips[Math.min(byId(id).selectedIndex, data.strips.length - 1)];
  C.markers = ["1", "2"].map((k) => drawPanel(byId(`trace-${k}`), at(`shown-${k}`), data.reserve.sample));
  data.planes.slice(0, 2).forEach((panel, k) => C.markers.push(drawPanel(byId(`plane-${k + 1}`), panel)));
  byId("plane-2").toggleAttribute("hidden", data.planes.length < 2);
  byId("plane-note").textContent = data.limit;
  byId("least-text").textContent = `Thin red line: ${data.reserve.text}.`;
  paintEnergy(data);
  place(C.sample);
}
function paintEnergy(data) {
  const sinks = data.energies.filter((one) => one.value <= 0), sources = data.energies.filter((one) => one.value > 0);
  const all = sinks.reduce((sum, one) => sum - one.value, 0) || 1, bar = byId("energy");
  let x = 0;
  bar.replaceChildren(...sinks.map((one, k) => {
    const size = -100 * one.value / all, rect = shape("rect", { class: `part-${k}`, x, y: 0, width: size, height: 10 });
    rect.append(shape("title", {}, `${one.name} ${one.text}`));
    x += size;
    return rect;
  }));
  bar.setAttribute("aria-label", `Energy per cycle: ${data.energies.map((one) => `${one.name} ${one.text}`).join(", ")}`);
  byId("sources").textContent = sources.length ? `Per cycle: ${sources.map((one) => `${one.text} from the ${one.name}`).join(", ")}. Efficiency ${data.efficiency}.` : "The cycle uses no energy.";
  byId("sinks").replaceChildren(...sinks.map((one, k) => node("tr", {}, node("th", { scope: "row" }, node("span", { className: `swatch part-${k}` }), ` ${one.name}`),
    node("td", { className: "number", textContent: one.text }), node("td", { className: "number", textContent: `${trimmed(-100 * one.value / all, 3)} %` }))));
}
// Put the marker on a sample.
function place(sample, quiet) {
  const { data } = C;
  C.sample = Math.min(Math.max(sample, 0), data.time.length - 1);
  for (const move of C.markers) move(C.sample);
  const range = byId("position");
  range.max = data.time.length - 1;
  range.value = C.sample;
  byId("told").textContent = data.told[C.sample];
  if (!quiet) range.setAttribute("aria-valuetext", data.told[C.sample]);
}
function play() {
  if (C.playing) { stopPlaying(); return; }
  const { time } = C.data, span = time[time.length - 1] - time[0], seconds = Math.min(Math.max(C.data.seconds, SHORTEST), LONGEST);
  const began = performance.now() - 1000 * seconds * (time[C.sample] - time[0]) / span;
  byId("play").textContent = "Pause";
  const frame = (now) => {
    if (!C.playing || !C.data) return;
    const at = time[0] + ((now - began) / 1000 / seconds % 1) * span;
    let k = C.data.time.findIndex((t) => t >= at);
    if (k > 0 && at - C.data.time[k - 1] < C.data.time[k] - at) k -= 1;
    place(Math.max(k, 0), true);
    C.playing = requestAnimationFrame(frame);
  };
  C.playing = requestAnimationFrame(frame);
}
function stopPlaying() {
  cancelAnimationFrame(C.playing);
  C.playing = 0;
  byId("play").textContent = "Play";
  if (C.data) place(C.sample);
}
// Nothing of another cycle stays while a run is under way.
function clearCycle() {
  stopPlaying();
  Object.assign(C, { data: null, key: "", markers: [], sample: 0 });
  for (const id of ["trace-1", "trace-2", "plane-1", "plane-2", "energy", "sinks"]) byId(id).replaceChildren();
  for (const id of ["least-text", "plane-note", "sources"]) byId(id).textContent = "";
  for (const id of ["trace-1", "trace-2", "plane-1", "plane-2", "energy"]) byId(id).setAttribute("aria-label", "No cycle yet");
  byId("position").removeAttribute("aria-valuetext");
  byId("told").textContent = "The run is being calculated …";
}
const keyOfRun = () => JSON.stringify([byId("cycle").value, keyOf(S.changes)]);
// Say whether the run is that of an earlier design; while nothing fits, it stays.
function ageCycle() { byId("duty").classList.toggle("old", Boolean(C.data) && C.key !== keyOfRun() && S.shown.feasible); }
// Ask for the chosen cycle of the design that is shown, unless it is here already.
async function fetchCycle(changes, stale) {
  const name = byId("cycle").value, key = keyOfRun();
  if (byId("duty").hidden || !byId("duty").open || C.key === key) return true;
  const data = await ask("cycle", { changes, name });
  if (stale() || name !== byId("cycle").value) return false;
  if (data.dropped || data.infeasible) {
    if (data.infeasible && !C.data) byId("told").textContent = "No run: nothing fits.";
    return true;
  }
  const other = !C.data || C.data.name !== name;
  C.key = key;
  C.data = data;
  if (other) showStrips(data);
  if (other) C.sample = data.reserve.sample;
  ageCycle();
  paintCycle();
  return true;
}
// The traces on offer; first those of the joint, if there is one, else force and speed.
function showStrips(data) {
  stopPlaying();
  const titles = data.strips.map((strip) => strip.title), first = [["Joint torque", "Force"], ["Speed"]];
  ["shown-1", "shown-2"].forEach((id, k) => {
    const chosen = byId(id).value;
    byId(id).replaceChildren(...titles.map((title) => node("option", { value: title, textContent: title })));
    const usual = first[k].map((words) => titles.find((title) => title.startsWith(words))).find(Boolean);
    byId(id).value = titles.includes(chosen) ? chosen : usual ?? titles[0];
  });
}
function offerCycles(names) {
  byId("duty").hidden = !names.length;
  if (byId("cycle").options.length) return;
  clearCycle();
  byId("cycle").replaceChildren(...names.map((name) => node("option", { value: name, textContent: name })));
}
PARTS.push({ described: (design) => offerCycles(design.cycles ?? []), painted: ageCycle, rest: fetchCycle });
byId("cycle").addEventListener("change", () => { clearCycle(); settle(); });
byId("duty").addEventListener("toggle", () => { if (byId("duty").open) { paintCycle(); if (S.shown) settle(); } else stopPlaying(); });
for (const id of ["shown-1", "shown-2"]) byId(id).addEventListener("change", paintCycle);
byId("position").addEventListener("input", () => { if (C.playing) stopPlaying(); if (C.data) place(byId("position").valueAsNumber); });
new ResizeObserver(paintCycle).observe(byId("trace-1"));
byId("play").addEventListener("click", () => { if (C.data) play(); });
byId("least").addEventListener("click", () => { if (C.playing) stopPlaying(); if (C.data) place(C.data.reserve.sample); });
