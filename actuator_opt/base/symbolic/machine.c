/* The Python module of the machine (`machine.h`): programs as buffers, for many points at once. */
#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030B0000
#include <Python.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__)
#define VECTORS
#pragma GCC diagnostic ignored "-Wpsabi" /* vectors are passed to inline functions only */
#endif
#include "machine.h"

#define TEXT(name, result) #name,
static const char *const NAMES[] = {OPERATIONS(TEXT) "roots"};

enum { LANES = 32, MOST_SLOPES = 8192, DIRECTIONS = 32, DIRECTIONS_IN_LANES = 16 };

#if defined(__GNUC__) && defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#define FAST __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define FAST
#endif
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

#define DUAL(name, T, L) \
    FAST static void name( \
        const uint16_t *code, Py_ssize_t count, const int32_t *extra, double *V, double *D, int width \
    ) { (void)width, dual(code, count, extra, V, D, T, L); }
DUAL(run_dual, width, 1)
/* with lanes, each width has a copy of its own, which is faster */
DUAL(run_dual_4, 4, FOUR) DUAL(run_dual_8, 8, FOUR) DUAL(run_dual_12, 12, FOUR)
DUAL(run_dual_16, 16, FOUR)

typedef void (*Dual)(const uint16_t *, Py_ssize_t, const int32_t *, double *, double *, int);
static Dual dual_of(Py_ssize_t T, Py_ssize_t L) {
    return L == 1 ? run_dual : T == 4 ? run_dual_4 : T == 8 ? run_dual_8
         : T == 12 ? run_dual_12 : run_dual_16;
}

/* ---- a program from Python ---- */

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

/* Points in groups of successive points. The first inputs are those of the group; results may be sums
   over the group. */
typedef struct {
    const double *shared, *own, *seeds;
    const int32_t *group;              /* of each point; NULL: groups have equal size */
    Py_ssize_t count, first, seeded;   /* points; inputs that are shared; inputs with seeds */
    Py_ssize_t groups;                 /* that share inputs */
    /* successive points with the same shared inputs, seeds, and row of the results; 0: a group */
    Py_ssize_t sharing, same, summed;
    Py_ssize_t once;                   /* instructions that need shared inputs only */
} Points;

/* Part to which a point belongs, of parts of `size` successive points. */
INLINE Py_ssize_t part_of(const Points *x, Py_ssize_t size, Py_ssize_t at) {
    return size == 1 ? at : size ? at / size : x->group[at];
}

/* Whether a part begins at a point. */
INLINE int begins(const Points *x, Py_ssize_t size, Py_ssize_t at) {
    if (size) return size == 1 || at % size == 0;
    return at == 0 || x->group[at] != x->group[at - 1];
}

/* Number of the points from `at` in the same part, at most `most`; parts of single points count as
   one part. */
INLINE Py_ssize_t left_in(const Points *x, Py_ssize_t size, Py_ssize_t at, Py_ssize_t most) {
    Py_ssize_t n = size > 1 ? size - at % size : size ? most : 1;
    while (!size && n < most && x->group[at + n] == x->group[at]) n++;
    return n < most ? n : most;
}

/* Number of the points from `at` that are computed together, at most L. They share inputs and seeds,
   or none of them does with another. */
static Py_ssize_t together_from(const Points *x, Py_ssize_t at, Py_ssize_t L) {
    const Py_ssize_t most = x->count - at < L ? x->count - at : L;
    return left_in(x, x->same, at, left_in(x, x->sharing, at, most));
}

/* Write the inputs of the points from `at`, in L lanes; lanes beyond the last point repeat one.
   Without `fresh`, shared inputs are there already. */
static void inputs_to(const Program *p, const Points *x, Py_ssize_t at, Py_ssize_t wide, int fresh,
                      double *V, Py_ssize_t L) {
    const Py_ssize_t rest = p->inputs - x->first;
    for (Py_ssize_t l = 0; l < L; l++) {
        const Py_ssize_t from = at + (l < wide ? l : 0);
        const double *own = x->own + from * rest;
        for (Py_ssize_t k = 0; k < rest; k++) V[(x->first + k) * L + l] = own[k];
        if (!fresh) continue;
        const double *shared = x->shared + part_of(x, x->sharing, from) * x->first;
        for (Py_ssize_t k = 0; k < x->first; k++) V[k * L + l] = shared[k];
    }
}

