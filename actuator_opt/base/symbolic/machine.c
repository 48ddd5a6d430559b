/* A machine for recorded models: values of designs, with derivatives along several directions.

   A program is a list of instructions on numbered slots. Every slot holds a value for each of
   several designs side by side ("lanes"), or the value of a single design with its derivatives
   along several directions ("dual"). All numbers are doubles; a truth value is 0 or 1. NaN and
   infinity follow IEEE 754, as in NumPy.
*/
#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define OPERATIONS(X) \
    X(add) X(sub) X(mul) X(div) X(neg) X(sqrt) X(exp) X(expm1) X(log) X(log1p) X(pow) X(sin) \
    X(cos) X(tan) X(tanh) X(sinh) X(cosh) X(arctan) X(arcsin) X(arccos) X(atan2) X(abs) X(sign) \
    X(floor) X(cbrt) X(copysign) X(hypot) X(lt) X(le) X(eq) X(and) X(or) X(not) X(isnan) X(where) X(roots)
#define ENUM(name) OP_##name,
enum { OPERATIONS(ENUM) OPERATION_COUNT };
#define TEXT(name) #name,
static const char *const NAMES[] = {OPERATIONS(TEXT)};

/* An instruction is five short words: operation and flags, result, and up to three operands. */
enum { WORDS = 5, LANES = 32, MOST_DEGREE = 32 };
/* Flags: which operands, and whether the result, have derivatives; operands without them. */
#define OPERATION(at) ((at)[0] & 255)
#define FLAGS(at) ((at)[0] >> 8)
enum { FIRST = 1, SECOND = 2, THIRD = 4, RESULT = 8, FROZEN = 16 };

#if defined(__GNUC__) && defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#define FAST __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define FAST
#endif
#if defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif

/* ---- roots of a real polynomial ---- */

static const double BEYOND = 1.324718; /* root of x^3 = x + 1: a start beyond the outer root */
static const double PI = 3.14159265358979323846;
static const double SHY = 1 + 1e-15;   /* keeps rounding from carrying a step past the root */

/* Roots of x^3 + b x^2 + c x + d, the real root first [Kahan1986]. */
static void cubic(double b, double c, double d, double *re, double *im) {
    double x = b * (-1.0 / 3), inflection = x;
    double first = x + b, second = first * x + c;
    double value = second * x + d, rise = (x + first) * x + second;
    double distance = cbrt(fabs(value)), falls = sqrt(rise < 0 ? -rise : 0.0);
    if (falls > 0) distance = BEYOND * (distance > falls ? distance : falls);
    double side = copysign(1.0, value), following = x - side * distance;
    for (int k = 0; following != x && k < 120; k++) {
        x = following;
        first = x + b, second = first * x + c;
        value = second * x + d, rise = (x + first) * x + second;
        following = x - value / rise / SHY;
        if (side * (following - inflection) > 0) following = inflection;
        if (!(side * (following - x) > 0)) break;
    }
    double product = -d / x;
    int far = fabs(x) * x * x > fabs(d);
    double linear = far ? (product - c) / x : x + b;
    if (!far) product = (x + b) * x + c;
    double half = -0.5 * linear, discriminant = half * half - product;
    double offset = sqrt(fabs(discriminant)), larger = half + copysign(offset, half);
    int real = discriminant >= 0;
    re[0] = x, im[0] = 0.0;
    re[1] = real ? larger : half, im[1] = real ? 0.0 : offset;
    re[2] = real ? (larger != 0 ? product / larger : 0.0) : half, im[2] = -im[1];
}

/* Roots of a monic polynomial with coefficients c[0..n-1], lowest first, all at once [Aberth1973];
   roots close to the real axis are placed on it and refined there. */
