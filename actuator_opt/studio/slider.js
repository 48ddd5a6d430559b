// A number that the page changes: range, field with unit, price in words, track.
// `row` is the number as the studio describes it; values here are in its display unit.
// The range of a whole number reaches so many steps down and up.
const SHARE = 0.25, STEPS = 100, AHEAD = 20, NEIGHBOURS = 3;

class Slider {
  constructor(row, acts) {
    this.row = row;
    this.acts = acts;
    this.value = exact(shown(row, row.value));
    this.file = this.fits = this.value;
    const id = `n${Slider.count++}`;
    this.field = node("input", { type: "text", id, autocomplete: "off", spellcheck: false });
    this.range = node("input", { type: "range", step: "any" });
    this.range.setAttribute("aria-label", `${row.label} ${row.sense}`.trim());
    this.track = shape("svg", { viewBox: "0 0 1000 26", preserveAspectRatio: "none", "aria-hidden": "true" });
    this.price = node("p", { className: "price" });
    this.fault = node("p", { className: "fault", id: `${id}f`, hidden: true });
    this.fault.setAttribute("role", "alert");
    const label = node("label", { htmlFor: id, textContent: row.label }), sense = node("span", { className: "hint", textContent: row.sense });
    sense.setAttribute("aria-hidden", "true");
    this.box = node("div", { className: "wish" }, node("div", { className: "top" }, label, sense, this.field),
      node("div", { className: "track" }, this.track, this.range), this.price, this.fault);
    this.box.dataset.path = row.path;
    this.centre(this.value);
    this.listen();
    this.show(this.value);
  }
  room(value) { return this.row.whole ? NEIGHBOURS : SHARE * (Math.abs(value) || this.row.size); }
  // Let the range reach a quarter of the number's size below and above a value, and the last value that fits.
  centre(value) {
    const { row } = this, room = this.room(value);
    const ends = [Math.min(value - room, this.fits), Math.max(value + room, this.fits)], limits = [row.lower, row.upper].map((si) => (si === null ? null : shown(row, si)));
    this.low = limits[0] === null ? ends[0] : Math.max(ends[0], limits[0]);
    this.high = limits[1] === null ? ends[1] : Math.min(ends[1], limits[1]);
    this.step = row.whole ? 1 : roundStep((this.high - this.low) / STEPS);
    this.range.min = this.low;
    this.range.max = this.high;
  }
  listen() {
    this.range.addEventListener("input", () => {
      this.show(onGrid(this.range.valueAsNumber, this.step));
      this.acts.move(this);
    });
    this.range.addEventListener("change", () => this.acts.commit(this));
    this.range.addEventListener("focus", () => this.acts.focus(this));
    this.range.addEventListener("keydown", (event) => {
      const quarter = this.row.whole ? 1 : (this.high - this.low) / 4;
      const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key] * (event.shiftKey ? 10 : 1) * this.step
        || { PageDown: -1, PageUp: 1 }[event.key] * quarter;
      if (!steps || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.show(onGrid(Math.min(Math.max(this.value + steps, this.low), this.high), this.step));
      this.acts.move(this);
      this.acts.commit(this, true);
    });
    this.field.addEventListener("change", () => this.acts.typed(this, this.field.value.trim()));
    this.field.addEventListener("keydown", (event) => { if (event.key === "Escape") { this.refuse(""); this.show(this.value); } });
  }
  // Show a value of the past; a range that a far wish has widened or moved is as at first.
  restore(value) {
    const room = this.room(value);
    this.refuse("");
    if (this.high - this.low > 4 * room || value - this.low < room / 2 || this.high - value < room / 2) {
      this.fits = value;
      this.centre(value);
    }
    this.show(value);
  }
  show(value) {
    this.value = value;
    if (value < this.low || value > this.high) this.centre(value);
    this.range.value = value;
    if (document.activeElement !== this.field || !this.fault.textContent) this.field.value = this.text(value);
    this.box.classList.toggle("changed", value !== this.file);
    this.speak();
  }
  text(value, digits = 6) { return withUnit(trimmed(value, digits), this.row.unit); }
  // Text with a unit for the studio, which knows all units; a bare number gets the unit shown.
  wish(value = this.value) { return withUnit(String(value), this.row.typed); }
  typedWish(text) {
    const plain = text.replace("−", "-").replace("µ", "u").replace("°C", "degC").replace(/·/g, "*");
    return /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(plain) ? withUnit(plain, this.row.typed) : plain;
  }
  refuse(text) {
    this.fault.textContent = text;
    this.fault.hidden = !text;
    if (text) { this.field.setAttribute("aria-invalid", "true"); this.field.setAttribute("aria-describedby", this.fault.id); }
    else { this.field.removeAttribute("aria-invalid"); this.field.removeAttribute("aria-describedby"); }
  }
  // Whether a part was made from the same things the last time, so that it can stay.
  same(part, ...things) {
    const before = this[part];
    this[part] = things;
    return Boolean(before) && before.every((one, k) => one === things[k]);
  }
  speak() {
    this.range.setAttribute("aria-valuetext", [this.text(this.value), this.price.textContent].filter(Boolean).join(", "));
  }
  values() {
    if (this.row.whole) return Array.from({ length: this.high - this.low + 1 }, (_, k) => this.low + k);
    return Array.from({ length: AHEAD + 1 }, (_, k) => exact(this.low + (this.high - this.low) * k / AHEAD));
  }
  // The price in words; `price` in SI, `edges` where no design was found, `reached` the metric of a limit.
  tell(price, goal, edges, old, reached) {
    const words = [], { row } = this;
    // Small numbers get their price per 0.1, 0.01, … of the unit, about a fifth of the number.
    const size = Math.abs(this.value) || row.size, share = row.whole ? 1 : size < 2 ? exact(10 ** Math.floor(Math.log10(size / 5))) : 1;
    const small = (slope) => Math.abs(slope * row.size / row.factor) < 1e-4 * Math.abs(goal.now), nothing = price && small(price.up) && small(price.down);
    if (this.same("told", price, old, edges.low, edges.high, share, nothing, reached)) return;
    if (price) {
      const per = (slope) => signed(share * slope * goal.factor / row.factor, 3);
      const unit = withUnit(goal.unit || goal.label, `per ${share === 1 && row.unit ? row.unit : share === 1e-3 && row.unit === "mm" ? "µm" : withUnit(String(share), row.unit)}`);
      const strong = node("strong");
      const now = reached === undefined || reached === null ? null : exact(shown(row, reached));
      const slack = now !== null && (row.sense === "≤" ? now < this.value : row.sense === "≥" && now > this.value);
      const inside = (si) => si !== null && (row.lower === null || si > row.lower) && (row.upper === null || si < row.upper);
      const [low, high] = [price.low, price.high].map((si) => (inside(si) ? exact(shown(row, si)) : null)), digits = (v) => trimmed(v, 3);
      if (row.whole) {
        const next = (slope, more) => `${slope === null ? "none found" : per(more ? slope : -slope)} with one ${more ? "more" : "fewer"}`;
        strong.textContent = nothing ? "no effect now" : `${goal.unit || goal.label}: ${next(price.up, true)}, ${next(price.down, false)}`;
      } else if (price.up === null && price.down === null) strong.textContent = "no design if it changes";
      else if (nothing) strong.textContent = slack ? `costs nothing ${row.sense === "≤" ? "above" : "below"} ${this.text(now, 3)}${trimmed(now, 3) === trimmed(now, 4) ? "" : ` (now ${this.text(now, 4)})`}` : row.sense ? "costs nothing" : "no effect now";
      else if (price.up === price.down || Math.abs(price.up - price.down) < 1e-6 * Math.abs(price.up)) strong.textContent = `${per(price.up)} ${unit}`;
      else strong.textContent = `${price.up === null ? "no design" : per(price.up)} more, ${price.down === null ? "no design" : per(price.down)} less, ${unit}`;
      const held = low !== null && high !== null ? `from about ${digits(low)} to ${this.text(high, 3)}` : low !== null ? `from about ${this.text(low, 3)} up` : high !== null ? `up to about ${this.text(high, 3)}` : "";
      const alone = price.up === null && price.down === null;
      words.push(strong, row.whole || nothing || alone ? "" : held ? ` here; the same limits hold ${held}` : " in the whole range");
      this.price.title = row.whole ? "" : [low !== null && `below ${this.text(low, 3)}: ${price.below}`, high !== null && `above ${this.text(high, 3)}: ${price.above}`].filter(Boolean).join("\n");
    } else this.price.title = "";
    if (edges.low !== null) words.push(`${words.length ? "; " : ""}none found at ${this.text(edges.low, 4)} or less`);
    if (edges.high !== null) words.push(`${words.length ? "; " : ""}none found at ${this.text(edges.high, 4)} or more`);
    this.price.replaceChildren(...words);
    this.price.classList.toggle("old", Boolean(old));
    this.box.classList.toggle("old", Boolean(old));
    this.speak();
  }
  // The track: where the price holds, what was solved ahead with its curve, where nothing was found.
  paint(price, points) {
    if (this.same("drawn", price, points, this.low, this.high)) return this.edges;
    const at = (v) => 1000 * (Math.min(Math.max(v, this.low), this.high) - this.low) / (this.high - this.low);
    const band = (kind, from, to) => shape("rect", { class: kind, x: at(from), y: 10, width: Math.max(at(to) - at(from), 0), height: 6 });
    const drawn = [band("empty", this.low, this.high)], found = points.filter((one) => one.y !== null);
    if (found.length) drawn.push(band("solved", found[0].x, found[found.length - 1].x));
    const gaps = points.filter((one) => one.y === null && one.x >= this.low && one.x <= this.high);
    const below = gaps.filter((one) => !found.length || one.x < found[0].x), above = gaps.filter((one) => found.length && one.x > found[found.length - 1].x);
    if (below.length) drawn.push(band("none", this.low, below[below.length - 1].x));
    if (above.length) drawn.push(band("none", above[0].x, this.high));
    if (price) drawn.push(band("exact", price.low === null ? this.low : shown(this.row, price.low), price.high === null ? this.high : shown(this.row, price.high)));
    const ys = found.map((one) => one.y), y0 = Math.min(...ys), y1 = Math.max(...ys);
    if (found.length > 1) drawn.push(shape("polyline", { class: "line", points: found.map((one) => `${at(one.x).toFixed(1)},${(y1 > y0 ? 8 - 8 * (one.y - y0) / (y1 - y0) : 8).toFixed(2)}`).join(" ") }));
    if (this.file > this.low && this.file < this.high) drawn.push(shape("path", { class: "file", d: `M${at(this.file)} 7V19` }));
    this.track.replaceChildren(...drawn);
    this.edges = { low: below.length ? below[below.length - 1].x : null, high: above.length ? above[0].x : null };
    return this.edges;
  }
}
Slider.count = 0;
