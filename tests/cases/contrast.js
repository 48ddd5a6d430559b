// Contrast of every visible text with the ground behind it, WCAG 2.2: [ratio, element, text].
() => {
  const part = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const luminance = ([r, g, b]) => 0.2126 * part(r / 255) + 0.7152 * part(g / 255) + 0.0722 * part(b / 255);
  const rgba = (text) => { const n = text.match(/[\d.]+/g).map(Number); return n.length < 4 ? [...n, 1] : n; };
  const ground = (node) => {
    for (let one = node; one; one = one.parentElement) {
      const colour = rgba(getComputedStyle(one).backgroundColor);
      if (colour[3] === 1) return colour;
      if (colour[3]) throw new Error(`half transparent: ${one.outerHTML.slice(0, 80)}`);
    }
    return [255, 255, 255, 1];
  };
  const found = [];
  for (const node of document.querySelectorAll("body *")) {
    const text = [...node.childNodes].filter((one) => one.nodeType === 3).map((one) => one.data.trim()).join("");
    const left = node.disabled || !node.checkVisibility() || node.closest("script,option,.hidden");
    if (!text || left) continue;
    const style = getComputedStyle(node), ink = node.namespaceURI.endsWith("svg") ? style.fill : style.color;
    const [light, dark] = [rgba(ink), ground(node)].map(luminance).sort((p, q) => q - p);
    found.push([(light + 0.05) / (dark + 0.05), node.tagName, text.slice(0, 40)]);
  }
  return found.sort((p, q) => p[0] - q[0]);
}
