// Re-solve the optimum of a recorded design: the steps of optimisation/resolve, with the same limits.
const ACTIVE = 1e-6, MET = 1e-6, FEASIBLE = 1e-11, RESIDUAL = 1e-6, SETTLED = 1e-6;
const ITERATIONS = 10, LONGEST = 60, RESTORATIONS = 24, PATIENT = 4, MEMORY = 3;
const LONGEST_STEP = 0.5, FIRST_RADIUS = 0.1, LEAST_RADIUS = 1e-4, LEAST_CURVATURE = 1e-10, NEAR = 10 * LEAST_RADIUS;
const ON_BOUND = 1e-12, HESSIAN_STEP = 1e-5, BETTER = 1e-8, BEYOND = 1;
const SHARES = [1 / 4, 1 / 32];  // first and least step towards the changed numbers, as a share of the change
const clipped = (z, low, high) => z.map((x, k) => Math.min(Math.max(x, low[k]), high[k]));

// The problem: the recorded program, whose first inputs are the dimensions; the others are `numbers`.
class Problem {
  // data: lower, upper (dimensions), rows (objective and margins), answers (of the guards that follow)
  constructor(program, data) {
    Object.assign(this, { program, ...data });
    this.count = data.lower.length;
    this.free = data.lower.map((_, k) => k).filter((k) => data.upper[k] > data.lower[k]);
    this.logarithmic = this.free.map((k) => data.lower[k] > 0);
    this.scale = this.free.map((k, j) => (this.logarithmic[j] ? 1 : (data.upper[k] - data.lower[k]) / 2));
    const coordinates = (x) => Float64Array.from(this.free, (k, j) => (this.logarithmic[j] ? Math.log(x[k]) : x[k] / this.scale[j]));
    this.low = coordinates(data.lower);
    this.high = coordinates(data.upper);
    this.size = this.free.length;
    this.units = Array.from({ length: this.size }, (_, k) => unit(this.size, k));
    this.opposite = this.units.map((row) => row.map((x) => -x));
  }
  dimensions(z, inside = true) {
    const x = Float64Array.from(this.lower);
    this.free.forEach((k, j) => {
      const value = this.logarithmic[j] ? Math.exp(z[j]) : z[j] * this.scale[j], room = ON_BOUND * (this.high[j] - this.low[j]);
      if (!inside) x[k] = value;
      else if (z[j] <= this.low[j] + room) x[k] = this.lower[k];
      else if (z[j] >= this.high[j] - room) x[k] = this.upper[k];
      else x[k] = Math.min(Math.max(value, this.lower[k]), this.upper[k]);
    });
    return x;
  }
  slope(x, j) { return this.logarithmic[j] ? x[this.free[j]] : this.scale[j]; }
  // Change of all inputs along every coordinate at x.
  seeds(x) { return this.free.map((k, j) => unit(this.program.inputs, k, this.slope(x, j))); }
  // A point at coordinates z, with the gradients of all rows in coordinates.
  at(z, numbers, inside = true) {
    const x = this.dimensions(z, inside), n = this.size, inputs = new Float64Array(this.program.inputs);
    inputs.set(x);
    inputs.set(numbers, this.count);
    const { values, slopes } = Machine.run(this.program, inputs, this.seeds(x));
    const jacobian = Array.from({ length: this.rows }, (_, k) => slopes.subarray(k * n, k * n + n)), rows = values.subarray(0, this.rows);
    const known = this.answers.every((answer, k) => (values[this.rows + k] !== 0) === Boolean(answer));
    const finite = known && rows.every(Number.isFinite) && jacobian.every((row) => row.every(Number.isFinite));
    let violation = 0;
    for (let k = 1; k < this.rows; k++) violation = Math.max(violation, -rows[k]);
    return { z, x, inputs, rows, jacobian, known, valid: finite, violation: finite ? violation : Infinity, objective: rows[0] };
  }
  // Margins and gradients of all limits, lower and upper bounds.
  limits(point) {
    const margins = Float64Array.of(...point.rows.subarray(1), ...point.z.map((x, k) => x - this.low[k]), ...point.z.map((x, k) => this.high[k] - x));
    return { margins, gradients: [...point.jacobian.slice(1), ...this.units, ...this.opposite] };
  }
}