/* results: (rows, outputs) */
static int run_values(const Program *p, const Points *x, double *results) {
    const Py_ssize_t L = x->count < 4 ? 1 : LANES; /* a few points: one by one */
    double *V = calloc(L * (p->slots + p->constant_count), sizeof(double));
    if (V == NULL) return -1;
    constants_to(p, V, (int)L);
    const int mixed = x->groups * 2 * L > x->count; /* small groups: lanes belong to several */
    for (Py_ssize_t at = 0, wide; at < x->count; at += wide) {
        const int fresh = mixed || begins(x, x->sharing, at);
        const Py_ssize_t first = fresh ? 0 : x->once;
        wide = !mixed ? together_from(x, at, L) : x->count - at < L ? x->count - at : L;
        inputs_to(p, x, at, wide, fresh, V, L);
        (L == 1 ? run_single : run_lanes)(p->code + WORDS * first, p->count - first, p->extra, V);
        for (Py_ssize_t l = 0; l < wide; l++) {
            double *row = results + part_of(x, x->summed, at + l) * p->results;
            const int starts = begins(x, x->summed, at + l);
            for (Py_ssize_t k = 0; k < p->results; k++)
                row[k] = V[(Py_ssize_t)p->outputs[k] * L + l] + (starts ? -0.0 : row[k]);
        }
    }
    free(V);
    return 0;
}

/* Flags of the operands by which an operation has derivatives. */
static int sloped_operands(int operation) {
    switch (operation) {
        case OP_lt: case OP_le: case OP_eq: case OP_and: case OP_or: case OP_not: case OP_isnan:
        case OP_sign: case OP_floor: case OP_roots: return 0;
        case OP_copysign: return FIRST;
        case OP_where: return SECOND | THIRD;
        default: return FIRST | SECOND | THIRD;
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
            flags &= sloped_operands(OPERATION(at)) | ~(FIRST | SECOND | THIRD);
            if (flags & (FIRST | SECOND | THIRD)) flags |= RESULT;
            active[at[1]] = (flags & RESULT) != 0;
        }
        at[0] = (uint16_t)(OPERATION(at) | flags << 8);
    }
}

/* Derivatives along `wide` of T directions, from `first`: results are (rows, outputs, 1 + T).
   Values are written with the first of them. D has room for `wide` directions in L lanes. */
static void run_some_slopes(const Program *p, const Points *x, Py_ssize_t T, Py_ssize_t first,
                            int wide, Py_ssize_t L, const int32_t *varies, double *V, double *D,
                            double *results) {
    const Dual computed = dual_of(wide, L);
    for (Py_ssize_t at = 0, lanes; at < x->count; at += lanes) {
        const int fresh = begins(x, x->sharing, at) || begins(x, x->same, at);
        const Py_ssize_t skipped = fresh ? 0 : x->once;
        lanes = together_from(x, at, L);
        inputs_to(p, x, at, lanes, begins(x, x->sharing, at), V, L);
        for (Py_ssize_t l = 0; l < L && begins(x, x->same, at); l++) {
            const Py_ssize_t part = part_of(x, x->same, at + (l < lanes ? l : 0));
            const double *seed = x->seeds + part * x->seeded * T;
            for (Py_ssize_t k = 0; k < x->seeded; k++)
                for (int t = 0; t < wide; t++)
                    D[(k * wide + t) * L + l] = seed[k * T + first + t];
        }
        computed(p->code + WORDS * skipped, p->count - skipped, p->extra, V, D, wide);
        double *rows[FOUR];
        int starts[FOUR];
        for (Py_ssize_t l = 0; l < lanes; l++) {
            rows[l] = results + part_of(x, x->summed, at + l) * p->results * (1 + T);
            starts[l] = begins(x, x->summed, at + l);
        }
        for (Py_ssize_t k = 0; k < p->results; k++) {
            const Py_ssize_t slot = p->outputs[k];
            for (Py_ssize_t l = 0; l < lanes; l++, rows[l - 1] += 1 + T) {
                double *row = rows[l], *slopes = row + 1 + first;
                if (first == 0) row[0] = V[slot * L + l] + (starts[l] ? -0.0 : row[0]);
                if (starts[l]) memset(slopes, 0, sizeof(double) * wide);
                if (!varies[k]) continue;
                for (int t = 0; t < wide; t++) slopes[t] += D[(slot * wide + t) * L + l];
            }
        }
    }
}