static void together(const double *c, int n, double *re, double *im) {
    /* Starts on circles whose radii follow from the corners of the upper hull of log|c| [Bini1996]:
       few steps suffice even where the sizes of the roots differ by orders of magnitude. */
    double height[MOST_DEGREE + 1];
    int corner[MOST_DEGREE + 1], corners = 0;
    for (int k = 0; k <= n; k++) height[k] = k == n ? 0.0 : c[k] != 0 ? log(fabs(c[k])) : -1e300;
    for (int k = 0; k <= n; k++) {
        if (height[k] <= -1e300 && k > 0) continue;
        while (corners > 1) {
            const int i = corner[corners - 2], j = corner[corners - 1];
            if ((height[j] - height[i]) * (k - i) > (height[k] - height[i]) * (j - i)) break;
            corners--;
        }
        corner[corners++] = k;
    }
    for (int part = 0; part + 1 < corners; part++) {
        const int i = corner[part], j = corner[part + 1];
        const double radius = height[i] <= -1e300 ? 0.0 : exp((height[i] - height[j]) / (j - i));
        for (int k = i; k < j; k++) {
            const double angle = 2 * PI * (k - i) / (j - i) + 2 * PI * i / n + 0.7;
            re[k] = radius * cos(angle), im[k] = radius * sin(angle);
        }
    }
    int done[MOST_DEGREE] = {0};
    for (int step = 0; step < 200; step++) {
        int moving = 0;
        for (int k = 0; k < n; k++) {
            if (done[k]) continue;
            double x = re[k], y = im[k], far = hypot(x, y), scale = 1;
            double pr = 1, pi = 0, sr = 0, si = 0; /* value and slope at x + iy */
            for (int j = n - 1; j >= 0; j--) {
                scale = scale * far + fabs(c[j]);
                double nr = sr * x - si * y + pr, ni = sr * y + si * x + pi;
                sr = nr, si = ni;
                nr = pr * x - pi * y + c[j], ni = pr * y + pi * x;
                pr = nr, pi = ni;
            }
            double size = pr * pr + pi * pi;
            if (fabs(pr) + fabs(pi) <= 1e-16 * scale) { done[k] = 1; continue; } /* rounding */ /* Newton's ratio, inverted: P'/P */
            double qr = (sr * pr + si * pi) / size, qi = (si * pr - sr * pi) / size;
            for (int j = 0; j < n; j++) {
                if (j == k) continue;
                double dx = x - re[j], dy = y - im[j], d2 = dx * dx + dy * dy;
                if (d2 > 0) qr -= dx / d2, qi += dy / d2;
            }
            size = qr * qr + qi * qi;
            double mx = qr / size, my = -qi / size;
            if (!(isfinite(mx) && isfinite(my))) continue;
            re[k] = x - mx, im[k] = y - my;
            if (mx * mx + my * my <= 1e-32 * (x * x + y * y)) done[k] = 1;
            else moving = 1;
        }
        if (!moving) break;
    }
    for (int k = 0; k < n; k++) {
        double x = re[k];
        if (fabs(im[k]) > 1e-12 * hypot(x, im[k])) continue;
        im[k] = 0.0;
        for (int step = 0; step < 3; step++) {
            double p = 1, s = 0;
            for (int j = n - 1; j >= 0; j--) s = s * x + p, p = p * x + c[j];
            double next = x - p / s;
            if (!isfinite(next) || fabs(next - x) > 1e-9 * fabs(x)) break;
            x = next;
        }
        re[k] = x;
    }
}

/* All roots of a polynomial of degree n, lowest power first: NaN if a coefficient is not finite,
   a root at minus infinity if the leading one is zero. */
static void roots(const double *p, int n, double *re, double *im) {
    double lead = p[n], monic[MOST_DEGREE];
    int finite = 1, known = 1;
    double size = pow(fabs(p[0] / lead), 1.0 / n);
    if (!(isfinite(size) && size > 0)) size = 1.0;
    for (int k = 0; k <= n; k++) known &= isfinite(p[k]) != 0;
    if (known && lead == 0) {
        re[0] = -INFINITY, im[0] = 0.0;
        if (n > 1) roots(p, n - 1, re + 1, im + 1);
        return;
    }
    for (int k = 0; k < n; k++) {
        monic[k] = p[k] / lead * pow(size, (double)(k - n));
        finite &= isfinite(monic[k]) != 0;
    }
    if (!finite) {
        for (int k = 0; k < n; k++) re[k] = im[k] = NAN;
        return;
    }
    if (n == 1) re[0] = -monic[0], im[0] = 0.0;
    else if (n == 3) cubic(monic[2], monic[1], monic[0], re, im);
    else together(monic, n, re, im);
    for (int k = 0; k < n; k++) re[k] *= size, im[k] *= size;
}

/* ---- values ---- */