// How well a point meets the optimality conditions: multipliers of all limits, and the relative residual.
function conditions(problem, point) {
  const { margins, gradients } = problem.limits(point), multipliers = new Float64Array(margins.length), active = [];
  margins.forEach((margin, k) => { if (margin <= ACTIVE) active.push(k); });
  const found = nonNegative(active.map((k) => gradients[k]), point.jacobian[0]);
  active.forEach((k, j) => { multipliers[k] = found[j]; });
  const left = added(point.jacobian[0], -1, combined(gradients, multipliers, problem.size));
  const scale = Math.max(norm(point.jacobian[0]), 1e-3 * Math.abs(point.objective), 1e-300);
  return { margins, gradients, multipliers, active, scale, residual: norm(left) / scale };
}
const isOptimum = (problem, point) => point.violation <= FEASIBLE && conditions(problem, point).residual <= RESIDUAL;

// A descent: the last accepted point and the trial step from it. A valley is an optimum with the Hessian of its Lagrangian.
class Descent {
  constructor(problem, valley, trusted) {
    Object.assign(this, { problem, hessian: valley.hessian, scale: valley.scale, prices: valley.prices });
    this.price = trusted ? valley.price : 1;
    this.radius = trusted ? FIRST_RADIUS : LONGEST_STEP;
    this.point = null;
    this.step = new Float64Array(problem.size);
    this.measures = [];
    this.corrected = false;
  }
  get length() { return this.point ? largest(this.step) : Infinity; }
  measure(point) {
    let missed = 0;
    for (let k = 1; k < point.rows.length; k++) missed += Math.max(-point.rows[k], 0);
    return [point.objective / this.scale, missed];
  }
  accepts(trial) {
    if (!this.point || this.length <= SETTLED) return true;
    const merit = ([value, missed]) => value + this.price * missed;
    return merit(this.measure(trial)) < Math.max(...this.measures.slice(-MEMORY).map(merit));
  }
  advance(trial) {
    const { point, problem } = this;
    if (point) {
      const change = trial.jacobian[0].map((x, j) => (x - point.jacobian[0][j]) / this.scale);
      for (let k = 1; k < problem.rows; k++) {
        const multiplier = this.prices[k - 1];
        if (multiplier) for (let j = 0; j < change.length; j++) change[j] -= multiplier * (trial.jacobian[k][j] - point.jacobian[k][j]);
      }
      this.learn(added(trial.z, -1, point.z), change);
      if (this.length > 0.9 * this.radius) this.radius = Math.min(2 * this.radius, LONGEST_STEP);
    }
    this.point = trial;
    this.measures.push(this.measure(trial));
    this.chooseStep();
  }
  // After a rejected `trial` the step is corrected for the curvature of the limits [NocedalWright2006] section 18.3.
  chooseStep(trial = null) {
    const { problem, point } = this, { gradients } = problem.limits(point), m = problem.rows - 1;
    const margins = Float64Array.of(
      ...(trial ? trial.rows.subarray(1).map((x, k) => x - dot(gradients[k], this.step)) : point.rows.subarray(1)),
      ...point.z.map((x, k) => Math.min(x - problem.low[k], this.radius)), ...point.z.map((x, k) => Math.min(problem.high[k] - x, this.radius)));
    const found = quadratic(this.hessian, point.jacobian[0].map((x) => x / this.scale), gradients, margins, this.prices);
    this.corrected = Boolean(trial);
    this.prices = found.prices;
    this.price = Math.max(this.price, priceOf(found.prices.subarray(0, m)));
    const share = Math.min(1, this.radius / Math.max(largest(found.step), 1e-300));
    this.step = found.step.map((x) => share * x);
  }
  // Update the Hessian, damped to stay convex [NocedalWright2006] procedure 18.2.
  learn(step, change) {
    const product = times(this.hessian, step), curvature = dot(step, product);
    let measured = dot(step, change), changed = change;
    if (!(curvature > 1e-20)) return;
    if (measured < 0.2 * curvature) {
      const share = 0.8 * curvature / (curvature - measured);
      changed = change.map((x, k) => share * x + (1 - share) * product[k]);
      measured = dot(step, changed);
    }
    const update = this.hessian.map((row, i) => row.map((x, j) => x - product[i] * product[j] / curvature + changed[i] * changed[j] / measured));
    const { values } = eigen(update);
    if (Math.min(...values) > LEAST_CURVATURE * Math.max(...values)) this.hessian = update;
  }
  // The valley of the point reached, from which further descents can start.
  valley() { return { point: this.point, hessian: this.hessian, scale: this.scale, prices: this.prices, price: this.price }; }
}
const priceOf = (prices) => 2 * prices.reduce((a, b) => Math.max(a, b), 0) + 1;

