// Prices of an optimum: the derivative of its objective by a number, how the dimensions move, and how far both hold
// [Fiacco1983], as in optimisation/prices.py.
const NUMBER_STEP = 1e-5, INSTANT = 1e-7, SINGULAR = 1e-11, RANK = 1e-8, FLAT = 1e-7;

class Prices {
  // labels: of all margins, lower and upper bounds
  constructor(problem, point, numbers, labels) {
    Object.assign(this, { problem, point, numbers, labels }, conditions(problem, point));
    const { gradients, multipliers } = this;
    this.weights = Float64Array.from({ length: problem.rows }, (_, k) => (k ? -multipliers[k - 1] : 1));
    const size = this.margins.map((_, k) => multipliers[k] * norm(gradients[k])), least = 1e-10 * Math.max(norm(point.jacobian[0]), 1e-300);
    this.binding = this.labels.map((_, k) => k).filter((k) => size[k] > least);
    this.lengths = this.binding.map((k) => norm(gradients[k]) || 1);
  }
  // Gradient of the Lagrangian at coordinates and numbers.
  lagrangian(z, numbers) {
    const point = this.problem.at(z, numbers, false);
    return combined(point.jacobian, this.weights, this.problem.size).map((x) => (Number.isFinite(x) ? x : 0));
  }
  // Second derivatives, which all prices share; `breathe` is awaited between evaluations.
  async prepare(breathe) {
    const { problem, point, scale, binding, lengths, gradients } = this, n = problem.size, columns = [];
    for (const move of problem.units) {
      await breathe();
      const [above, below] = [1, -1].map((sign) => this.lagrangian(added(point.z, sign * HESSIAN_STEP, move), this.numbers));
      columns.push(above.map((x, j) => (x - below[j]) / (2 * HESSIAN_STEP * scale)));
    }
    const system = Array.from({ length: n + binding.length }, () => new Float64Array(n + binding.length));
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) system[i][j] = (columns[i][j] + columns[j][i]) / 2;
    binding.forEach((k, row) => gradients[k].forEach((x, j) => { system[n + row][j] = system[j][n + row] = x / lengths[row]; }));
    this.system = eigen(system);
    this.several = this.active.length > rankOf(this.active.map((k) => gradients[k]));
  }
  // Derivatives of all rows by the numbers at some places, at fixed dimensions.
  direct(places) {
    const { problem, point } = this, { program, count } = problem;
    const { slopes } = Machine.run(program, point.inputs, places.map((place) => unit(program.inputs, count + place)));
    return places.map((_, t) => Float64Array.from({ length: problem.rows }, (__, k) => slopes[k * places.length + t]));
  }
  // The price of the number at a place, whose derivatives of the rows are `direct`.
  of(place, direct) {
    const { problem, point, scale, binding, lengths, gradients, multipliers } = this, n = problem.size;
    const value = this.numbers[place], step = NUMBER_STEP * (value || 1);
    const [above, below] = [1, -1].map((sign) => this.lagrangian(point.z, this.numbers.map((x, k) => (k === place ? x + sign * step : x))));
    const right = Float64Array.of(...above.map((x, j) => -(x - below[j]) / (2 * step * scale)),
      ...binding.map((k, row) => (k < problem.rows - 1 ? -direct[k + 1] / lengths[row] : 0)));
    const solution = shortest(this.system, right, SINGULAR), moves = solution.slice(0, n), shifts = new Float64Array(this.margins.length);
    binding.forEach((k, row) => { shifts[k] = -solution[n + row] * scale / lengths[row]; });
    const rates = gradients.map((row, k) => (k < problem.rows - 1 ? direct[k + 1] : 0) + dot(row, moves));
    const single = dot(this.weights, direct), sides = this.several ? this.sides(direct) : [single, single];
    const [low, high] = this.ends(value, rates, shifts, multipliers);
    return { value, down: sides[0], up: sides[1], low, high, moves: Float64Array.from(moves, (x, j) => x * problem.slope(point.x, j)) };
  }
  // Prices of a decrease and an increase where the multipliers are not unique [Gauvin1982]: the best first-order step each.
  sides(direct) {
    const { problem, point, active, gradients, scale } = this, slope = point.jacobian[0].map((x) => x / scale);
    const flat = problem.units.map((row) => row.map((x) => FLAT * x));
    return [-1, 1].map((sign) => {
      const margins = Float64Array.from(active, (k) => (k < problem.rows - 1 ? sign * direct[k + 1] : 0)), size = largest(margins) || 1;
      const { step, fits } = quadratic(flat, slope, active.map((k) => gradients[k]), margins.map((x) => x / size));
      return fits ? direct[0] + sign * scale * size * dot(slope, step) : null;
    });
  }
  // The nearest changes of the active limits below and above a value: [value, text], or null up to a change of 100 %.
  ends(value, rates, shifts, multipliers) {
    const reference = Math.abs(value) || 1, nearest = [null, null], binding = new Set(this.binding);
    rates.forEach((own, k) => {
      const held = binding.has(k), level = held ? multipliers[k] : Math.max(this.margins[k], 0), rate = held ? shifts[k] : own;
      if (Math.abs(rate) * reference <= INSTANT * Math.max(level, held ? 0 : 1)) return;
      const side = rate > 0 ? 0 : 1, distance = -level / rate;
      if (!nearest[side] || Math.abs(distance) < Math.abs(nearest[side][0])) nearest[side] = [distance, `${this.labels[k]} ${held ? "stops being active" : "becomes active"}`];
    });
    return nearest.map((end) => (end && Math.abs(end[0]) <= reference ? [value + end[0], end[1]] : null));
  }
}
function rankOf(rows) {
  const basis = [];
  for (const row of rows) {
    const length = norm(row) || 1, rest = row.map((x) => x / length);
    for (let pass = 0; pass < 2; pass++) for (const one of basis) {
      const share = dot(one, rest);
      for (let k = 0; k < rest.length; k++) rest[k] -= share * one[k];
    }
    const left = norm(rest);
    if (left > RANK) basis.push(rest.map((x) => x / left));
  }
  return basis.length;
}