#define EACH for (int l = 0; l < L; l++)
#define VALUE(expression) { EACH { const double a = A[l]; R[l] = (expression); } break; }
#define VALUES(expression) \
    { EACH { const double a = A[l], b = B[l]; R[l] = (expression); } break; }

static double sign_of(double a) { return a != a ? a : (a > 0) - (a < 0); }

/* Compute the values of an instruction's result in L lanes. */
INLINE void value_of(const uint16_t *at, const int32_t *extra, double *V, const int L) {
    double *R = V + (size_t)at[1] * L;
    const double *A = V + (size_t)at[2] * L, *B = V + (size_t)at[3] * L;
    switch (OPERATION(at)) {
        case OP_add: VALUES(a + b)
        case OP_sub: VALUES(a - b)
        case OP_mul: VALUES(a * b)
        case OP_div: VALUES(a / b)
        case OP_neg: VALUE(-a)
        case OP_sqrt: VALUE(sqrt(a))
        case OP_exp: VALUE(exp(a))
        case OP_expm1: VALUE(expm1(a))
        case OP_log: VALUE(log(a))
        case OP_log1p: VALUE(log1p(a))
        case OP_pow: VALUES(pow(a, b))
        case OP_sin: VALUE(sin(a))
        case OP_cos: VALUE(cos(a))
        case OP_tan: VALUE(tan(a))
        case OP_tanh: VALUE(tanh(a))
        case OP_sinh: VALUE(sinh(a))
        case OP_cosh: VALUE(cosh(a))
        case OP_arctan: VALUE(atan(a))
        case OP_arcsin: VALUE(asin(a))
        case OP_arccos: VALUE(acos(a))
        case OP_atan2: VALUES(atan2(a, b))
        case OP_abs: VALUE(fabs(a))
        case OP_sign: VALUE(sign_of(a))
        case OP_floor: VALUE(floor(a))
        case OP_cbrt: VALUE(cbrt(a))
        case OP_copysign: VALUES(copysign(a, b))
        case OP_hypot: VALUES(hypot(a, b))
        case OP_lt: VALUES(a < b)
        case OP_le: VALUES(a <= b)
        case OP_eq: VALUES(a == b)
        case OP_and: VALUES((a != 0) & (b != 0))
        case OP_or: VALUES((a != 0) | (b != 0))
        case OP_not: VALUE(a == 0)
        case OP_isnan: VALUE(a != a)
        case OP_where: {
            const double *C = V + (size_t)at[4] * L;
            EACH { const double b = B[l], c = C[l]; R[l] = A[l] != 0 ? b : c; }
            break;
        }
        case OP_roots: { /* operands: place of the coefficients' slots in `extra`, and the degree */
            const int n = at[3];
            double p[MOST_DEGREE + 1], re[MOST_DEGREE], im[MOST_DEGREE];
            EACH {
                for (int k = 0; k <= n; k++) p[k] = V[(size_t)extra[at[2] + k] * L + l];
                roots(p, n, re, im);
                for (int k = 0; k < n; k++) {
                    R[(size_t)k * L + l] = re[k];
                    R[(size_t)(n + k) * L + l] = im[k];
                }
            }
            break;
        }
    }
}

FAST static void run_single(
    const uint16_t *code, Py_ssize_t count, const int32_t *extra, double *V
) {
    for (Py_ssize_t k = 0; k < count; k++) value_of(code + WORDS * k, extra, V, 1);
}

FAST static void run_lanes(
    const uint16_t *code, Py_ssize_t count, const int32_t *extra, double *V
) {
    for (Py_ssize_t k = 0; k < count; k++) value_of(code + WORDS * k, extra, V, LANES);
}

/* ---- derivatives ---- */

#define ALONG for (int t = 0; t < T; t++)

/* r' = f a' */
INLINE void scaled(double *R, const double *A, double f, const int T) { ALONG R[t] = f * A[t]; }

/* r' = f a' + g b', where an operand without derivatives counts as constant */
INLINE void combined(
    double *R, const double *A, const double *B, double f, double g, int flags, const int T
) {
    if ((flags & (FIRST | SECOND)) == (FIRST | SECOND)) ALONG R[t] = f * A[t] + g * B[t];
    else if (flags & FIRST) scaled(R, A, f, T);
    else scaled(R, B, g, T);
}

