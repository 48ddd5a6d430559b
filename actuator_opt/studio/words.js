// Numbers and words of the page.
const byId = (id) => document.getElementById(id);

function node(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}
// Width and height of a drawing in pixels; asked for once, as an answer waits for the layout.
const SIZES = new Map();
function sizeOf(svg, width, height) {
  if (!SIZES.has(svg) && svg.clientWidth) SIZES.set(svg, [svg.clientWidth, svg.clientHeight]);
  return SIZES.get(svg) ?? [width, height];
}
// A number with at most so many digits; a true minus sign.
function trimmed(value, digits = 4) {
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e6 || size < 1e-4) ? Number(value.toPrecision(digits)).toExponential()
    : String(Number(value.toPrecision(digits > 3 && size >= 1000 ? Math.max(digits, 5) : digits)));
  return text.replace("-", "−");
}
// Thousands apart by a narrow space from five digits on, as in the studio's own texts.
const grouped = (text) => text.replace(/^(−?)(\d{5,})/, (_, sign, whole) => sign + whole.replace(/\B(?=(\d{3})+$)/g, "\u202f"));
const signed = (value, digits) => (value > 0 ? "+" : "") + trimmed(value, digits);
const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);
const shown = (scale, si) => scale.offset + scale.factor * si;
const exact = (value) => Number(value.toPrecision(12));
// The nearest of 1, 2 and 5 times a power of ten.
function roundStep(size) {
  const power = 10 ** Math.floor(Math.log10(size)), share = size / power;
  return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}
// A value on the grid of a step, without the noise of the multiplication.
const onGrid = (value, step) => exact(Math.round(value / step) * step);
