// Linear algebra of small dense systems: vectors are Float64Array, a matrix is an array of its rows.
const dot = (a, b) => { let sum = 0; for (let k = 0; k < a.length; k++) sum += a[k] * b[k]; return sum; };
const norm = (a) => Math.sqrt(dot(a, a));
const largest = (a) => a.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
const added = (a, share, b) => a.map((x, k) => x + share * b[k]);
const times = (matrix, vector) => Float64Array.from(matrix, (row) => dot(row, vector));
const unit = (size, k, length = 1) => { const made = new Float64Array(size); made[k] = length; return made; };
// The combination of rows with these factors.
function combined(rows, factors, size) {
  const sum = new Float64Array(size);
  rows.forEach((row, j) => { if (factors[j]) for (let k = 0; k < size; k++) sum[k] += factors[j] * row[k]; });
  return sum;
}
const DEPENDENT = 1e-10;  // the share of a column that others leave, below which it depends on them

// Least squares with independent columns of length 1, by Gram-Schmidt done twice; null if they depend on each other.
function leastSquares(columns, vector) {
  const basis = [], triangle = [];
  for (const column of columns) {
    const rest = Float64Array.from(column), parts = new Float64Array(columns.length);
    for (let pass = 0; pass < 2; pass++) basis.forEach((one, j) => {
      const share = dot(one, rest);
      parts[j] += share;
      for (let k = 0; k < rest.length; k++) rest[k] -= share * one[k];
    });
    const length = norm(rest);
    if (!(length > DEPENDENT)) return null;
    parts[basis.length] = length;
    triangle.push(parts);
    basis.push(rest.map((x) => x / length));
  }
  const left = Float64Array.from(vector), result = new Float64Array(columns.length);
  basis.forEach((one, j) => {
    result[j] = dot(one, left);
    for (let k = 0; k < left.length; k++) left[k] -= result[j] * one[k];
  });
  for (let j = columns.length - 1; j >= 0; j--) {
    for (let k = j + 1; k < columns.length; k++) result[j] -= triangle[k][j] * result[k];
    result[j] /= triangle[j][j];
  }
  return result;
}

// Non-negative least squares [LawsonHanson1974]: minimise |sum of result * column - vector| with result >= 0.
// `previous` is the result of a similar problem; its positive columns are tried first.
function nonNegative(columns, vector, previous) {
  const sizes = columns.map(norm), least = 1e-14 * sizes.reduce((a, b) => Math.max(a, b), 0), used = [];
  sizes.forEach((size, k) => { if (size > least) used.push(k); });
  const scaled = used.map((k) => columns[k].map((x) => x / sizes[k])), count = used.length;
  const restricted = (set) => {
    const places = [];
    set.forEach((is, k) => { if (is) places.push(k); });
    const part = leastSquares(places.map((k) => scaled[k]), vector);
    if (!part) return null;
    const whole = new Float64Array(count);
    places.forEach((k, j) => { whole[k] = part[j]; });
    return whole;
  };
  let result = new Float64Array(count), passive = used.map((k) => Boolean(previous && previous[k] > 0));
  for (;;) {
    const trial = passive.some(Boolean) ? restricted(passive) : null;
    if (!trial) { passive = passive.map(() => false); break; }
    if (trial.every((x, k) => !passive[k] || x > 0)) { result = trial; break; }
    passive = passive.map((is, k) => is && trial[k] > 0);
  }
  const refused = new Set(), tolerance = 1e-13 * norm(vector);
  for (let round = 0; round < 5 * count; round++) {
    const left = added(vector, -1, combined(scaled, result, vector.length));
    let entering = -1, pull = tolerance;
    for (let k = 0; k < count; k++) {
      if (passive[k] || refused.has(k)) continue;
      const own = dot(scaled[k], left);
      if (own > pull) { pull = own; entering = k; }
    }
    if (entering < 0) break;
    passive[entering] = true;
    let trial = restricted(passive);
    if (!trial || trial[entering] <= 0) { passive[entering] = false; refused.add(entering); continue; }
    while (trial.some((x, k) => passive[k] && x <= 0)) {
      const shares = trial.map((x, k) => {
        if (!passive[k] || x > 0) return Infinity;
        return result[k] > x ? result[k] / (result[k] - x) : 0;
      });
      const share = shares.reduce((a, b) => Math.min(a, b), Infinity);
      result = result.map((x, k) => x + share * (trial[k] - x));
      shares.forEach((one, k) => { if (one <= share * (1 + 1e-12)) passive[k] = false; });
      result = result.map((x, k) => (passive[k] ? x : 0));
      if (!passive.some(Boolean)) { trial = result; break; }
      trial = restricted(passive) || result;
    }
    result = trial;
    refused.clear();
  }
  const whole = new Float64Array(columns.length);
  used.forEach((k, j) => { whole[k] = result[j] / sizes[k]; });
  return whole;
}