/* Compute the value and derivatives of every instruction's result, along T directions. */
INLINE void dual(
    const uint16_t *code, Py_ssize_t count, const int32_t *extra, double *V, double *D, const int T
) {
    for (Py_ssize_t k = 0; k < count; k++) {
        const uint16_t *at = code + WORDS * k;
        const int flags = FLAGS(at);
        if (!(flags & RESULT)) {
            value_of(at, extra, V, 1);
            continue;
        }
        const double a = V[at[2]], b = V[at[3]];
        double *R = D + (size_t)at[1] * T;
        const double *A = D + (size_t)at[2] * T, *B = D + (size_t)at[3] * T;
        switch (OPERATION(at)) { /* the most frequent operations first, in one step */
            case OP_mul:
                V[at[1]] = a * b;
                combined(R, A, B, b, a, flags, T);
                continue;
            case OP_add:
                V[at[1]] = a + b;
                combined(R, A, B, 1.0, 1.0, flags, T);
                continue;
            case OP_sub:
                V[at[1]] = a - b;
                combined(R, A, B, 1.0, -1.0, flags, T);
                continue;
            case OP_div: {
                const double r = a / b;
                V[at[1]] = r;
                combined(R, A, B, 1.0 / b, -r / b, flags, T);
                continue;
            }
            case OP_where: {
                const int chosen = a != 0 ? at[3] : at[4];
                V[at[1]] = V[chosen];
                if (flags & (a != 0 ? SECOND : THIRD)) {
                    const double *C = D + (size_t)chosen * T;
                    ALONG R[t] = C[t];
                } else ALONG R[t] = 0.0;
                continue;
            }
            default: break;
        }
        value_of(at, extra, V, 1);
        const double r = V[at[1]];
        switch (OPERATION(at)) {
            case OP_pow:
                combined(R, A, B, b * pow(a, b - 1.0), flags & SECOND ? r * log(a) : 0.0, flags, T);
                break;
            case OP_atan2: {
                const double size = a * a + b * b;
                combined(R, A, B, b / size, -a / size, flags, T);
                break;
            }
            case OP_copysign: scaled(R, A, signbit(a) == signbit(b) ? 1.0 : -1.0, T); break;
            case OP_hypot: combined(R, A, B, a / r, b / r, flags, T); break;
            case OP_neg: scaled(R, A, -1.0, T); break;
            case OP_sqrt: scaled(R, A, 0.5 / r, T); break;
            case OP_exp: scaled(R, A, r, T); break;
            case OP_expm1: scaled(R, A, exp(a), T); break;
            case OP_log: scaled(R, A, 1.0 / a, T); break;
            case OP_log1p: scaled(R, A, 1.0 / (1.0 + a), T); break;
            case OP_sin: scaled(R, A, cos(a), T); break;
            case OP_cos: scaled(R, A, -sin(a), T); break;
            case OP_tan: scaled(R, A, 1.0 + r * r, T); break;
            case OP_tanh: scaled(R, A, 1.0 - r * r, T); break;
            case OP_sinh: scaled(R, A, cosh(a), T); break;
            case OP_cosh: scaled(R, A, sinh(a), T); break;
            case OP_arctan: scaled(R, A, 1.0 / (1.0 + a * a), T); break;
            case OP_arcsin: scaled(R, A, 1.0 / sqrt(1.0 - a * a), T); break;
            case OP_arccos: scaled(R, A, -1.0 / sqrt(1.0 - a * a), T); break;
            case OP_abs: scaled(R, A, sign_of(a), T); break;
            case OP_cbrt: scaled(R, A, 1.0 / (3.0 * r * r), T); break;
            default: ALONG R[t] = 0.0; /* steps: their slope is zero */
        }
    }
}

FAST static void run_dual_4(
    const uint16_t *code, Py_ssize_t count, const int32_t *extra, double *V, double *D
) { dual(code, count, extra, V, D, 4); }
FAST static void run_dual_8(
    const uint16_t *code, Py_ssize_t count, const int32_t *extra, double *V, double *D
) { dual(code, count, extra, V, D, 8); }
FAST static void run_dual_16(
    const uint16_t *code, Py_ssize_t count, const int32_t *extra, double *V, double *D
) { dual(code, count, extra, V, D, 16); }

/* ---- a program from Python ---- */

typedef struct {
    const uint16_t *code;
    const int32_t *extra, *outputs;
    const double *constants;
    Py_ssize_t count, extras, results, constant_count, slots, inputs;
} Program;