static int run_slopes(const Program *p, const Points *x, Py_ssize_t T, const int32_t *varies,
                      double *results) {
    /* several lanes, if there are enough points and all slots stay in fast memory */
    const Py_ssize_t most = T < DIRECTIONS_IN_LANES ? T : DIRECTIONS_IN_LANES;
    const Py_ssize_t L = x->count < 4 || p->slots * most > MOST_SLOPES ? 1 : FOUR;
    const Py_ssize_t together = L == 1 ? DIRECTIONS : DIRECTIONS_IN_LANES;
    const Py_ssize_t room = T < together ? T : together;
    double *V = calloc(L * (p->slots + p->constant_count), sizeof(double));
    double *D = calloc(L * p->slots * room, sizeof(double));
    if (V == NULL || D == NULL) return free(V), free(D), -1;
    constants_to(p, V, (int)L);
    for (Py_ssize_t first = 0; first < T; first += together) {
        const Py_ssize_t left = T - first;
        run_some_slopes(p, x, T, first, (int)(left < together ? left : together), L, varies, V, D,
                        results);
    }
    free(V), free(D);
    return 0;
}

static int sized(Py_buffer *view, Py_ssize_t item, Py_ssize_t *count) {
    *count = view->len / item;
    return view->len % item == 0 && ((uintptr_t)view->buf) % item == 0;
}

/* ---- a program that was checked once; nothing can change it afterwards ---- */

typedef struct {
    PyObject_HEAD
    Program p;
    Py_ssize_t once, shared; /* first instructions, which need the first inputs only */
    int32_t *varies; /* whether each output has derivatives */
    char *block;     /* memory of all arrays */
} Checked;
static PyTypeObject *checked_type = NULL;

static void checked_end(PyObject *self) {
    PyTypeObject *type = Py_TYPE(self);
    free(((Checked *)self)->block);
    ((freefunc)PyType_GetSlot(type, Py_tp_free))(self);
    Py_DECREF(type);
}

static PyType_Slot CHECKED_SLOTS[] = {{Py_tp_dealloc, checked_end}, {0, NULL}};
static PyType_Spec CHECKED_SPEC = {
    "_machine.Checked", sizeof(Checked), 0,
    Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION, CHECKED_SLOTS};

/* Copy the buffers into one block; 0 if there is no memory. */
static int copied(Checked *own, const Py_buffer *view) {
    static const int order[5] = {4, 1, 2, 3, 0}; /* widest numbers first: all stay aligned */
    char *part[5], *at;
    Py_ssize_t total = 1;
    for (int k = 0; k < 5; k++) total += view[k].len;
    if ((at = own->block = malloc(total)) == NULL) return 0;
    for (int k = 0; k < 5; k++) {
        part[order[k]] = at;
        memcpy(at, view[order[k]].buf, view[order[k]].len);
        at += view[order[k]].len;
    }
    own->p.code = (uint16_t *)part[0], own->p.extra = (int32_t *)part[1];
    own->p.outputs = (int32_t *)part[2], own->varies = (int32_t *)part[3];
    own->p.constants = (double *)part[4];
    return 1;
}

PyDoc_STRVAR(checked_doc,
    "checked(code, extra, outputs, varies, constants, slots, inputs, once, shared)\n\n"
    "A copy of a program that can be run; refused if it would use memory outside its slots. The first\n"
    "instructions (`once`) need only the first inputs (`shared`), and no later one changes their results.");

static PyObject *checked(PyObject *self, PyObject *args) {
    static const Py_ssize_t item[5] = {2, 4, 4, 4, 8};
    Py_buffer view[5];
    Py_ssize_t size[5], slots, inputs;
    (void)self;
    Py_ssize_t once, shared;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*nnnn", &view[0], &view[1], &view[2], &view[3], &view[4],
                          &slots, &inputs, &once, &shared))
        return NULL;
    Checked *own = (Checked *)PyType_GenericAlloc(checked_type, 0);
    int valid = 1, memory = own != NULL;
    for (int k = 0; k < 5; k++) valid &= sized(&view[k], item[k], &size[k]);
    if (memory && valid) {
        Program *p = &own->p;
        p->slots = slots, p->inputs = inputs, p->count = size[0] / WORDS;
        p->extras = size[1], p->results = size[2], p->constant_count = size[4];
        own->once = once, own->shared = shared;
        memory = copied(own, view);
        valid = memory && size[0] % WORDS == 0 && size[3] == size[2] && slots >= 0
             && slots <= 65536 && inputs > 0 && once >= 0 && once <= p->count && !refused(p);
        for (Py_ssize_t k = 0; valid && k < p->results; k++)
            valid = !own->varies[k] || p->outputs[k] < slots;
    }
    for (int k = 0; k < 5; k++) PyBuffer_Release(&view[k]);
    if (memory && valid) return (PyObject *)own;
    if (own != NULL) Py_DECREF(own);
    return memory ? (PyErr_SetString(PyExc_ValueError, "not a valid program"), NULL)
                  : PyErr_NoMemory();
}