// The optimum that full quadratic steps reach from an evaluated point; null if they do not converge.
function fullSteps(problem, descent, start, numbers) {
  let before = Infinity, reference = Infinity, trial = start;
  for (let iteration = 0; iteration < ITERATIONS; iteration++) {
    if (iteration) trial = problem.at(clipped(added(trial.z, 1, descent.step), problem.low, problem.high), numbers);
    if (!trial.valid) return null;
    if (before <= SETTLED && isOptimum(problem, trial)) return (descent.point = trial);
    if (iteration > PATIENT && trial.violation > Math.max(0.98 * reference, MET)) return null;
    if (iteration % PATIENT === 0) reference = trial.violation;
    descent.advance(trial);
    if (!Number.isFinite(descent.length) || descent.length > 4 * Math.max(before, 1e-3)) return null;
    before = descent.length;
  }
  return null;
}
// The optimum that a descent within a trust region reaches; null if it fails.
function trustedSteps(problem, descent, start, numbers) {
  let z = clipped(start, problem.low, problem.high);
  for (let evaluation = 0; evaluation < LONGEST; evaluation++) {
    const trial = problem.at(z, numbers);
    if (trial.valid && descent.accepts(trial)) {
      if (descent.length <= SETTLED && isOptimum(problem, trial)) return (descent.point = trial);
      descent.advance(trial);
    } else if (!descent.point || descent.length <= LEAST_RADIUS) return null;
    else if (trial.valid && !descent.corrected) descent.chooseStep(trial);
    else {
      descent.radius = descent.length / 2;
      descent.chooseStep();
    }
    z = clipped(added(descent.point.z, 1, descent.step), problem.low, problem.high);
  }
  return null;
}
// A feasible point near an evaluated point, and the least infeasible point met; every step is the shortest that meets the linearised limits.
function restored(problem, start, numbers) {
  let trial = start, least = null, reference = Infinity;
  const identity = problem.units, nothing = new Float64Array(problem.size);
  for (let iteration = 0; iteration < RESTORATIONS && trial.valid; iteration++) {
    if (trial.violation <= MET) return { feasible: trial, least: trial };
    if (!least || trial.violation < least.violation) least = trial;
    if (iteration > PATIENT && trial.violation > 0.98 * reference) break;
    if (iteration % PATIENT === 0) reference = trial.violation;
    const { margins, gradients } = problem.limits(trial), near = gradients.map((_, k) => k).filter((k) => margins[k] <= 1);
    const { step } = quadratic(identity, nothing, near.map((k) => gradients[k]), Float64Array.from(near, (k) => margins[k] - 1e-7));
    const share = Math.min(1, LONGEST_STEP / Math.max(largest(step), 1e-300));
    trial = problem.at(clipped(added(trial.z, share, step), problem.low, problem.high), numbers);
  }
  return { feasible: null, least };
}