/* Refuse a program that reads or writes outside its slots; it may come from a file. */
static int refused(const Program *p) {
    const Py_ssize_t all = p->slots + p->constant_count;
    for (Py_ssize_t k = 0; k < p->count; k++) {
        const uint16_t *at = p->code + WORDS * k;
        if (OPERATION(at) >= OPERATION_COUNT || at[1] >= p->slots) return 1;
        if (OPERATION(at) == OP_roots) {
            const int n = at[3];
            if (n < 1 || n > MOST_DEGREE || at[2] + n >= p->extras) return 1;
            if ((Py_ssize_t)at[1] + 2 * n > p->slots || (FLAGS(at) & RESULT)) return 1;
            for (int j = 0; j <= n; j++)
                if (p->extra[at[2] + j] < 0 || p->extra[at[2] + j] >= all) return 1;
            continue;
        }
        for (int j = 2; j < WORDS; j++) {
            if (at[j] >= all) return 1;
            if ((FLAGS(at) & (1 << (j - 2))) && at[j] >= p->slots) return 1;
        }
    }
    for (Py_ssize_t k = 0; k < p->results; k++)
        if (p->outputs[k] < 0 || p->outputs[k] >= all) return 1;
    return p->inputs > p->slots;
}

static void constants_to(const Program *p, double *V, int L) {
    for (Py_ssize_t k = 0; k < p->constant_count; k++)
        for (int l = 0; l < L; l++) V[(p->slots + k) * L + l] = p->constants[k];
}

/* values: (points, inputs); results: (points, outputs) */
static int run_values(const Program *p, const double *values, Py_ssize_t points, double *results) {
    const Py_ssize_t L = points < 4 ? 1 : LANES; /* a few points: one by one */
    double *V = calloc(L * (p->slots + p->constant_count), sizeof(double));
    if (V == NULL) return -1;
    constants_to(p, V, (int)L);
    for (Py_ssize_t first = 0; first < points; first += L) {
        const Py_ssize_t wide = points - first < L ? points - first : L;
        for (Py_ssize_t k = 0; k < p->inputs; k++)
            for (Py_ssize_t l = 0; l < L; l++)
                V[k * L + l] = values[(first + (l < wide ? l : 0)) * p->inputs + k];
        (L == 1 ? run_single : run_lanes)(p->code, p->count, p->extra, V);
        for (Py_ssize_t l = 0; l < wide; l++)
            for (Py_ssize_t k = 0; k < p->results; k++)
                results[(first + l) * p->results + k] = V[(Py_ssize_t)p->outputs[k] * L + l];
    }
    free(V);
    return 0;
}

static int is_step(int operation) {
    switch (operation) {
        case OP_lt: case OP_le: case OP_eq: case OP_and: case OP_or: case OP_not: case OP_isnan:
        case OP_sign: case OP_floor: case OP_roots: return 1;
        default: return 0;
    }
}

/* Set the flags of every instruction for the slots that have derivatives at the start; afterwards
   `active` is that of the end. Slots are used again, so the order matters. */
static void follow(const Program *p, uint16_t *code, uint8_t *active) {
    for (Py_ssize_t k = 0; k < p->count; k++) {
        uint16_t *at = code + WORDS * k;
        int flags = FLAGS(at) & ~(FIRST | SECOND | THIRD | RESULT);
        if (OPERATION(at) == OP_roots) {
            for (int j = 0; j < 2 * at[3]; j++) active[at[1] + j] = 0;
        } else {
            for (int j = 0; j < 3; j++)
                if (at[2 + j] < p->slots && active[at[2 + j]] && !(flags & (FROZEN << j)))
                    flags |= 1 << j;
            if ((flags & (FIRST | SECOND | THIRD)) && !is_step(OPERATION(at))) flags |= RESULT;
            active[at[1]] = (flags & RESULT) != 0;
        }
        at[0] = (uint16_t)(OPERATION(at) | flags << 8);
    }
}

