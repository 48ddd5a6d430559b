/* A machine for recorded models: values of designs, with derivatives along several directions.

   A program is a list of instructions on numbered slots. Every slot holds a value for each of
   several designs side by side ("lanes"), or the value of a single design with its derivatives
   along several directions ("dual"). All numbers are doubles; a truth value is 0 or 1. NaN and
   infinity follow IEEE 754, as in NumPy.

   C99, C++ and CUDA, without allocation and without variables that outlive a call.
*/
#if defined(__CUDACC_RTC__) /* the compiler of CUDA at run time has no headers */
#define uint16_t unsigned short
#define int32_t int
#define ptrdiff_t long long
#define size_t unsigned long long
#define INFINITY __longlong_as_double(0x7ff0000000000000LL)
#define NAN __longlong_as_double(0x7ff8000000000000LL)
#define FUNCTION static __device__
#define INLINE static __device__ __forceinline__
#else
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#define FUNCTION static
#if defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif
#endif

/* Operations with their results, computed from operands a, b and c. */
#define OPERATIONS(X) \
    X(add, a + b) X(sub, a - b) X(mul, a * b) X(div, a / b) X(neg, -a) X(sqrt, sqrt(a)) \
    X(exp, exp(a)) X(expm1, expm1(a)) X(log, log(a)) X(log1p, log1p(a)) X(pow, pow(a, b)) \
    X(sin, sin(a)) X(cos, cos(a)) X(tan, tan(a)) X(tanh, tanh(a)) X(sinh, sinh(a)) \
    X(cosh, cosh(a)) X(arctan, atan(a)) X(arcsin, asin(a)) X(arccos, acos(a)) \
    X(atan2, atan2(a, b)) X(abs, fabs(a)) X(sign, sign_of(a)) X(floor, floor(a)) \
    X(cbrt, cbrt(a)) X(copysign, copysign(a, b)) X(hypot, hypot(a, b)) X(lt, a < b) \
    X(le, a <= b) X(eq, a == b) X(and, (a != 0) & (b != 0)) X(or, (a != 0) | (b != 0)) \
    X(not, a == 0) X(isnan, a != a) X(where, a != 0 ? b : c)
#define ENUM(name, result) OP_##name,
/* After them, all roots of a polynomial, which are several results. */
enum { OPERATIONS(ENUM) OP_roots, OPERATION_COUNT };

/* An instruction is five short words: operation and flags, result, and up to three operands. */
enum { WORDS = 5, MOST_DEGREE = 32 };
/* Flags: which operands, and whether the result, have derivatives; operands without them. */
#define OPERATION(at) ((at)[0] & 255)
#define FLAGS(at) ((at)[0] >> 8)
enum { FIRST = 1, SECOND = 2, THIRD = 4, RESULT = 8, FROZEN = 16 };

typedef struct {
    const uint16_t *code;
    const int32_t *extra, *outputs;
    const double *constants;
    ptrdiff_t count, extras, results, constant_count, slots, inputs;
} Program;

/* Write the constants of a program to their slots, after those of the instructions. */
INLINE void constants_to(const Program *p, double *V, const int L) {
    for (ptrdiff_t k = 0; k < p->constant_count; k++)
        for (int l = 0; l < L; l++) V[(p->slots + k) * L + l] = p->constants[k];
}

/* ---- roots of a real polynomial ---- */

static const double BEYOND = 1.324718; /* root of x^3 = x + 1: a start beyond the outer root */
static const double PI = 3.14159265358979323846;
static const double SHY = 1 + 1e-15;   /* keeps rounding from carrying a step past the root */

