// Draw the section of a design to scale, in mm; the explorer and the studio share this.
const SVG = "http://www.w3.org/2000/svg";

function shape(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  return made;
}
// The parts of a section, each with its path. `parts` say how many points each polygon has, and on
// which sides of the axis it lies; `numbers` are x and r of all points, perhaps with more after them.
// A part of the kind "line", such as a thread, is not closed.
function pathsOf({ parts, numbers }) {
  let at = 0;
  return parts.map(({ part, kind, polygons, sides = [1, -1] }) => {
    let d = "";
    for (const count of polygons) {
      const corners = [];
      for (let k = 0; k < count; k++, at += 2) corners.push([numbers[at], numbers[at + 1]]);
      for (const side of sides) d += "M" + corners.map(([x, r]) => `${x.toFixed(4)} ${(side * r).toFixed(4)}`).join("L") + (kind === "line" ? "" : "Z");
    }
    return { part, kind, d, under: kind === "oil" && sides.length > 1 };
  });
}
const solids = (section) => pathsOf(section).filter(({ kind }) => kind !== "oil" && kind !== "line").map(({ d }) => d).join("");
// Widen `extent` (left, right, radius) so that it contains the first `count` numbers of a section.
function widen(extent, numbers, count = numbers.length) {
  for (let k = 0; k < count; k += 2) {
    extent.left = Math.min(extent.left, numbers[k]);
    extent.right = Math.max(extent.right, numbers[k]);
    extent.radius = Math.max(extent.radius, numbers[k + 1]);
  }
}
// Draw a section within an extent; another one is dashed under its edges, so that only what differs
// shows. `size` is the width and height of the drawing in pixels.
function drawParts(svg, section, other, { left, right, radius }, [width, height]) {
  const pad = (right - left) * 0.02, wide = right - left + 2 * pad;
  const pixel = Math.max(wide / width, 2 * (radius + pad) / (height - 30)), foot = 28 * pixel;
  svg.setAttribute("viewBox", `${left - pad} ${-radius - pad} ${wide} ${2 * radius + 2 * pad + foot}`);
  const paths = pathsOf(section).sort((a, b) => b.under - a.under).map(({ part, kind, d }) => {
    const path = shape("path", { class: kind, d });
    path.append(shape("title", {}, part.replaceAll("_", " ")));
    return path;
  });
  if (other) paths.push(shape("path", { class: "other", d: solids(other) }), shape("path", { class: "edges", d: solids(section) }));
  const bar = [500, 200, 100, 50, 20, 10, 5, 2, 1].find((length) => length < (right - left) / 4) || 1, y = radius + pad + foot * 0.45;
  svg.replaceChildren(
    ...paths,
    shape("path", { class: "centre", d: `M${left - pad} 0H${right + pad}` }),
    shape("path", { class: "bar", d: `M${left} ${y - foot / 8}V${y + foot / 8}M${left} ${y}H${left + bar}M${left + bar} ${y - foot / 8}V${y + foot / 8}` }),
    shape("text", { x: left + bar + foot / 4, y: y + foot * 0.16, "font-size": 13 * pixel }, `${bar} mm`),
  );
}