/* values: (points, inputs); seeds: (points, inputs, T); results: (points, outputs, 1 + T) */
static int run_slopes(
    const Program *p, const double *values, const double *seeds, Py_ssize_t points, int T,
    const int32_t *varies, double *results
) {
    double *V = calloc(p->slots + p->constant_count, sizeof(double));
    double *D = calloc(p->slots * T, sizeof(double));
    if (V == NULL || D == NULL) return free(V), free(D), -1;
    constants_to(p, V, 1);
    for (Py_ssize_t at = 0; at < points; at++) {
        memcpy(V, values + at * p->inputs, sizeof(double) * p->inputs);
        memcpy(D, seeds + at * p->inputs * T, sizeof(double) * p->inputs * T);
        (T == 4 ? run_dual_4 : T == 8 ? run_dual_8 : run_dual_16)(
            p->code, p->count, p->extra, V, D);
        for (Py_ssize_t k = 0; k < p->results; k++) {
            double *row = results + (at * p->results + k) * (1 + T);
            const int32_t slot = p->outputs[k];
            row[0] = V[slot];
            if (varies[k]) memcpy(row + 1, D + (size_t)slot * T, sizeof(double) * T);
            else memset(row + 1, 0, sizeof(double) * T);
        }
    }
    free(V), free(D);
    return 0;
}

static int sized(Py_buffer *view, Py_ssize_t item, Py_ssize_t *count) {
    *count = view->len / item;
    return view->len % item == 0 && ((uintptr_t)view->buf) % item == 0;
}

PyDoc_STRVAR(run_doc,
    "run(code, extra, outputs, varies, constants, slots, inputs, values, seeds, width, results)\n\n"
    "Run a program for points (points, inputs). Without seeds, `results` is (points, outputs).\n"
    "With seeds (points, inputs, width), it is (points, outputs, 1 + width); width is 4, 8 or 16.");

static PyObject *run(PyObject *self, PyObject *args) {
    Py_buffer view[8];
    int width;
    Program p;
    Py_ssize_t size[8], points = 0;
    static const Py_ssize_t item[8] = {2, 4, 4, 4, 8, 8, 8, 8};
    (void)self;
    memset(view, 0, sizeof view);
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*nny*y*iw*", &view[0], &view[1], &view[2], &view[3],
                          &view[4], &p.slots, &p.inputs, &view[5], &view[6], &width, &view[7]))
        return NULL;
    int valid = 1, failed = 0;
    for (int k = 0; k < 8; k++) valid &= sized(&view[k], item[k], &size[k]);
    p.code = view[0].buf, p.extra = view[1].buf, p.outputs = view[2].buf;
    p.constants = view[4].buf;
    p.count = size[0] / WORDS, p.extras = size[1], p.results = size[2];
    p.constant_count = size[4];
    valid = valid && size[0] % WORDS == 0 && size[3] == size[2] && p.slots >= 0
         && p.slots <= 65536 && p.inputs > 0 && size[5] % p.inputs == 0 && !refused(&p);
    if (valid) {
        points = size[5] / p.inputs;
        const int32_t *varies = view[3].buf;
        if (width == 0) valid = size[7] == points * p.results;
        else valid = (width == 4 || width == 8 || width == 16)
                  && size[6] == points * p.inputs * width
                  && size[7] == points * p.results * (1 + width);
        for (Py_ssize_t k = 0; k < p.results; k++)
            if (varies[k] && p.outputs[k] >= p.slots) valid = 0;
    }
    if (valid) {
        Py_BEGIN_ALLOW_THREADS
        failed = width == 0
            ? run_values(&p, view[5].buf, points, view[7].buf)
            : run_slopes(&p, view[5].buf, view[6].buf, points, width, view[3].buf, view[7].buf);
        Py_END_ALLOW_THREADS
    }
    for (int k = 0; k < 8; k++) PyBuffer_Release(&view[k]);
    if (!valid) return PyErr_SetString(PyExc_ValueError, "not a valid program"), NULL;
    if (failed) return PyErr_NoMemory();
    Py_RETURN_NONE;
}

PyDoc_STRVAR(follow_doc,
    "follow(code, active, slots)\n\n"
    "Set the flags of the instructions in place, for the slots that have derivatives at the start\n"
    "(slots bytes, 0 or 1); these become the slots that have derivatives at the end.");

