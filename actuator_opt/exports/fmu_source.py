"""C text of an FMI 2.0 unit for co-simulation; `fmu` fills in the equations of a scenario.

The declarations of the interface are our own, from the functions and types that the standard
[FMI-2] names. The integrator is RODAS [HairerWanner1996], a Rosenbrock method of order 4(3): it is
L-stable, keeps nothing between steps, and solves linear equations only. It uses the exact Jacobian,
so every step needs one evaluation of it, one factorisation and six evaluations of the rates.
"""

from __future__ import annotations

SOURCE = r"""/* @title@

   @origin@

   A unit for co-simulation and model exchange by FMI 2.0: a C99 source file, for a shared
   library or, with FMI2_FUNCTION_PREFIX defined, to be linked. It needs only the mathematics
   library. It has no variables outside functions; memory is allocated for an instance and for a
   stored state only. All numbers are in SI units.
*/
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

@machine@
/* ---- the interface of FMI 2.0 ---- */

typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated
} fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#ifndef FMI2_FUNCTION_PREFIX
#define FMI2_FUNCTION_PREFIX
#endif
#define JOINED(prefix, name) prefix##name
#define NAMED(prefix, name) JOINED(prefix, name)
#define FMI(name) NAMED(FMI2_FUNCTION_PREFIX, fmi2##name)
#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* ---- the programs of the scenario ----
   Their inputs are a point: the time, the states, the flags of instants, of switches and of inputs
   that are set, the free values (inputs and parameters of the unit), and recorded courses. */

enum {
    STATES = @states@, INSTANTS = @instants@, SWITCHES = @switches@, SETTABLE = @settable@,
    FREE = @free@, COURSES = @courses@, STOPS = @stops@, SIGNALS = @signals@, WORK = @work@,
    AT_STATES = 1, AT_INSTANTS = AT_STATES + STATES, AT_SWITCHES = AT_INSTANTS + INSTANTS,
    AT_SET = AT_SWITCHES + SWITCHES, AT_FREE = AT_SET + SETTABLE, AT_COURSES = AT_FREE + FREE,
    POINT = AT_COURSES + COURSES
};
static const char GUID[] = "@guid@";

@tables@
/* Absolute tolerances of the states. */
@tolerances@
/* Times at which a flag of an instant becomes 1; times that no step crosses. */
@instant_times@
@stop_times@
/* Free values: their starts; 2 for a parameter that is fixed, 1 for one that can change, 0 for an
   input; the flag that says that the input is set, or -1. */
@starts@
@kinds@
@flags@
/* Names of the switches. */
static const char *const SWITCH_NAMES[] = {@switch_names@};

/* A recorded course: linear between samples, or its slope, which is constant between them. */
typedef struct {
    const double *time, *values;
    int count, slope;
} Course;
@course_tables@
/* ---- an instance ---- */

enum { INSTANTIATED, INITIALISING, STEPPING, TERMINATED };

/* All that changes over time; a stored state is a copy of it. */
typedef struct {
    double point[POINT];
    double step;      /* size of the next step */
    double tolerance; /* relative */
    int phase;
} Core;

typedef struct {
    Core core;
    fmi2CallbackFunctions callbacks;
    char name[128];
    int exchange; /* whether the host integrates */
    int fresh;    /* whether `signals` belong to the point */
    double signals[SIGNALS], point[POINT], work[WORK];
    double slopes[STATES * (STATES + 1)], matrix[STATES * STATES], stages[6][STATES];
    double stage[STATES], rates[STATES], end[STATES];
    double before[2 * SWITCHES + 1], after[2 * SWITCHES + 1], low[2 * SWITCHES + 1];
    int pivots[STATES];
} Instance;

static const double RESTART = 1e-6;   /* step after a jump [s] (our choice) */
static const double LONGEST = 1e-2;   /* longest step [s] (our choice: no course is skipped) */
static const double SHORTEST = 1e-14; /* shortest step, also relative to the time (our choice) */
static const double APART = 1e-9;     /* times that differ less are equal [s], as in simulate */
static const double LOCATED = 1e-12;  /* accuracy of the time of a switch [s], as in simulate */
static const double RELATIVE = 1e-6;  /* relative tolerance, as in simulate */
enum { MOST_STEPS = 10000000, MOST_CHANGES = 20000 }; /* in one communication step (our choice) */

static fmi2Status failed(Instance *f, const char *format, ...) {
    char text[256];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (f->callbacks.logger)
        f->callbacks.logger(
            f->callbacks.componentEnvironment, f->name, fmi2Error, "logStatusError", "%s", text
        );
    return fmi2Error;
}

static double shortest(double time) { return SHORTEST * fmax(1, fabs(time)); }

/* ---- equations ---- */

static void computed(const Program *p, Instance *f, double *outputs) {
    run(p, f->point, f->work);
    for (ptrdiff_t k = 0; k < p->results; k++) outputs[k] = f->work[p->outputs[k]];
}

static double course_at(const Course *course, double time) {
    int low = 0, high = course->count; /* the number of samples up to this time */
    while (low < high) {
        const int middle = (low + high) / 2;
        if (course->time[middle] <= time) low = middle + 1;
        else high = middle;
    }
    if (course->slope) return course->values[low];
    if (low == 0) return course->values[0];
    if (low == course->count) return course->values[low - 1];
    const double begin = course->time[low - 1], end = course->time[low];
    const double share = (time - begin) / (end - begin);
    return course->values[low - 1] + share * (course->values[low] - course->values[low - 1]);
}

/* Set the point of the next computation: a time and states; all else is that of the instance. */
static void place(Instance *f, double time, const double *states) {
    f->point[0] = time;
    for (int k = 0; k < STATES; k++) f->point[AT_STATES + k] = states[k];
    for (int k = 0; k < COURSES; k++) f->point[AT_COURSES + k] = course_at(&COURSE[k], time);
}

static void place_all(Instance *f) {
    memcpy(f->point, f->core.point, sizeof f->point);
    place(f, f->core.point[0], f->core.point + AT_STATES);
}

/* Guards, which are positive until their switch changes, and their slopes over time. */
static void guards(Instance *f, double time, const double *states, double *margins) {
    if (SWITCHES == 0) return;
    place(f, time, states);
    computed(&GUARDS, f, margins);
    for (int k = 0; k < SWITCHES; k++) {
        if (f->point[AT_SWITCHES + k] != 0) continue;
        margins[k] = -margins[k];
        margins[SWITCHES + k] = -margins[SWITCHES + k];
    }
}

/* The first switch whose guard is negative, or -1. */
static int crossed(const double *margins) {
    for (int k = 0; k < SWITCHES; k++)
        if (margins[k] < 0) return k;
    return -1;
}

/* Whether a guard falls below zero and rises again within a step, by a cubic through its ends. */
static int dips(const double *before, const double *after, double h) {
    for (int k = 0; k < SWITCHES; k++) {
        const double a = before[k], b = after[k];
        const double c = h * before[SWITCHES + k], d = h * after[SWITCHES + k];
        if (!(b > 0 && c < 0 && d > 0)) continue;
        for (int part = 1; part < 10; part++) {
            const double s = 0.1 * part, r = 1 - s;
            const double at = (1 + 2 * s) * r * r * a + s * r * r * c;
            if (at + s * s * (3 - 2 * s) * b - s * s * r * d < 0) return 1;
        }
    }
    return 0;
}

/* Set the flags of all instants that have passed; return whether one of them changed. */
static int instants_passed(Core *core) {
    int changed = 0;
    for (int k = 0; k < INSTANTS; k++) {
        const double flag = core->point[0] + APART >= INSTANT_TIMES[k];
        changed |= core->point[AT_INSTANTS + k] != flag;
        core->point[AT_INSTANTS + k] = flag;
    }
    return changed;
}

/* Compute the states at the start, and the flags. */
static void begin(Instance *f) {
    double *point = f->core.point;
    instants_passed(&f->core);
    for (int k = 0; k < SWITCHES; k++) point[AT_SWITCHES + k] = 0;
    place_all(f);
    computed(&START, f, point + AT_STATES);
    if (SWITCHES > 0) {
        place_all(f);
        computed(&GUARDS, f, f->before);
        for (int k = 0; k < SWITCHES; k++) point[AT_SWITCHES + k] = f->before[k] > 0;
    }
    f->core.step = RESTART;
}

static void refresh(Instance *f) {
    if (f->fresh) return;
    if (f->core.phase < STEPPING) begin(f);
    place_all(f);
    computed(&OUTPUTS, f, f->signals);
    f->fresh = 1;
}

/* ---- a step by RODAS ---- */

static const double PLACE[] = {0, 0.386, 0.21, 0.63, 1, 1};
static const double OF_TIME[] = {0.25, -0.1043, 0.1035, -0.03620000000000023, 0, 0};
static const double OF_STATE[6][5] = {
    {0},
    {1.544},
    {0.9466785280815826, 0.2557011698983284},
    {3.314825187068521, 2.896124015972201, 0.9986419139977817},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1}
};
static const double OF_RATE[6][5] = {
    {0},
    {-5.6688},
    {-2.430093356833875, -0.2063599157091915},
    {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
    {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
    {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
     -6.058818238834054}
};
static const double GAMMA = 0.25;

/* Factor I/(gamma h) - J with row pivoting, each row relative to the tolerance of its state. */
static int factored(Instance *f, double h) {
    double *A = f->matrix;
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++)
            A[i * STATES + j] = (i == j) / (GAMMA * h) - f->slopes[i * (STATES + 1) + j];
    for (int i = 0; i < STATES; i++) f->pivots[i] = i;
    for (int k = 0; k < STATES; k++) {
        int best = k;
        double most = 0;
        for (int i = k; i < STATES; i++) {
            const double size = fabs(A[i * STATES + k]) / TOLERANCES[f->pivots[i]];
            if (size > most) most = size, best = i;
        }
        if (!(most > 0 && most < INFINITY)) return 0;
        if (best != k) {
            const int row = f->pivots[k];
            f->pivots[k] = f->pivots[best], f->pivots[best] = row;
            for (int j = 0; j < STATES; j++) {
                const double held = A[k * STATES + j];
                A[k * STATES + j] = A[best * STATES + j], A[best * STATES + j] = held;
            }
        }
        for (int i = k + 1; i < STATES; i++) {
            const double share = A[i * STATES + k] /= A[k * STATES + k];
            if (share == 0) continue;
            for (int j = k + 1; j < STATES; j++) A[i * STATES + j] -= share * A[k * STATES + j];
        }
    }
    return 1;
}

static void solved(const Instance *f, const double *right, double *x) {
    const double *A = f->matrix;
    for (int i = 0; i < STATES; i++) {
        x[i] = right[f->pivots[i]];
        for (int j = 0; j < i; j++) x[i] -= A[i * STATES + j] * x[j];
    }
    for (int i = STATES - 1; i >= 0; i--) {
        for (int j = i + 1; j < STATES; j++) x[i] -= A[i * STATES + j] * x[j];
        x[i] /= A[i * STATES + i];
    }
}

/* A step of size h from the point of the instance, whose slopes are known, to `end`. Returns its
   error relative to the tolerances; infinite if the equations have no value. */
static double stepped(Instance *f, double h) {
    const double *states = f->core.point + AT_STATES;
    double error = 0;
    if (!factored(f, h)) return INFINITY;
    for (int s = 0; s < 6; s++) {
        for (int i = 0; i < STATES; i++) {
            f->stage[i] = states[i];
            for (int j = 0; j < s; j++) f->stage[i] += OF_STATE[s][j] * f->stages[j][i];
        }
        place(f, f->core.point[0] + PLACE[s] * h, f->stage);
        computed(&RATES, f, f->rates);
        for (int i = 0; i < STATES; i++) {
            for (int j = 0; j < s; j++) f->rates[i] += OF_RATE[s][j] / h * f->stages[j][i];
            f->rates[i] += h * OF_TIME[s] * f->slopes[i * (STATES + 1) + STATES];
        }
        solved(f, f->rates, f->stages[s]);
    }
    for (int i = 0; i < STATES; i++) {
        f->end[i] = f->stage[i] + f->stages[5][i];
        const double size = fmax(fabs(states[i]), fabs(f->end[i]));
        const double share = fabs(f->stages[5][i]) / (TOLERANCES[i] + f->core.tolerance * size);
        if (!(share < INFINITY && size < INFINITY)) return INFINITY;
        error = fmax(error, share);
    }
    return error;
}

/* Shorten a step of size h at whose end a guard is negative, until it ends just there: by the
   regula falsi of Illinois. Returns its size. */
static double located(Instance *f, double h) {
    const double time = f->core.point[0];
    int g = crossed(f->after), side = 0;
    double low = 0, a = f->before[g], b = f->after[g];
    memcpy(f->low, f->before, sizeof f->low);
    for (int k = 0; k < 100 && h - low > LOCATED; k++) {
        double at = a - b > 0 ? low + (h - low) * a / (a - b) : 0.5 * (low + h);
        at = fmin(fmax(at, low + 0.5 * LOCATED), h - 0.5 * LOCATED);
        const int known = stepped(f, at) < INFINITY;
        if (known) guards(f, time + at, f->end, f->after);
        const int first = known ? crossed(f->after) : g;
        if (first < 0) {
            memcpy(f->low, f->after, sizeof f->low);
            low = at, a = f->low[g];
            if (side < 0) b *= 0.5;
            side = -1;
            continue;
        }
        h = at;
        if (known && f->after[g] >= 0) g = first, a = f->low[g], side = 0;
        b = known ? f->after[g] : -a;
        if (side > 0) a *= 0.5;
        side = 1;
    }
    return h;
}

/* Move to the end of the last step. */
static void keep(Instance *f, double time) {
    f->core.point[0] = time;
    memcpy(f->core.point + AT_STATES, f->end, sizeof f->end);
}

/* Switch at a guard within the last step of size h, which was accepted. */
static fmi2Status switched(Instance *f, double h) {
    const double time = f->core.point[0];
    h = located(f, h);
    if (!(stepped(f, h) < INFINITY)) return failed(f, "at %.6g s: no solution at a switch", time);
    guards(f, time + h, f->end, f->after);
    keep(f, time + h);
    for (int k = 0; k < SWITCHES; k++) {
        double *flag = &f->core.point[AT_SWITCHES + k];
        if (f->after[k] < 0) *flag = *flag == 0;
    }
    f->core.step = RESTART;
    return fmi2OK;
}

/* A step that is accepted, up to `stop` at most; adds to the numbers of tries and of switches. */
static fmi2Status one_step(Instance *f, double stop, long *tries, long *changes) {
    Core *core = &f->core;
    const double time = core->point[0], whole = stop - time;
    double growth = 5;
    place_all(f);
    computed(&SLOPES, f, f->slopes);
    guards(f, time, core->point + AT_STATES, f->before);
    for (;; growth = 1) {
        double h = fmin(core->step, LONGEST);
        const int last = h >= whole * (1 - 1e-9);
        if (last) h = whole;
        else if (h > 0.5 * whole) h = 0.5 * whole;
        const double error = stepped(f, h);
        if (++*tries > MOST_STEPS) return failed(f, "at %.6g s: too many steps", time);
        if (!(error <= 1)) {
            core->step = h * (error < INFINITY ? fmax(0.1, 0.9 * pow(error, -0.25)) : 0.25);
            if (core->step >= shortest(time)) continue;
            return failed(f, "at %.6g s: no time step is small enough", time);
        }
        guards(f, time + h, f->end, f->after);
        if (crossed(f->after) >= 0) {
            if (++*changes <= MOST_CHANGES) return switched(f, h);
            return failed(
                f, "at %.6g s: %s switches back and forth endlessly", time,
                SWITCH_NAMES[crossed(f->after)]
            );
        }
        if (h > APART && dips(f->before, f->after, h)) {
            core->step = 0.5 * h;
            continue;
        }
        const double next = h * fmin(growth, fmax(0.2, 0.9 * pow(fmax(error, 1e-12), -0.25)));
        core->step = last || h < core->step ? fmax(next, core->step) : next;
        keep(f, last ? stop : time + h);
        return fmi2OK;
    }
}

/* Index of the first stop after a time; STOPS if there is none. */
static int next_stop(double time) {
    int low = 0, high = STOPS;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (STOP_TIMES[middle] > time + APART) high = middle;
        else low = middle + 1;
    }
    return low;
}

/* Integrate up to a time; stop at all times at which a course of the scenario jumps or bends. */
static fmi2Status advanced(Instance *f, double end) {
    Core *core = &f->core;
    long tries = 0, changes = 0;
    if (instants_passed(core)) core->step = RESTART;
    while (core->point[0] < end) {
        const int next = next_stop(core->point[0]);
        const double stop = next < STOPS && STOP_TIMES[next] < end ? STOP_TIMES[next] : end;
        if (stop - core->point[0] < shortest(stop)) {
            core->point[0] = stop;
            continue;
        }
        const fmi2Status status = one_step(f, stop, &tries, &changes);
        if (status != fmi2OK) return status;
        if (instants_passed(core)) core->step = RESTART;
    }
    return fmi2OK;
}

/* ---- the functions of the interface ---- */

EXPORT const char *FMI(GetTypesPlatform)(void) { return "default"; }
EXPORT const char *FMI(GetVersion)(void) { return "2.0"; }

EXPORT fmi2Status FMI(SetDebugLogging)(
    fmi2Component c, fmi2Boolean on, size_t count, const fmi2String *categories
) {
    (void)on, (void)count, (void)categories; /* errors are always reported, nothing else is */
    return c ? fmi2OK : fmi2Error;
}

static void defaults(Instance *f) {
    memset(&f->core, 0, sizeof f->core);
    memcpy(f->core.point + AT_FREE, STARTS, sizeof(double) * FREE);
    f->core.tolerance = RELATIVE;
    f->core.step = RESTART;
    f->fresh = 0;
}

EXPORT fmi2Component FMI(Instantiate)(
    fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging
) {
    (void)resources, (void)visible, (void)logging;
    if (!functions || !functions->allocateMemory || !functions->freeMemory) return NULL;
    Instance *f = (Instance *)functions->allocateMemory(1, sizeof(Instance));
    if (!f) return NULL;
    f->callbacks = *functions;
    snprintf(f->name, sizeof f->name, "%s", name ? name : "");
    defaults(f);
    f->exchange = type == fmi2ModelExchange;
    if (!guid || strcmp(guid, GUID) != 0) failed(f, "the GUID is not that of this unit");
    else return f;
    functions->freeMemory(f);
    return NULL;
}

EXPORT void FMI(FreeInstance)(fmi2Component c) {
    if (c) ((Instance *)c)->callbacks.freeMemory(c);
}

EXPORT fmi2Status FMI(SetupExperiment)(
    fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start, fmi2Boolean ends,
    fmi2Real end
) {
    Instance *f = (Instance *)c;
    (void)ends, (void)end;
    if (!f) return fmi2Error;
    if (f->core.phase != INSTANTIATED) return failed(f, "fmi2SetupExperiment: called too late");
    if (!isfinite(start)) return failed(f, "fmi2SetupExperiment: the start time is not finite");
    if (tolerant && !(tolerance > 0 && tolerance < 1))
        return failed(f, "fmi2SetupExperiment: the tolerance is not between 0 and 1");
    if (tolerant) f->core.tolerance = fmax(tolerance, 1e-12);
    f->core.point[0] = start;
    f->fresh = 0;
    return fmi2OK;
}

EXPORT fmi2Status FMI(EnterInitializationMode)(fmi2Component c) {
    Instance *f = (Instance *)c;
    if (!f) return fmi2Error;
    if (f->core.phase != INSTANTIATED)
        return failed(f, "fmi2EnterInitializationMode: called too late");
    f->core.phase = INITIALISING;
    return fmi2OK;
}

EXPORT fmi2Status FMI(ExitInitializationMode)(fmi2Component c) {
    Instance *f = (Instance *)c;
    if (!f) return fmi2Error;
    if (f->core.phase != INITIALISING)
        return failed(f, "fmi2ExitInitializationMode: call fmi2EnterInitializationMode before it");
    begin(f);
    for (int k = 0; k < STATES; k++)
        if (!isfinite(f->core.point[AT_STATES + k]))
            return failed(f, "the initial state is not finite: check the parameters");
    f->core.phase = STEPPING;
    return fmi2OK;
}

EXPORT fmi2Status FMI(Terminate)(fmi2Component c) {
    Instance *f = (Instance *)c;
    if (!f) return fmi2Error;
    refresh(f);
    f->core.phase = TERMINATED;
    return fmi2OK;
}

EXPORT fmi2Status FMI(Reset)(fmi2Component c) {
    if (!c) return fmi2Error;
    defaults((Instance *)c);
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetReal)(
    fmi2Component c, const fmi2ValueReference *references, size_t count, fmi2Real *values
) {
    Instance *f = (Instance *)c;
    if (!f || (count && (!references || !values))) return fmi2Error;
    refresh(f);
    for (size_t k = 0; k < count; k++) {
        const fmi2ValueReference at = references[k];
        if (at >= SIGNALS + 1 + 2 * STATES)
            return failed(f, "fmi2GetReal: no variable has the reference %u", at);
        if (at < SIGNALS) values[k] = f->signals[at];
        else if (at < SIGNALS + 1 + STATES) values[k] = f->core.point[at - SIGNALS];
        else {
            place_all(f);
            computed(&RATES, f, f->rates);
            values[k] = f->rates[at - SIGNALS - 1 - STATES];
        }
    }
    return fmi2OK;
}

EXPORT fmi2Status FMI(SetReal)(
    fmi2Component c, const fmi2ValueReference *references, size_t count, const fmi2Real *values
) {
    Instance *f = (Instance *)c;
    if (!f || (count && (!references || !values))) return fmi2Error;
    for (size_t k = 0; k < count; k++) {
        const fmi2ValueReference at = references[k];
        if (at >= FREE)
            return failed(f, "fmi2SetReal: the reference %u is no input and no parameter", at);
        if (!isfinite(values[k]))
            return failed(f, "fmi2SetReal: the value of the reference %u is not finite", at);
        if (KINDS[at] == 2 && f->core.phase >= STEPPING)
            return failed(f, "fmi2SetReal: the parameter %u is fixed after the start", at);
        f->core.point[AT_FREE + at] = values[k];
        if (FLAGS_OF[at] >= 0) f->core.point[AT_SET + FLAGS_OF[at]] = 1;
        f->fresh = 0;
    }
    return fmi2OK;
}

/* The unit has numbers only. */
static fmi2Status none(fmi2Component c, size_t count, const char *kind) {
    if (!c) return fmi2Error;
    return count ? failed((Instance *)c, "this unit has no %s variables", kind) : fmi2OK;
}

#define OTHER(name, type) \
    EXPORT fmi2Status FMI(Get##name)( \
        fmi2Component c, const fmi2ValueReference *references, size_t count, type *values \
    ) { \
        (void)references, (void)values; \
        return none(c, count, #name); \
    } \
    EXPORT fmi2Status FMI(Set##name)( \
        fmi2Component c, const fmi2ValueReference *references, size_t count, const type *values \
    ) { \
        (void)references, (void)values; \
        return none(c, count, #name); \
    }
OTHER(Integer, fmi2Integer)
OTHER(Boolean, fmi2Boolean)
OTHER(String, fmi2String)

EXPORT fmi2Status FMI(GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    Instance *f = (Instance *)c;
    if (!f || !state) return fmi2Error;
    if (!*state) *state = f->callbacks.allocateMemory(1, sizeof(Core));
    if (!*state) return failed(f, "fmi2GetFMUstate: no memory");
    memcpy(*state, &f->core, sizeof(Core));
    return fmi2OK;
}

EXPORT fmi2Status FMI(SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    Instance *f = (Instance *)c;
    if (!f || !state) return fmi2Error;
    memcpy(&f->core, state, sizeof(Core));
    f->fresh = 0;
    return fmi2OK;
}

EXPORT fmi2Status FMI(FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    if (!c) return fmi2Error;
    if (state && *state) {
        ((Instance *)c)->callbacks.freeMemory(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT fmi2Status FMI(SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size) {
    if (!c || !state || !size) return fmi2Error;
    *size = sizeof(Core);
    return fmi2OK;
}

EXPORT fmi2Status FMI(SerializeFMUstate)(
    fmi2Component c, fmi2FMUstate state, fmi2Byte *bytes, size_t size
) {
    if (!c || !state || !bytes || size < sizeof(Core)) return fmi2Error;
    memcpy(bytes, state, sizeof(Core));
    return fmi2OK;
}

EXPORT fmi2Status FMI(DeSerializeFMUstate)(
    fmi2Component c, const fmi2Byte *bytes, size_t size, fmi2FMUstate *state
) {
    Instance *f = (Instance *)c;
    if (!f || !bytes || !state) return fmi2Error;
    if (size != sizeof(Core)) return failed(f, "fmi2DeSerializeFMUstate: not a state of this unit");
    if (!*state) *state = f->callbacks.allocateMemory(1, sizeof(Core));
    if (!*state) return failed(f, "fmi2DeSerializeFMUstate: no memory");
    memcpy(*state, bytes, sizeof(Core));
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetDirectionalDerivative)(
    fmi2Component c, const fmi2ValueReference *unknown, size_t unknowns,
    const fmi2ValueReference *known, size_t knowns, const fmi2Real *seeds, fmi2Real *slopes
) {
    (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)seeds, (void)slopes;
    return c ? failed((Instance *)c, "this unit has no directional derivatives") : fmi2Error;
}

EXPORT fmi2Status FMI(SetRealInputDerivatives)(
    fmi2Component c, const fmi2ValueReference *references, size_t count, const fmi2Integer *orders,
    const fmi2Real *values
) {
    (void)references, (void)count, (void)orders, (void)values;
    return c ? failed((Instance *)c, "this unit does not interpolate inputs") : fmi2Error;
}

EXPORT fmi2Status FMI(GetRealOutputDerivatives)(
    fmi2Component c, const fmi2ValueReference *references, size_t count, const fmi2Integer *orders,
    fmi2Real *values
) {
    (void)references, (void)count, (void)orders, (void)values;
    return c ? failed((Instance *)c, "this unit has no output derivatives") : fmi2Error;
}

EXPORT fmi2Status FMI(DoStep)(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean final) {
    Instance *f = (Instance *)c;
    (void)final;
    if (!f) return fmi2Error;
    if (f->exchange) return failed(f, "fmi2DoStep: this instance is for model exchange");
    if (f->core.phase != STEPPING) return failed(f, "fmi2DoStep: not after the initialisation");
    if (!(step >= 0 && step < INFINITY))
        return failed(f, "fmi2DoStep: the step size is negative or not finite");
    const double now = f->core.point[0];
    if (!(fabs(time - now) <= APART * fmax(1, fabs(time))))
        return failed(f, "fmi2DoStep: at %.9g s, but the unit is at %.9g s", time, now);
    f->fresh = 0;
    return advanced(f, time + step);
}

EXPORT fmi2Status FMI(CancelStep)(fmi2Component c) {
    return c ? failed((Instance *)c, "fmi2CancelStep: no step is under way") : fmi2Error;
}

EXPORT fmi2Status FMI(GetStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Status *value) {
    (void)kind, (void)value;
    return c ? fmi2Discard : fmi2Error;
}

EXPORT fmi2Status FMI(GetRealStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Real *value) {
    if (!c || !value) return fmi2Error;
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = ((Instance *)c)->core.point[0];
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetIntegerStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind, (void)value;
    return c ? fmi2Discard : fmi2Error;
}

EXPORT fmi2Status FMI(GetBooleanStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value) {
    if (!c || !value) return fmi2Error;
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = 0;
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetStringStatus)(fmi2Component c, fmi2StatusKind kind, fmi2String *value) {
    (void)kind, (void)value;
    return c ? fmi2Discard : fmi2Error;
}

@exchange@
#ifdef __cplusplus
}
#endif
"""