// Lower triangular factor of a positive definite matrix; null if it is not.
function cholesky(matrix) {
  const factor = matrix.map(() => new Float64Array(matrix.length));
  for (let i = 0; i < matrix.length; i++) {
    for (let j = 0; j <= i; j++) {
      let sum = matrix[i][j];
      for (let k = 0; k < j; k++) sum -= factor[i][k] * factor[j][k];
      if (i === j && !(sum > 0)) return null;
      factor[i][j] = i === j ? Math.sqrt(sum) : sum / factor[j][j];
    }
  }
  return factor;
}
function forward(factor, vector) {
  const result = Float64Array.from(vector);
  for (let i = 0; i < result.length; i++) {
    for (let k = 0; k < i; k++) result[i] -= factor[i][k] * result[k];
    result[i] /= factor[i][i];
  }
  return result;
}
function backward(factor, vector) {
  const result = Float64Array.from(vector);
  for (let i = result.length - 1; i >= 0; i--) {
    for (let k = i + 1; k < result.length; k++) result[i] -= factor[k][i] * result[k];
    result[i] /= factor[i][i];
  }
  return result;
}

// Eigenvalues of a symmetric matrix and their vectors (rows), by cyclic Jacobi rotations.
function eigen(matrix) {
  const n = matrix.length, a = matrix.map((row) => Float64Array.from(row)), vectors = a.map((_, k) => unit(n, k));
  for (let sweep = 0; sweep < 30; sweep++) {
    let off = 0, all = 0;
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) { all += a[i][j] ** 2; if (i !== j) off += a[i][j] ** 2; }
    if (!(off > 1e-30 * all)) break;
    for (let p = 0; p < n; p++) {
      for (let q = p + 1; q < n; q++) {
        if (a[p][q] === 0) continue;
        const ratio = (a[q][q] - a[p][p]) / (2 * a[p][q]), t = (ratio < 0 ? -1 : 1) / (Math.abs(ratio) + Math.hypot(ratio, 1));
        const c = 1 / Math.hypot(t, 1), s = t * c;
        for (let k = 0; k < n; k++) [a[k][p], a[k][q]] = [c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]];
        for (let k = 0; k < n; k++) [a[p][k], a[q][k]] = [c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]];
        for (let k = 0; k < n; k++) [vectors[p][k], vectors[q][k]] = [c * vectors[p][k] - s * vectors[q][k], s * vectors[p][k] + c * vectors[q][k]];
      }
    }
  }
  return { values: a.map((row, k) => row[k]), vectors };
}
// The shortest solution of a symmetric system; eigenvalues below this share of the largest count as 0.
function shortest({ values, vectors }, right, share) {
  const least = share * largest(values), sum = new Float64Array(right.length);
  values.forEach((value, k) => {
    if (!(Math.abs(value) > least)) return;
    const part = dot(vectors[k], right) / value;
    for (let j = 0; j < sum.length; j++) sum[j] += part * vectors[k][j];
  });
  return sum;
}

// The step d that minimises d'Hd/2 + slope'd with margins + rows d >= 0, and the prices of the rows: the distance
// to the nearest point of a polyhedron, by non-negative least squares [LawsonHanson1974] ch. 23. If the rows
// contradict each other, `fits` is false and the step is the shortest that removes the violations by least squares.
function quadratic(hessian, slope, rows, margins, previous) {
  const factor = cholesky(hessian), prices = new Float64Array(rows.length);
  if (!factor) return { step: slope.map(() => NaN), prices, fits: false };
  const scaled = forward(factor, slope), places = [], columns = [], lengths = [];
  rows.forEach((row, k) => {
    const inner = forward(factor, row), length = norm(inner);
    if (!(length > 1e-12)) return;
    const column = new Float64Array(slope.length + 1);
    inner.forEach((x, j) => { column[j] = x / length; });
    column[slope.length] = (dot(inner, scaled) - margins[k]) / length;
    places.push(k); columns.push(column); lengths.push(length);
  });
  const target = unit(slope.length + 1, slope.length);
  const weights = nonNegative(columns, target, previous && places.map((k) => previous[k]));
  const left = added(combined(columns, weights, target.length), -1, target), last = left[slope.length];
  if (-last <= 1e-12) return { step: removing(rows, margins, slope.length), prices, fits: false };
  places.forEach((k, j) => { prices[k] = weights[j] / -last / lengths[j]; });
  const nearest = slope.map((_, k) => -left[k] / last - scaled[k]);
  return { step: backward(factor, nearest), prices, fits: true };
}
function removing(rows, margins, size) {
  const missed = rows.map((_, k) => k).filter((k) => margins[k] < 0), square = Array.from({ length: size }, () => new Float64Array(size));
  for (const k of missed) for (let i = 0; i < size; i++) for (let j = 0; j < size; j++) square[i][j] += rows[k][i] * rows[k][j];
  return shortest(eigen(square), combined(missed.map((k) => rows[k]), missed.map((k) => -margins[k]), size), 1e-14);
}
