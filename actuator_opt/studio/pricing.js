// Prices of an optimum: the derivative of its objective by a number, how the dimensions move, and how far both hold
// [Fiacco1983], as in optimisation/prices.py.
const NUMBER_STEP = 1e-5, INSTANT = 1e-7, SINGULAR = 1e-11, PIVOT = 1e-9, MOST_PIVOTS = 200;

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
    const { problem, point, scale, binding, lengths, gradients, multipliers } = this, n = problem.size, columns = [];
    for (const move of problem.units) {
      await breathe();
      const [above, below] = [1, -1].map((sign) => this.lagrangian(added(point.z, sign * HESSIAN_STEP, move), this.numbers));
      columns.push(above.map((x, j) => (x - below[j]) / (2 * HESSIAN_STEP * scale)));
    }
    const system = Array.from({ length: n + binding.length }, () => new Float64Array(n + binding.length));
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) system[i][j] = (columns[i][j] + columns[j][i]) / 2;
    binding.forEach((k, row) => gradients[k].forEach((x, j) => { system[n + row][j] = system[j][n + row] = x / lengths[row]; }));
    this.system = eigen(system);
    const active = this.active.filter((k) => norm(gradients[k]) > 0), lengthOf = (k) => norm(gradients[k]);
    this.polytope = new Polytope(active.map((k) => gradients[k].map((x) => x / lengthOf(k))), active.map((k) => multipliers[k] * lengthOf(k)));
    this.shares = active.map((k) => [k, lengthOf(k)]);
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
    const single = dot(this.weights, direct), sides = this.polytope.unique ? [single, single] : this.sides(direct);
    const [low, high] = this.ends(value, rates, shifts, multipliers);
    return { value, down: sides[0], up: sides[1], low, high, moves: Float64Array.from(moves, (x, j) => x * problem.slope(point.x, j)) };
  }
  // Prices of a decrease and an increase where the multipliers are not unique: the least and the largest [Gauvin1982].
  sides(direct) {
    const costs = this.shares.map(([k, length]) => (k < this.problem.rows - 1 ? -direct[k + 1] / length : 0));
    return [-1, 1].map((sign) => {
      const most = this.polytope.highest(costs.map((x) => sign * x));
      return most === null ? null : direct[0] + sign * most;
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
// All m >= 0 whose combination of columns, each of length 1, is the same as that of `start`.
class Polytope {
  constructor(columns, start) {
    this.columns = columns;
    this.target = combined(columns, start, columns.length ? columns[0].length : 0);
    this.basis = [];
    const order = columns.map((_, k) => k).sort((a, b) => (start[b] > 0) - (start[a] > 0));
    for (const k of order) if (leastSquares([...this.basis, k].map((j) => columns[j]), this.target)) this.basis.push(k);
    this.unique = this.basis.length === columns.length;
  }
  // The largest cost by the simplex method with the rule of Bland, which ends; null if it is unbounded.
  highest(costs) {
    const { columns, target } = this, basis = [...this.basis], size = largest(costs) || 1;
    for (let pivots = 0; ; pivots++) {
      const own = basis.map((k) => columns[k]), at = leastSquares(own, target);
      let entering = -1, direction = null;
      for (let k = 0; k < columns.length && entering < 0; k++) {
        if (basis.includes(k)) continue;
        direction = leastSquares(own, columns[k]);
        if (costs[k] - basis.reduce((sum, j, place) => sum + costs[j] * direction[place], 0) > PIVOT * size) entering = k;
      }
      if (entering < 0 || pivots === MOST_PIVOTS) return basis.reduce((sum, j, place) => sum + costs[j] * Math.max(at[place], 0), 0);
      let leaving = -1, least = Infinity;
      basis.forEach((k, place) => {
        if (direction[place] <= PIVOT) return;
        const ratio = Math.max(at[place], 0) / direction[place];
        if (ratio < least - PIVOT || (ratio <= least + PIVOT && k < basis[leaving])) { least = Math.min(least, ratio); leaving = place; }
      });
      if (leaving < 0) return null;
      basis[leaving] = entering;
    }
  }
}
