// Draw the section of a design: a template whose points move with the dimensions, in mm.
const SHAPES = DATA.shapes;
const DIMENSIONS = SHAPES.dimensions.map((text) => decoded(text, Float32Array));
const WHICH = decoded(SHAPES.which, Int16Array);
const SVG = "http://www.w3.org/2000/svg";
let EXTENT = null;

function numbersOf(row) {
  const template = SHAPES.templates[WHICH[row]];
  if (!template) return null;
  const found = Float64Array.from(template.numbers);
  for (const [number, dimension, slope] of template.slopes) found[number] += slope * DIMENSIONS[dimension][row];
  return { template, found };
}
// All sections have the same scale, that of the largest, so that they are comparable.
function extent() {
  if (EXTENT) return EXTENT;
  let left = Infinity, right = -Infinity, radius = 0;
  for (let row = 0; row < N; row++) {
    const drawn = numbersOf(row);
    if (!drawn) continue;
    for (let k = 0; k < drawn.found.length - SHAPES.lengths.length; k += 2) {
      left = Math.min(left, drawn.found[k]); right = Math.max(right, drawn.found[k]);
      radius = Math.max(radius, drawn.found[k + 1]);
    }
  }
  EXTENT = { left, right, radius };
  return EXTENT;
}
function element(name, attributes, text) {
  const node = document.createElementNS(SVG, name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  return node;
}
// The parts of a section, each with its path.
function partsOf({ template, found }) {
  let at = 0;
  return template.parts.map(({ part, kind, polygons, sides = [1, -1] }) => {
    let d = "";
    for (const points of polygons) {
      const shape = [];
      for (let k = 0; k < points; k++, at += 2) shape.push([found[at], found[at + 1]]);
      for (const side of sides) d += "M" + shape.map(([x, r]) => `${x.toFixed(4)} ${(side * r).toFixed(4)}`).join("L") + "Z";
    }
    return { part, kind, d };
  });
}
// The outline of all solid parts: A is dashed under the edges of the other, so that only what differs shows.
function solids(drawn) { return partsOf(drawn).filter(({ kind }) => kind !== "oil").map(({ d }) => d).join(""); }
function drawSection(row) {
  const svg = byId("section");
  svg.replaceChildren();
  byId("lengths").textContent = "";
  const drawn = row < 0 ? null : numbersOf(row);
  if (!drawn) {
    svg.setAttribute("aria-label", "No section");
    byId("lengths").textContent = row < 0 ? "Click a point of the scatter, or press an arrow key in it." : "No section: the form of its parts is not known here.";
    return;
  }
  const { left, right, radius } = extent(), { template, found } = drawn;
  const pad = (right - left) * 0.02, wide = right - left + 2 * pad;
  const pixel = Math.max(wide / (svg.clientWidth || 400), 2 * (radius + pad) / ((svg.clientHeight || 190) - 30)), foot = 28 * pixel;
  svg.setAttribute("viewBox", `${left - pad} ${-radius - pad} ${wide} ${2 * radius + 2 * pad + foot}`);
  const paths = partsOf(drawn).map(({ part, kind, d }) => {
    const path = element("path", { class: kind, d });
    path.append(element("title", {}, part));
    return path;
  });
  const first = paths.filter((p, k) => p.classList.contains("oil") && !template.parts[k].sides);
  svg.append(...first, ...paths.filter((p) => !first.includes(p)));
  const other = STATE.a >= 0 && STATE.a !== row ? numbersOf(STATE.a) : null;
  if (other) svg.append(element("path", { class: "other", d: solids(other) }), element("path", { class: "edges", d: solids(drawn) }));
  svg.append(element("path", { class: "centre", d: `M${left - pad} 0H${right + pad}` }));
  const bar = [500, 200, 100, 50, 20, 10, 5, 2, 1].find((length) => length < (right - left) / 4) || 1, y = radius + pad + foot * 0.45;
  svg.append(element("path", { class: "bar", d: `M${left} ${y - foot / 8}V${y + foot / 8}M${left} ${y}H${left + bar}M${left + bar} ${y - foot / 8}V${y + foot / 8}` }));
  svg.append(element("text", { x: left + bar + foot / 4, y: y + foot * 0.16, "font-size": 13 * pixel }, `${bar} mm`));
  const base = found.length - SHAPES.lengths.length;
  const told = SHAPES.lengths.map((name, k) => `${name} ${trimmed(found[base + k])}`).join(" · ") + " mm";
  byId("lengths").textContent = `To scale, retracted: ${told}${SHAPES.hidden ? `. Not shown: ${SHAPES.hidden}` : ""}${other ? ". Dashed where A differs" : ""}`;
  svg.setAttribute("aria-label", `Section to scale, retracted: ${told}${other ? ". Dashed where A differs" : ""}`);
}