/* Roots of x^3 + b x^2 + c x + d, the real root first [Kahan1986]. */
FUNCTION void cubic(double b, double c, double d, double *re, double *im) {
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
FUNCTION void together(const double *c, int n, double *re, double *im) {
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
            if (fabs(pr) + fabs(pi) <= 1e-16 * scale) { /* rounding */
                done[k] = 1;
                continue;
            }
            /* Newton's ratio, inverted: P'/P */
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
FUNCTION void roots(const double *p, int n, double *re, double *im) {
    double monic[MOST_DEGREE];
    int finite = 1, known = 1;
    for (int k = 0; k <= n; k++) known &= isfinite(p[k]) != 0;
    for (; known && n > 0 && p[n] == 0; n--) *re++ = -INFINITY, *im++ = 0.0;
    if (n == 0) return;
    const double lead = p[n];
    double size = pow(fabs(p[0] / lead), 1.0 / n);
    if (!(isfinite(size) && size > 0)) size = 1.0;
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

FUNCTION double sign_of(double a) { return a != a ? a : (a > 0) - (a < 0); }

/* The roots of an instruction, for one design whose slots are `stride` numbers apart; operands:
   place of the coefficients' slots in `extra`, and the degree. */
FUNCTION void roots_of(const uint16_t *at, const double *p, double *R, size_t stride) {
    const int n = at[3];
    double re[MOST_DEGREE], im[MOST_DEGREE];
    roots(p, n, re, im);
    for (int k = 0; k < n; k++) R[k * stride] = re[k], R[(n + k) * stride] = im[k];
}

#define VALUES(name, result) \
    case OP_##name: \
        for (int l = 0; l < L; l++) { \
            const double a = A[l], b = B[l], c = C[l]; \
            (void)b, (void)c, R[l] = (result); \
        } \
        break;

/* Compute the values of an instruction's result in L lanes. */
INLINE void value_of(const uint16_t *at, const int32_t *extra, double *V, const int L) {
    double *R = V + (size_t)at[1] * L, p[MOST_DEGREE + 1];
    const double *A = V + (size_t)at[2] * L, *B = V + (size_t)at[3] * L, *C = V + (size_t)at[4] * L;
    switch (OPERATION(at)) {
        OPERATIONS(VALUES)
        case OP_roots:
            for (int l = 0; l < L; l++) {
                for (int k = 0; k <= at[3]; k++) p[k] = V[(size_t)extra[at[2] + k] * L + l];
                roots_of(at, p, R + l, L);
            }
            break;
    }
}

/* ---- derivatives ---- */

/* Numbers that are handled together: with VECTORS, of compilers that have them, four lanes or four
   directions; otherwise one. */
#if defined(VECTORS)
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long Mask __attribute__((vector_size(32)));
enum { FOUR = 4 };
#define AT(x, l) ((x)[l])
INLINE Four same(double x) { return (Four){x, x, x, x}; }
INLINE Four chosen(Four a, Four b, Four c) {
    const Mask yes = a != same(0.0);
    return (Four)(((Mask)b & yes) | ((Mask)c & ~yes));
}
#else
typedef double Four;
enum { FOUR = 1 };
#define AT(x, l) (x)
INLINE Four same(double x) { return x; }
INLINE Four chosen(Four a, Four b, Four c) { return a != 0 ? b : c; }
#endif

/* Values of a slot in L lanes, FOUR or 1. */
INLINE Four read_values(const double *V, const int L) {
    return L == 1 ? same(V[0]) : *(const Four *)V;
}
INLINE void write_values(double *V, Four x, const int L) {
    if (L == 1) V[0] = AT(x, 0);
    else *(Four *)V = x;
}

#define ALONG for (int k = 0; k < T * L / FOUR; k++)

/* r' = f a' + g b', where an operand without derivatives counts as constant */
INLINE void combined(
    Four *R, const Four *A, const Four *B, Four f, Four g, int flags, const int T, const int L
) {
    if ((flags & (FIRST | SECOND)) == (FIRST | SECOND)) ALONG R[k] = f * A[k] + g * B[k];
    else if (flags & FIRST) ALONG R[k] = f * A[k];
    else ALONG R[k] = g * B[k];
}

#define SLOPES(name, first, second) \
    case OP_##name: \
        for (int l = 0; l < (L < FOUR ? L : FOUR); l++) { \
            const double a = AT(p, l), b = AT(q, l), r = V[at[1] * (size_t)L + l]; \
            (void)a, (void)b, (void)r; \
            AT(f, l) = (first), AT(g, l) = (second); \
        } \
        break;
#define SLOPE(name, first) SLOPES(name, first, 0.0)

/* Compute the value and derivatives of every instruction's result, along T directions in L lanes:
   L is 1 or FOUR, T a multiple of FOUR. */
INLINE void dual(
    const uint16_t *code, ptrdiff_t count, const int32_t *extra, double *V, double *D,
    const int T, const int L
) {
    const size_t size = (size_t)T * L;
    for (ptrdiff_t n = 0; n < count; n++) {
        const uint16_t *at = code + WORDS * n;
        const int flags = FLAGS(at), operation = OPERATION(at);
        if (!(flags & RESULT)) {
            value_of(at, extra, V, L);
            continue;
        }
        double *r = V + (size_t)at[1] * L;
        const Four p = read_values(V + (size_t)at[2] * L, L);
        const Four q = read_values(V + (size_t)at[3] * L, L);
        Four *R = (Four *)(D + at[1] * size), f = same(1.0), g = f;
        const Four *A = (const Four *)(D + at[2] * size), *B = (const Four *)(D + at[3] * size);
        switch (operation) { /* the most frequent operations first, in one step */
            case OP_mul:
                write_values(r, p * q, L);
                combined(R, A, B, q, p, flags, T, L);
                continue;
            case OP_add:
                write_values(r, p + q, L);
                combined(R, A, B, f, g, flags, T, L);
                continue;
            case OP_sub:
                write_values(r, p - q, L);
                combined(R, A, B, f, -g, flags, T, L);
                continue;
            case OP_div: {
                const Four ratio = p / q;
                write_values(r, ratio, L);
                combined(R, A, B, f / q, -ratio / q, flags, T, L);
                continue;
            }
            case OP_where: {
                const Four *C = (const Four *)(D + at[4] * size), zero = same(0.0);
                write_values(r, chosen(p, q, read_values(V + (size_t)at[4] * L, L)), L);
                if ((flags & SECOND) && (flags & THIRD)) ALONG R[k] = chosen(p, B[k], C[k]);
                else if (flags & SECOND) ALONG R[k] = chosen(p, B[k], zero);
                else ALONG R[k] = chosen(p, zero, C[k]);
                continue;
            }
            default: break;
        }
        value_of(at, extra, V, L);
        switch (operation) {
            SLOPES(pow, b * pow(a, b - 1.0), flags & SECOND ? r * log(a) : 0.0)
            SLOPES(atan2, b / (a * a + b * b), -a / (a * a + b * b))
            SLOPES(hypot, a / r, b / r)
            SLOPE(copysign, signbit(a) == signbit(b) ? 1.0 : -1.0)
            SLOPE(neg, -1.0)
            SLOPE(sqrt, 0.5 / r)
            SLOPE(exp, r)
            SLOPE(expm1, exp(a))
            SLOPE(log, 1.0 / a)
            SLOPE(log1p, 1.0 / (1.0 + a))
            SLOPE(sin, cos(a))
            SLOPE(cos, -sin(a))
            SLOPE(tan, 1.0 + r * r)
            SLOPE(tanh, 1.0 - r * r)
            SLOPE(sinh, cosh(a))
            SLOPE(cosh, sinh(a))
            SLOPE(arctan, 1.0 / (1.0 + a * a))
            SLOPE(arcsin, 1.0 / sqrt(1.0 - a * a))
            SLOPE(arccos, -1.0 / sqrt(1.0 - a * a))
            SLOPE(abs, sign_of(a))
            SLOPE(cbrt, 1.0 / (3.0 * r * r))
            default: /* steps: their slope is zero */
                ALONG R[k] = same(0.0);
                continue;
        }
        if (L == 1) f = same(AT(f, 0)), g = same(AT(g, 0));
        combined(R, A, B, f, g, flags, T, L);
    }
}