PyDoc_STRVAR(run_doc,
    "run(program, shared, first, own, seeds, seeded, width, group, results)\n\n"
    "Run a checked program for points. The first inputs (groups, first) are each shared by successive\n"
    "points, as many for every group, or those of which `group` (points,), int32, is the number; the\n"
    "others are (points, inputs - first). Without seeds (width 0), `results` is (rows, outputs). With\n"
    "seeds (parts, seeded, width) of the first inputs it is (rows, outputs, 1 + width); width is a\n"
    "multiple of 4. Seeds and rows may belong to the groups, or to any parts of equal size; each row is\n"
    "the sum over the points of a part.");

/* Number of successive points in each part of a buffer: 0 if they are the groups, -1 if they do not
   fit. */
static Py_ssize_t successive(const Points *x, Py_ssize_t groups, Py_ssize_t size, Py_ssize_t item) {
    if (item == 0) return size == 0 ? 1 : -1;
    const Py_ssize_t parts = size / item;
    if (parts * item != size || (parts == 0) != (x->count == 0)) return -1;
    if (x->group != NULL && parts == groups) return 0;
    return x->count == 0 ? 1 : x->count % parts ? -1 : x->count / parts;
}

/* Number of groups of successive points; -1 if a group is empty or not in order. */
static Py_ssize_t groups_of(const int32_t *group, Py_ssize_t points) {
    for (Py_ssize_t k = 0; k < points; k++)
        if (group[k] != (k ? group[k - 1] : 0) && (k == 0 || group[k] != group[k - 1] + 1)) return -1;
    return points ? group[points - 1] + 1 : 0;
}

static PyObject *run(PyObject *self, PyObject *args) {
    Py_buffer view[5];
    static const Py_ssize_t item[5] = {8, 8, 8, 4, 8};
    int width, valid = 1, failed = 0;
    Py_ssize_t size[5], groups = 0;
    Points x = {0};
    Checked *program;
    (void)self;
    if (!PyArg_ParseTuple(args, "O!y*ny*y*niy*w*", checked_type, &program, &view[0], &x.first,
                          &view[1], &view[2], &x.seeded, &width, &view[3], &view[4]))
        return NULL;
    const Program *p = &program->p;
    for (int k = 0; k < 5; k++) valid &= sized(&view[k], item[k], &size[k]);
    valid = valid && x.first >= 0 && x.first < p->inputs && x.seeded >= 0 && x.seeded <= p->inputs
         && width >= 0 && width % FOUR == 0;
    if (valid) {
        const Py_ssize_t rest = p->inputs - x.first;
        x.shared = view[0].buf, x.own = view[1].buf, x.seeds = view[2].buf;
        x.count = size[1] / rest;
        valid = size[1] == x.count * rest && (size[3] == 0 || size[3] == x.count);
        if (valid && size[3]) x.group = view[3].buf, groups = groups_of(x.group, x.count);
        x.sharing = successive(&x, groups, size[0], x.first);
        x.same = successive(&x, groups, size[2], x.seeded * width);
        x.summed = successive(&x, groups, size[4], p->results * (1 + width));
        valid = valid && groups >= 0 && x.sharing >= 0 && x.same >= 0 && x.summed >= 0;
        x.once = x.first < program->shared ? 0 : program->once;
        x.groups = x.first > 0 ? size[0] / x.first : x.count;
    }
    if (valid) {
        Py_BEGIN_ALLOW_THREADS
        failed = width == 0 ? run_values(p, &x, view[4].buf)
                            : run_slopes(p, &x, width, program->varies, view[4].buf);
        Py_END_ALLOW_THREADS
    }
    for (int k = 0; k < 5; k++) PyBuffer_Release(&view[k]);
    if (!valid) return PyErr_SetString(PyExc_ValueError, "not the points of the program"), NULL;
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
    Checked *program;
    Py_buffer view[3];        /* columns, point, results */
    double *V, *D, *point, *results;
    const int32_t *columns;
    Py_ssize_t states, width; /* inputs 1 to `states` are given in a call; columns of derivatives */
    int slopes;               /* whether the results are derivatives */
} Prepared;