// The best end of all descents for changed numbers, begun at the known optima (valleys, the best first) or on the way
// from the numbers of the first. `breathe` is awaited between descents.
// Result: { point, optimum, descent, known }; known is false if a descent met a branch of the models that was not recorded.
async function solved(problem, valleys, numbers, breathe) {
  const best = { point: null, optimum: false, descent: null, least: null, known: true };
  const take = (point, optimum, descent) => {
    const worse = best.point && best.point.objective - BETTER * Math.abs(best.point.objective) <= point.objective;
    if (!worse || (optimum && !best.optimum && point.objective <= best.point.objective + BETTER * Math.abs(point.objective))) Object.assign(best, { point, optimum, descent });
  };
  const noted = (point) => {
    if (!point.known) best.known = false;
    if (point.valid && (!best.least || point.violation < best.least.violation)) best.least = point;
    return point;
  };
  const descend = (valley, start) => {
    const descent = new Descent(problem, valley, true), end = trustedSteps(problem, descent, start.z, numbers), stop = descent.point;
    if (stop && stop.violation <= MET) take(stop, Boolean(end), descent);
  };
  const restore = (start) => {
    const { feasible, least } = restored(problem, start, numbers);
    if (least) noted(least);
    return feasible;
  };
  const [first, ...others] = valleys, unmoved = noted(problem.at(first.z, numbers));
  const descent = new Descent(problem, first, false), end = fullSteps(problem, descent, unmoved, numbers);
  const uphill = end && unmoved.violation <= FEASIBLE && unmoved.objective < end.objective - 1e-9 * Math.abs(end.objective);
  if (end && !uphill) take(end, true, descent);
  else {
    const feasible = restore(unmoved);
    if (feasible) descend(first, feasible);
  }
  for (const valley of others) {
    await breathe();
    const z = clipped(valley.z.map((x, k) => x + BEYOND * (x - first.z[k])), problem.low, problem.high), feasible = restore(noted(problem.at(z, numbers)));
    if (feasible) descend(valley, feasible);
  }
  if (others.length && best.point) {
    for (const valley of valleys) {
      const point = problem.at(valley.z, numbers);
      if (point.violation <= FEASIBLE && point.objective < best.point.objective - BETTER * Math.abs(best.point.objective)) descend(first, point);
    }
  }
  if (!best.optimum) {
    const found = await followed(problem, first, numbers, breathe);
    if (found) take(found.point, true, found);
  }
  return best;
}
// The optimum along a straight way from the numbers of a valley to other numbers, in steps; null where the way ends.
async function followed(problem, valley, numbers, breathe) {
  let [share] = SHARES, at = 0, here = valley, descent = null;
  while (at < 1) {
    await breathe();
    const next = Math.min(1, at + share), between = valley.numbers.map((x, k) => x + next * (numbers[k] - x));
    const start = problem.at(here.z, between);
    descent = new Descent(problem, here, false);
    let end = fullSteps(problem, descent, start, between);
    if (!end) {
      const { feasible } = restored(problem, start, between);
      descent = new Descent(problem, here, true);
      end = feasible && trustedSteps(problem, descent, feasible.z, between);
    }
    if (end) {
      at = next;
      here = { ...descent.valley(), z: end.z };
      share = Math.min(2 * share, SHARES[0]);
    } else if (share > SHARES[1]) share /= 2;
    else return null;
  }
  return descent;
}
// By how much the objective may still fall at a point whose conditions are not met: what the next quadratic step
// promises, and, for a kink that stops all steps, what the gradient promises within NEAR of every coordinate.
function promised(problem, descent) {
  const { point, hessian, scale } = descent, slope = point.jacobian[0].map((x) => x / scale), gains = [0];
  for (const [matrix, radius] of [[hessian, LONGEST_STEP], [problem.units.map((row) => row.map((x) => NEAR * x)), NEAR]]) {
    const { margins, gradients } = problem.limits(point), bounds = problem.rows - 1;
    const { step, fits } = quadratic(matrix, slope, gradients, margins.map((x, k) => (k < bounds ? Math.max(x, 0) : Math.min(x, radius))));
    if (fits) gains.push(-dot(slope, step) - 0.5 * dot(step, times(matrix, step)));
  }
  return scale * Math.max(...gains);
}