static PyObject *follow_slots(PyObject *self, PyObject *args) {
    Py_buffer view[2];
    Program p = {0};
    (void)self;
    if (!PyArg_ParseTuple(args, "w*w*n", &view[0], &view[1], &p.slots)) return NULL;
    p.code = view[0].buf, p.count = view[0].len / 2 / WORDS;
    int valid = view[0].len % (2 * WORDS) == 0 && ((uintptr_t)view[0].buf) % 2 == 0
             && view[1].len == p.slots;
    for (Py_ssize_t k = 0; valid && k < p.count; k++) {
        const uint16_t *at = p.code + WORDS * k;
        if (at[1] >= p.slots) valid = 0;
        else if (OPERATION(at) == OP_roots)
            valid = at[3] > 0 && at[3] <= MOST_DEGREE && (Py_ssize_t)at[1] + 2 * at[3] <= p.slots;
    }
    if (valid) follow(&p, view[0].buf, view[1].buf);
    PyBuffer_Release(&view[0]), PyBuffer_Release(&view[1]);
    if (!valid) return PyErr_SetString(PyExc_ValueError, "not a valid program"), NULL;
    Py_RETURN_NONE;
}

/* ---- a program that is called again and again, as an integrator does ---- */

typedef struct {
    PyObject_HEAD
    PyObject *returned;       /* array of the results, which every call overwrites */
    Py_buffer view[8];
    Program p;
    double *V, *D, *point, *results;
    const int32_t *varies, *columns;
    Py_ssize_t states, width; /* inputs 1 to `states` are given in a call; columns of derivatives */
    int slopes;               /* whether the results are derivatives */
} Prepared;

/* Columns of derivatives, up to 16 at a time: one direction for each input that has derivatives. */
static void prepared_slopes(Prepared *own) {
    const Program *p = &own->p;
    for (Py_ssize_t first = 0; first < own->width; first += 16) {
        const Py_ssize_t left = own->width - first, used = left < 16 ? left : 16;
        const int T = used <= 4 ? 4 : used <= 8 ? 8 : 16;
        memset(own->D, 0, sizeof(double) * p->inputs * T);
        for (Py_ssize_t t = 0; t < used; t++) own->D[own->columns[first + t] * T + t] = 1.0;
        (T == 4 ? run_dual_4 : T == 8 ? run_dual_8 : run_dual_16)(
            p->code, p->count, p->extra, own->V, own->D);
        for (Py_ssize_t k = 0; k < p->results; k++) {
            if (!own->varies[k]) continue;
            const double *row = own->D + (size_t)p->outputs[k] * T;
            for (Py_ssize_t t = 0; t < used; t++)
                own->results[k * own->states + own->columns[first + t] - 1] = row[t];
        }
    }
}

static PyObject *prepared_call(PyObject *self, PyObject *args, PyObject *names) {
    Prepared *own = (Prepared *)self;
    const Program *p = &own->p;
    PyObject *states;
    Py_buffer y;
    (void)names;
    if (!PyArg_ParseTuple(args, "dO", own->point, &states)) return NULL;
    if (PyObject_GetBuffer(states, &y, PyBUF_RECORDS_RO) < 0) return NULL;
    const int valid = y.ndim == 1 && y.shape[0] == own->states
                   && y.format != NULL && strcmp(y.format, "d") == 0;
    for (Py_ssize_t k = 0; valid && k < own->states; k++)
        memcpy(own->point + 1 + k, (const char *)y.buf + k * y.strides[0], sizeof(double));
    PyBuffer_Release(&y);
    if (!valid) return PyErr_SetString(PyExc_ValueError, "not the states of the program"), NULL;
    memcpy(own->V, own->point, sizeof(double) * p->inputs);
    if (own->slopes) prepared_slopes(own);
    else {
        run_single(p->code, p->count, p->extra, own->V);
        for (Py_ssize_t k = 0; k < p->results; k++) own->results[k] = own->V[p->outputs[k]];
    }
    double rest = 0.0; /* becomes NaN if any result is not finite */
    for (Py_ssize_t k = own->view[7].len / (Py_ssize_t)sizeof(double) - 1; k >= 0; k--)
        rest += 0.0 * own->results[k];
    if (rest != 0.0)
        return PyErr_SetString(PyExc_FloatingPointError, "a value is not finite"), NULL;
    return Py_NewRef(own->returned);
}

