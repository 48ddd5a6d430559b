// The sections of all rows: a template whose points move with the dimensions, in mm.
const SHAPES = DATA.shapes;
const DIMENSIONS = SHAPES.dimensions.map((text) => decoded(text, Float32Array));
const WHICH = decoded(SHAPES.which, Int16Array);
let EXTENT = null;

// The section of a row; its numbers end with the lengths that are printed below it.
function sectionOf(row) {
  const template = SHAPES.templates[WHICH[row]];
  if (!template) return null;
  const numbers = Float64Array.from(template.numbers);
  for (const [number, dimension, slope] of template.slopes) numbers[number] += slope * DIMENSIONS[dimension][row];
  return { parts: template.parts, numbers };
}
// All sections have the same scale, that of the largest, so that they are comparable.
function extent() {
  if (EXTENT) return EXTENT;
  EXTENT = { left: Infinity, right: -Infinity, radius: 0 };
  for (let row = 0; row < N; row++) {
    const section = sectionOf(row);
    if (section) widen(EXTENT, section.numbers, section.numbers.length - SHAPES.lengths.length);
  }
  return EXTENT;
}
function drawSection(row) {
  const svg = byId("section"), section = row < 0 ? null : sectionOf(row);
  if (!section) {
    svg.replaceChildren();
    svg.setAttribute("aria-label", "No section");
    byId("lengths").textContent = row < 0 ? "Click a point of the scatter, or press an arrow key in it." : "No section: the form of its parts is not known here.";
    return;
  }
  const other = STATE.a >= 0 && STATE.a !== row ? sectionOf(STATE.a) : null;
  drawParts(svg, section, other, extent(), [svg.clientWidth || 400, svg.clientHeight || 190]);
  const base = section.numbers.length - SHAPES.lengths.length;
  const told = SHAPES.lengths.map((name, k) => `${name} ${trimmed(section.numbers[base + k])}`).join(" · ") + " mm";
  byId("lengths").textContent = `To scale, retracted: ${told}${SHAPES.hidden ? `. Not shown: ${SHAPES.hidden}` : ""}${other ? ". Dashed where A differs" : ""}`;
  svg.setAttribute("aria-label", `Section to scale, retracted: ${told}${other ? ". Dashed where A differs" : ""}`);
}