/* Columns of derivatives, several at a time: one direction for each input that has derivatives. */
static void prepared_slopes(Prepared *own) {
    const Program *p = &own->program->p;
    for (Py_ssize_t first = 0; first < own->width; first += DIRECTIONS) {
        const Py_ssize_t left = own->width - first;
        const Py_ssize_t used = left < DIRECTIONS ? left : DIRECTIONS;
        const int T = (int)(used + 3) / 4 * 4;
        memset(own->D, 0, sizeof(double) * p->inputs * T);
        for (Py_ssize_t t = 0; t < used; t++) own->D[own->columns[first + t] * T + t] = 1.0;
        run_dual(p->code, p->count, p->extra, own->V, own->D, T);
        for (Py_ssize_t k = 0; k < p->results; k++) {
            if (!own->program->varies[k]) continue;
            const double *row = own->D + (size_t)p->outputs[k] * T;
            for (Py_ssize_t t = 0; t < used; t++)
                own->results[k * own->states + own->columns[first + t] - 1] = row[t];
        }
    }
}

static PyObject *prepared_call(PyObject *self, PyObject *args, PyObject *names) {
    Prepared *own = (Prepared *)self;
    const Program *p = &own->program->p;
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
    for (Py_ssize_t k = own->view[2].len / (Py_ssize_t)sizeof(double) - 1; k >= 0; k--)
        rest += 0.0 * own->results[k];
    if (rest != 0.0)
        return PyErr_SetString(PyExc_FloatingPointError, "a value is not finite"), NULL;
    return Py_NewRef(own->returned);
}

static void prepared_end(PyObject *self) {
    Prepared *own = (Prepared *)self;
    PyTypeObject *type = Py_TYPE(self);
    for (int k = 0; k < 3; k++) PyBuffer_Release(&own->view[k]);
    Py_XDECREF(own->returned);
    Py_XDECREF((PyObject *)own->program);
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
    "prepare(program, states, columns, point, results, slopes)\n\n"
    "A checked program as a function of time and states (states,), the first inputs. `point` (inputs,) holds the others\n"
    "and, after a call, the time and states of that call. The function returns `results`, which\n"
    "every call overwrites: the outputs (outputs,), or with slopes their derivatives by the states\n"
    "of some columns, which are numbers of inputs: (outputs, states), elsewhere as it was.");

static PyObject *prepare(PyObject *self, PyObject *args) {
    static const Py_ssize_t item[3] = {4, 8, 8};
    Py_ssize_t size[3];
    Checked *program;
    PyObject *returned;
    Prepared *own = (Prepared *)PyType_GenericAlloc((PyTypeObject *)prepared_type, 0);
    (void)self;
    if (own == NULL) return NULL;
    Py_buffer *view = own->view;
    if (!PyArg_ParseTuple(args, "O!ny*w*Oi", checked_type, &program, &own->states, &view[0],
                          &view[1], &returned, &own->slopes)
        || PyObject_GetBuffer(returned, &view[2], PyBUF_CONTIG) < 0)
        return Py_DECREF(own), NULL;
    own->returned = Py_NewRef(returned);
    own->program = (Checked *)Py_NewRef((PyObject *)program);
    const Program *p = &program->p;
    int valid = 1;
    for (int k = 0; k < 3; k++) valid &= sized(&view[k], item[k], &size[k]);
    own->columns = view[0].buf, own->point = view[1].buf, own->results = view[2].buf;
    own->width = size[0];
    valid = valid && own->states >= 0 && own->states < p->inputs && size[1] == p->inputs
         && size[2] == p->results * (own->slopes ? own->states : 1);
    for (Py_ssize_t k = 0; valid && k < own->width; k++)
        valid = own->columns[k] > 0 && own->columns[k] <= own->states;
    if (!valid) {
        Py_DECREF(own);
        return PyErr_SetString(PyExc_ValueError, "not the states of the program"), NULL;
    }
    own->V = calloc(p->slots + p->constant_count, sizeof(double));
    own->D = calloc(own->width ? p->slots * DIRECTIONS : 1, sizeof(double));
    if (own->V == NULL || own->D == NULL) {
        Py_DECREF(own);
        return PyErr_NoMemory();
    }
    constants_to(p, own->V, 1);
    return (PyObject *)own;
}

