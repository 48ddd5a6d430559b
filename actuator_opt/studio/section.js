// Draw the section in mm: parts as polygons, those of A as an outline.
const EXTENT = { left: Infinity, right: -Infinity, radius: 0 };

function widen(numbers) {
  for (let k = 0; k < numbers.length; k += 2) {
    EXTENT.left = Math.min(EXTENT.left, numbers[k]);
    EXTENT.right = Math.max(EXTENT.right, numbers[k]);
    EXTENT.radius = Math.max(EXTENT.radius, numbers[k + 1]);
  }
}
function pathsOf(parts, numbers) {
  let at = 0;
  return parts.map(({ points, sides, kind }) => {
    let d = "";
    for (const count of points) {
      const corners = [];
      for (let k = 0; k < count; k++, at += 2) corners.push([numbers[at], numbers[at + 1]]);
      for (const side of sides) d += "M" + corners.map(([x, r]) => `${x.toFixed(4)} ${(side * r).toFixed(4)}`).join("L") + (kind === "line" ? "" : "Z");
    }
    return d;
  });
}
function drawSection(section, pinned) {
  const svg = byId("section");
  widen(section.numbers);
  if (pinned) widen(pinned.numbers);
  const { left, right, radius } = EXTENT, pad = (right - left) * 0.02;
  const width = right - left + 2 * pad, [across, high] = sizeOf(svg, 400, 190);
  const pixel = Math.max(width / across, 2 * (radius + pad) / (high - 26)), foot = 26 * pixel;
  svg.setAttribute("viewBox", `${left - pad} ${-radius - pad} ${width} ${2 * (radius + pad) + foot}`);
  const paths = pathsOf(section.parts, section.numbers).map((d, k) => {
    const path = shape("path", { class: section.parts[k].kind, d });
    path.append(shape("title", {}, section.parts[k].part));
    return path;
  });
  if (pinned) paths.push(shape("path", { class: "pinned", d: pathsOf(pinned.parts, pinned.numbers).filter((_, k) => !["oil", "line"].includes(pinned.parts[k].kind)).join("") }));
  const length = [500, 200, 100, 50, 20, 10, 5, 2, 1].find((one) => one < (right - left) / 4) || 1, y = radius + pad + foot * 0.5;
  svg.replaceChildren(
    ...paths,
    shape("path", { class: "centre", d: `M${left - pad} 0H${right + pad}` }),
    shape("path", { class: "scale", d: `M${left} ${y - foot / 8}v${foot / 4}M${left} ${y}h${length}m0 ${-foot / 8}v${foot / 4}` }),
    shape("text", { x: left + length + foot / 4, y: y + foot * 0.16, "font-size": 12.5 * pixel }, `${length} mm`),
  );
  byId("lengths").textContent = section.lengths;
  svg.setAttribute("aria-label", `Section to scale, retracted: ${section.lengths}${pinned ? "; A as outline" : ""}`);
}
