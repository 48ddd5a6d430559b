"use strict";
/* The machine of machine.h for pages: values of a program, with derivatives along directions.

   const program = Machine.program(data);             // data: `Program.for_page()` of Python, or its arrays
   const { values, slopes } = Machine.run(program, inputs, seeds);

   `inputs` has a number for each input. `seeds` is optional: a list of directions, each the change
   of every input. `values` has a number for each output; slopes[k * seeds.length + t] is the change
   of output k in direction t. Both arrays are new in every call. */
const Machine = (() => {
  // Names in the order of the cases below; a page names its own order.
  const NAMES = ("add sub mul div neg sqrt exp expm1 log log1p pow sin cos tan tanh sinh cosh " +
    "arctan arcsin arccos atan2 abs sign floor cbrt copysign hypot lt le eq and or not isnan " +
    "where roots").split(" ");
  const [ADD, SUB, MUL, COPYSIGN, WHERE, ROOTS] =
    ["add", "sub", "mul", "copysign", "where", "roots"].map((name) => NAMES.indexOf(name));
  const STEPS = new Set(["lt", "le", "eq", "and", "or", "not", "isnan", "sign", "floor", "roots"]
    .map((name) => NAMES.indexOf(name)));
  const WORDS = 5, FIRST = 1, SECOND = 2, THIRD = 4, RESULT = 8, FROZEN = 16;

  /* Flags of the operands by which an operation has derivatives. */
  function slopedOperands(operation) {
    if (STEPS.has(operation)) return 0;
    return operation === COPYSIGN ? FIRST : operation === WHERE ? SECOND | THIRD : 7;
  }

  function unpacked(content, Kind) {
    if (content instanceof Kind) return content;
    const bytes = Uint8Array.from(atob(content), (character) => character.charCodeAt(0));
    return new Kind(bytes.buffer);
  }

  /* A program from the data of a page; raises an error if the page is of another version. */
  function program(data) {
    const code = unpacked(data.code, Uint16Array);
    const local = data.operations.map((name) => NAMES.indexOf(name));
    if (local.includes(-1)) throw new Error("the program has an unknown operation");
    for (let k = 0; k < code.length; k += WORDS)
      code[k] = local[code[k] & 255] | (code[k] >> 8) << 8;
    return {
      code,
      extra: unpacked(data.extra, Int32Array),
      outputs: unpacked(data.outputs, Int32Array),
      frozen: unpacked(data.frozen, Uint8Array),
      constants: unpacked(data.constants, Float64Array),
      slots: data.slots,
      inputs: data.inputs,
      followed: new Map(),
    };
  }

  // ---- functions with the results of C ----

  const NUMBER = new Float64Array(1), BITS = new Uint8Array(NUMBER.buffer);

  function isNegative(a) {
    NUMBER[0] = a;
    return (BITS[7] & 128) !== 0;
  }

  function copysign(a, b) {
    return isNegative(a) === isNegative(b) ? a : -a;
  }

  function pow(a, b) {
    if (a === 1 || (a === -1 && (b === Infinity || b === -Infinity))) return 1;
    return Math.pow(a, b);
  }

  function sign(a) {
    return a !== a ? a : (a > 0 ? 1 : 0) - (a < 0 ? 1 : 0);
  }

  // ---- roots of a real polynomial, as in machine.h ----

  const BEYOND = 1.324718, SHY = 1 + 1e-15;

  function cubic(b, c, d, re, im) {
    let x = b * (-1 / 3);
    const inflection = x;
    let first = x + b, second = first * x + c;
    let value = second * x + d, rise = (x + first) * x + second;
    let distance = Math.cbrt(Math.abs(value));
    const falls = Math.sqrt(rise < 0 ? -rise : 0);
    if (falls > 0) distance = BEYOND * (distance > falls ? distance : falls);
    const side = copysign(1, value);
    let following = x - side * distance;
    for (let k = 0; following !== x && k < 120; k++) {
      x = following;
      first = x + b, second = first * x + c;
      value = second * x + d, rise = (x + first) * x + second;
      following = x - value / rise / SHY;
      if (side * (following - inflection) > 0) following = inflection;
      if (!(side * (following - x) > 0)) break;
    }
    let product = -d / x;
    const far = Math.abs(x) * x * x > Math.abs(d);
    const linear = far ? (product - c) / x : x + b;
    if (!far) product = (x + b) * x + c;
    const half = -0.5 * linear, discriminant = half * half - product;
    const offset = Math.sqrt(Math.abs(discriminant)), larger = half + copysign(offset, half);
    const real = discriminant >= 0;
    re[0] = x, im[0] = 0;
    re[1] = real ? larger : half, im[1] = real ? 0 : offset;
    re[2] = real ? (larger !== 0 ? product / larger : 0) : half, im[2] = -im[1];
  }

  function starts(c, n, re, im) {
    const height = [], corner = [];
    for (let k = 0; k <= n; k++)
      height.push(k === n ? 0 : c[k] !== 0 ? Math.log(Math.abs(c[k])) : -1e300);
    for (let k = 0; k <= n; k++) {
      if (height[k] <= -1e300 && k > 0) continue;
      while (corner.length > 1) {
        const i = corner[corner.length - 2], j = corner[corner.length - 1];
        if ((height[j] - height[i]) * (k - i) > (height[k] - height[i]) * (j - i)) break;
        corner.pop();
      }
      corner.push(k);
    }
    for (let part = 0; part + 1 < corner.length; part++) {
      const i = corner[part], j = corner[part + 1];
      const radius = height[i] <= -1e300 ? 0 : Math.exp((height[i] - height[j]) / (j - i));
      for (let k = i; k < j; k++) {
        const angle = 2 * Math.PI * (k - i) / (j - i) + 2 * Math.PI * i / n + 0.7;
        re[k] = radius * Math.cos(angle), im[k] = radius * Math.sin(angle);
      }
    }
  }

  /* A step of root k towards its place; whether it still moves. */
  function stepped(c, n, k, re, im, done) {
    const x = re[k], y = im[k], far = Math.hypot(x, y);
    let scale = 1, pr = 1, pi = 0, sr = 0, si = 0;
    for (let j = n - 1; j >= 0; j--) {
      scale = scale * far + Math.abs(c[j]);
      [sr, si] = [sr * x - si * y + pr, sr * y + si * x + pi];
      [pr, pi] = [pr * x - pi * y + c[j], pr * y + pi * x];
    }
    let size = pr * pr + pi * pi;
    if (Math.abs(pr) + Math.abs(pi) <= 1e-16 * scale) {
      done[k] = 1;
      return false;
    }
    let qr = (sr * pr + si * pi) / size, qi = (si * pr - sr * pi) / size;
    for (let j = 0; j < n; j++) {
      if (j === k) continue;
      const dx = x - re[j], dy = y - im[j], d2 = dx * dx + dy * dy;
      if (d2 > 0) qr -= dx / d2, qi += dy / d2;
    }
    size = qr * qr + qi * qi;
    const mx = qr / size, my = -qi / size;
    if (!(Number.isFinite(mx) && Number.isFinite(my))) return false;
    re[k] = x - mx, im[k] = y - my;
    if (mx * mx + my * my <= 1e-32 * (x * x + y * y)) done[k] = 1;
    return !done[k];
  }

  function together(c, n, re, im) {
    const done = new Uint8Array(n);
    starts(c, n, re, im);
    for (let step = 0; step < 200; step++) {
      let moving = false;
      for (let k = 0; k < n; k++)
        if (!done[k] && stepped(c, n, k, re, im, done)) moving = true;
      if (!moving) break;
    }
    for (let k = 0; k < n; k++) {
      let x = re[k];
      if (Math.abs(im[k]) > 1e-12 * Math.hypot(x, im[k])) continue;
      im[k] = 0;
      for (let step = 0; step < 3; step++) {
        let p = 1, s = 0;
        for (let j = n - 1; j >= 0; j--) s = s * x + p, p = p * x + c[j];
        const next = x - p / s;
        if (!Number.isFinite(next) || Math.abs(next - x) > 1e-9 * Math.abs(x)) break;
        x = next;
      }
      re[k] = x;
    }
  }

  function roots(p, n, re, im) {
    const lead = p[n], monic = new Float64Array(n);
    let size = pow(Math.abs(p[0] / lead), 1 / n);
    if (!(Number.isFinite(size) && size > 0)) size = 1;
    if (lead === 0 && p.subarray(0, n).every(Number.isFinite)) {
      re[0] = -Infinity, im[0] = 0;
      if (n > 1) roots(p.subarray(0, n), n - 1, re.subarray(1), im.subarray(1));
      return;
    }
    for (let k = 0; k < n; k++) monic[k] = p[k] / lead * pow(size, k - n);
    if (!monic.every(Number.isFinite)) {
      re.fill(NaN, 0, n), im.fill(NaN, 0, n);
      return;
    }
    if (n === 1) re[0] = -monic[0], im[0] = 0;
    else if (n === 3) cubic(monic[2], monic[1], monic[0], re, im);
    else together(monic, n, re, im);
    for (let k = 0; k < n; k++) re[k] *= size, im[k] *= size;
  }

  function rootsAt(p, at, V) {
    const { code, extra } = p, n = code[at + 3], result = code[at + 1];
    const given = Float64Array.from({ length: n + 1 }, (_, k) => V[extra[code[at + 2] + k]]);
    roots(given, n, V.subarray(result, result + n), V.subarray(result + n, result + 2 * n));
  }

  // ---- values ----

  function valueOf(operation, a, b, c) {
    switch (operation) {
      case 0: return a + b;
      case 1: return a - b;
      case 2: return a * b;
      case 3: return a / b;
      case 4: return -a;
      case 5: return Math.sqrt(a);
      case 6: return Math.exp(a);
      case 7: return Math.expm1(a);
      case 8: return Math.log(a);
      case 9: return Math.log1p(a);
      case 10: return pow(a, b);
      case 11: return Math.sin(a);
      case 12: return Math.cos(a);
      case 13: return Math.tan(a);
      case 14: return Math.tanh(a);
      case 15: return Math.sinh(a);
      case 16: return Math.cosh(a);
      case 17: return Math.atan(a);
      case 18: return Math.asin(a);
      case 19: return Math.acos(a);
      case 20: return Math.atan2(a, b);
      case 21: return Math.abs(a);
      case 22: return sign(a);
      case 23: return Math.floor(a);
      case 24: return Math.cbrt(a);
      case 25: return copysign(a, b);
      case 26: return Math.hypot(a, b);
      case 27: return a < b ? 1 : 0;
      case 28: return a <= b ? 1 : 0;
      case 29: return a === b ? 1 : 0;
      case 30: return a !== 0 && b !== 0 ? 1 : 0;
      case 31: return a !== 0 || b !== 0 ? 1 : 0;
      case 32: return a === 0 ? 1 : 0;
      case 33: return a !== a ? 1 : 0;
      default: return a !== 0 ? b : c;
    }
  }

  /* Derivatives of a result r by its operands, to `D2`; sums and products are left out. */
  const D2 = new Float64Array(2);

  function slopesOf(operation, a, b, r, varies) {
    let f = 0, g = 0;
    switch (operation) {
      case 3: f = 1 / b, g = -r / b; break;
      case 4: f = -1; break;
      case 5: f = 0.5 / r; break;
      case 6: f = r; break;
      case 7: f = Math.exp(a); break;
      case 8: f = 1 / a; break;
      case 9: f = 1 / (1 + a); break;
      case 10: f = b * pow(a, b - 1), g = varies ? r * Math.log(a) : 0; break;
      case 11: f = Math.cos(a); break;
      case 12: f = -Math.sin(a); break;
      case 13: f = 1 + r * r; break;
      case 14: f = 1 - r * r; break;
      case 15: f = Math.cosh(a); break;
      case 16: f = Math.sinh(a); break;
      case 17: f = 1 / (1 + a * a); break;
      case 18: f = 1 / Math.sqrt(1 - a * a); break;
      case 19: f = -1 / Math.sqrt(1 - a * a); break;
      case 20: f = b / (a * a + b * b), g = -a / (a * a + b * b); break;
      case 21: f = sign(a); break;
      case 24: f = 1 / (3 * r * r); break;
      case 25: f = isNegative(a) === isNegative(b) ? 1 : -1; break;
      case 26: f = a / r, g = b / r; break;
    }
    D2[0] = f, D2[1] = g;
  }

  // ---- a whole program ----

  /* Flags of all instructions and outputs, for the inputs that change. */
  function followed(p, moving) {
    const key = moving.join("");
    if (p.followed.has(key)) return p.followed.get(key);
    const { code } = p, flags = new Uint8Array(code.length / WORDS);
    const active = new Uint8Array(p.slots + p.constants.length);
    active.set(moving);
    for (let k = 0, at = 0; at < code.length; k++, at += WORDS) {
      const operation = code[at] & 255, frozen = code[at] >> 8;
      if (operation === ROOTS) {
        active.fill(0, code[at + 1], code[at + 1] + 2 * code[at + 3]);
        continue;
      }
      let found = 0;
      for (let j = 0; j < 3; j++)
        if (active[code[at + 2 + j]] && !(frozen & FROZEN << j)) found |= 1 << j;
      found &= slopedOperands(operation);
      if (found) found |= RESULT;
      flags[k] = found;
      active[code[at + 1]] = found & RESULT ? 1 : 0;
    }
    const varies = p.outputs.map((slot, k) => (p.frozen[k] ? 0 : active[slot]));
    p.followed.set(key, { flags, varies });
    return p.followed.get(key);
  }

  /* Derivatives of an instruction's result along T directions. */
  function derive(code, at, flags, V, D, T, a, b) {
    const operation = code[at] & 255, R = code[at + 1] * T;
    if (operation === WHERE) {
      const chosen = a !== 0 ? 3 : 4;
      const from = flags & (a !== 0 ? SECOND : THIRD) ? code[at + chosen] * T : -1;
      for (let t = 0; t < T; t++) D[R + t] = from < 0 ? 0 : D[from + t];
      return;
    }
    let f = 1, g = 1;
    if (operation === MUL) f = b, g = a;
    else if (operation === SUB) g = -1;
    else if (operation !== ADD) {
      slopesOf(operation, a, b, V[code[at + 1]], flags & SECOND);
      f = D2[0], g = D2[1];
    }
    const A = code[at + 2] * T, B = code[at + 3] * T;
    if (!(flags & SECOND))
      for (let t = 0; t < T; t++) D[R + t] = f * D[A + t];
    else if (!(flags & FIRST)) for (let t = 0; t < T; t++) D[R + t] = g * D[B + t];
    else for (let t = 0; t < T; t++) D[R + t] = f * D[A + t] + g * D[B + t];
  }

  function run(p, inputs, seeds = []) {
    const T = seeds.length, { code, outputs } = p;
    const V = new Float64Array(p.slots + p.constants.length), D = new Float64Array(p.slots * T);
    V.set(inputs), V.set(p.constants, p.slots);
    const moving = new Uint8Array(p.inputs);
    for (let t = 0; t < T; t++)
      for (let k = 0; k < p.inputs; k++) {
        D[k * T + t] = seeds[t][k];
        if (seeds[t][k] !== 0) moving[k] = 1;
      }
    const { flags, varies } = followed(p, moving);
    for (let k = 0, at = 0; at < code.length; k++, at += WORDS) {
      const operation = code[at] & 255;
      if (operation === ROOTS) {
        rootsAt(p, at, V);
        continue;
      }
      const a = V[code[at + 2]], b = V[code[at + 3]];
      V[code[at + 1]] = operation === MUL ? a * b : operation === ADD ? a + b
        : operation === SUB ? a - b : valueOf(operation, a, b, V[code[at + 4]]);
      if (flags[k] & RESULT) derive(code, at, flags[k], V, D, T, a, b);
    }
    const values = Float64Array.from(outputs, (slot) => V[slot]);
    const slopes = new Float64Array(outputs.length * T);
    for (let k = 0; k < outputs.length; k++)
      if (varies[k]) slopes.set(D.subarray(outputs[k] * T, outputs[k] * T + T), k * T);
    return { values, slopes };
  }

  return { program, run, names: NAMES };
})();