/* ---- rainflow counting ---- */

/* Whether the inner two of four successive reversals are a cycle: their range is not above those of
   their neighbours. Ranges that share a reversal compare as their other ends, without rounding. */
static int is_cycle(const double *x, const int32_t *r) {
    const double a = x[r[0]], b = x[r[1]], c = x[r[2]], d = x[r[3]];
    return b > c ? a <= c && d >= b : a >= c && d <= b;
}

/* Cycles of n values that repeat, from the first largest of them: pairs (cycles, 2) of the places of
   the larger and the smaller value. `r` has room for n + 1 places. Returns the number of cycles. */
static Py_ssize_t cycles_of(const double *x, Py_ssize_t n, int32_t *r, int32_t *pairs) {
    Py_ssize_t start = 0, size = 0, count = 0;
    if (n == 0) return 0;
    for (Py_ssize_t k = 1; k < n; k++) if (x[k] > x[start]) start = k;
    for (Py_ssize_t k = 0; k <= n; k++) {
        const int32_t at = (int32_t)((start + k) % n);
        if (size > 0 && x[at] == x[r[size - 1]]) size--; /* of equal values, the last */
        else if (size > 1 && (x[at] > x[r[size - 1]]) == (x[r[size - 1]] > x[r[size - 2]])) size--;
        r[size++] = at;
        while (size > 3 && is_cycle(x, r + size - 4)) {
            const int32_t b = r[size - 3], c = r[size - 2];
            pairs[2 * count] = x[b] > x[c] ? b : c, pairs[2 * count + 1] = x[b] > x[c] ? c : b;
            count++, r[size - 3] = r[size - 1], size -= 2;
        }
    }
    if (size > 2) pairs[2 * count] = r[0], pairs[2 * count + 1] = r[1], count++;
    return count;
}

PyDoc_STRVAR(cycles_doc,
    "cycles(values, pairs, counts)\n\n"
    "Rainflow cycles of repeating histories, values (histories, samples): their number (histories,),\n"
    "and samples of the largest and the smallest value of each (histories, samples, 2), int32.");

static PyObject *cycles(PyObject *self, PyObject *args) {
    static const Py_ssize_t item[3] = {8, 4, 4};
    Py_buffer view[3];
    Py_ssize_t size[3];
    int valid = 1;
    (void)self;
    if (!PyArg_ParseTuple(args, "y*w*w*", &view[0], &view[1], &view[2])) return NULL;
    for (int k = 0; k < 3; k++) valid &= sized(&view[k], item[k], &size[k]);
    const Py_ssize_t n = size[2] > 0 ? size[0] / size[2] : 0;
    valid = valid && n * size[2] == size[0] && size[1] == 2 * size[0] && n < INT32_MAX;
    int32_t *room = valid ? malloc(sizeof(int32_t) * (n + 1)) : NULL;
    for (Py_ssize_t k = 0; room != NULL && k < size[2]; k++)
        ((int32_t *)view[2].buf)[k] = (int32_t)cycles_of(
            (const double *)view[0].buf + k * n, n, room, (int32_t *)view[1].buf + 2 * n * k);
    free(room);
    for (int k = 0; k < 3; k++) PyBuffer_Release(&view[k]);
    if (!valid) return PyErr_SetString(PyExc_ValueError, "not the values of histories"), NULL;
    if (room == NULL) return PyErr_NoMemory();
    Py_RETURN_NONE;
}

static PyMethodDef METHODS[] = {
    {"checked", checked, METH_VARARGS, checked_doc},
    {"run", run, METH_VARARGS, run_doc},
    {"follow", follow_slots, METH_VARARGS, follow_doc},
    {"prepare", prepare, METH_VARARGS, prepare_doc},
    {"cycles", cycles, METH_VARARGS, cycles_doc},
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
    checked_type = (PyTypeObject *)PyType_FromSpec(&CHECKED_SPEC);
    prepared_type = PyType_FromSpec(&PREPARED_SPEC);
    return checked_type == NULL || prepared_type == NULL ? NULL : module;
}