static void prepared_end(PyObject *self) {
    Prepared *own = (Prepared *)self;
    PyTypeObject *type = Py_TYPE(self);
    for (int k = 0; k < 8; k++) PyBuffer_Release(&own->view[k]);
    Py_XDECREF(own->returned);
    free(own->V), free(own->D);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

static PyType_Slot PREPARED_SLOTS[] = {
    {Py_tp_call, prepared_call}, {Py_tp_dealloc, prepared_end}, {0, NULL}};
static PyType_Spec PREPARED_SPEC = {
    "_machine.Prepared", sizeof(Prepared), 0,
    Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, PREPARED_SLOTS};
static PyObject *prepared_type = NULL;

PyDoc_STRVAR(prepare_doc,
    "prepare(code, extra, outputs, varies, constants, slots, inputs, states, columns, point,\n"
    "        results, slopes)\n\n"
    "Function of time and states (states,), the first inputs. `point` (inputs,) holds the others\n"
    "and, after a call, the time and states of that call. The function returns `results`, which\n"
    "every call overwrites: the outputs (outputs,), or with slopes their derivatives by the states\n"
    "of some columns, which are numbers of inputs: (outputs, states), elsewhere as it was.");

static PyObject *prepare(PyObject *self, PyObject *args) {
    static const Py_ssize_t item[8] = {2, 4, 4, 4, 8, 4, 8, 8};
    Py_ssize_t size[8];
    PyObject *returned;
    Prepared *own = (Prepared *)PyType_GenericAlloc((PyTypeObject *)prepared_type, 0);
    (void)self;
    if (own == NULL) return NULL;
    Program *p = &own->p;
    Py_buffer *view = own->view;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*nnny*w*Oi", &view[0], &view[1], &view[2], &view[3],
                          &view[4], &p->slots, &p->inputs, &own->states, &view[5], &view[6],
                          &returned, &own->slopes)
        || PyObject_GetBuffer(returned, &view[7], PyBUF_CONTIG) < 0)
        return Py_DECREF(own), NULL;
    own->returned = Py_NewRef(returned);
    int valid = 1;
    for (int k = 0; k < 8; k++) valid &= sized(&view[k], item[k], &size[k]);
    p->code = view[0].buf, p->extra = view[1].buf, p->outputs = view[2].buf;
    own->varies = view[3].buf, p->constants = view[4].buf, own->columns = view[5].buf;
    own->point = view[6].buf, own->results = view[7].buf;
    p->count = size[0] / WORDS, p->extras = size[1], p->results = size[2];
    p->constant_count = size[4], own->width = size[5];
    valid = valid && size[0] % WORDS == 0 && size[3] == size[2] && p->slots >= 0
         && p->slots <= 65536 && own->states >= 0 && own->states < p->inputs
         && size[6] == p->inputs && size[7] == p->results * (own->slopes ? own->states : 1)
         && !refused(p);
    for (Py_ssize_t k = 0; valid && k < own->width; k++)
        valid = own->columns[k] > 0 && own->columns[k] <= own->states;
    for (Py_ssize_t k = 0; valid && k < p->results; k++)
        valid = !own->varies[k] || p->outputs[k] < p->slots;
    if (!valid) {
        Py_DECREF(own);
        return PyErr_SetString(PyExc_ValueError, "not a valid program"), NULL;
    }
    own->V = calloc(p->slots + p->constant_count, sizeof(double));
    own->D = calloc(own->width ? p->slots * 16 : 1, sizeof(double));
    if (own->V == NULL || own->D == NULL) {
        Py_DECREF(own);
        return PyErr_NoMemory();
    }
    constants_to(p, own->V, 1);
    return (PyObject *)own;
}

static PyMethodDef METHODS[] = {
    {"run", run, METH_VARARGS, run_doc},
    {"follow", follow_slots, METH_VARARGS, follow_doc},
    {"prepare", prepare, METH_VARARGS, prepare_doc},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef MODULE = {
    PyModuleDef_HEAD_INIT, "_machine", "Machine for recorded models.", -1, METHODS,
    NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__machine(void) {
    PyObject *module = PyModule_Create(&MODULE), *names = PyTuple_New(OPERATION_COUNT);
    if (module == NULL || names == NULL) return NULL;
    for (int k = 0; k < OPERATION_COUNT; k++)
        PyTuple_SetItem(names, k, PyUnicode_FromString(NAMES[k]));
    if (PyModule_AddObjectRef(module, "OPERATIONS", names) < 0) return NULL;
    Py_DECREF(names);
    prepared_type = PyType_FromSpec(&PREPARED_SPEC);
    return prepared_type == NULL ? NULL : module;
}
