"""C text of the functions that FMI 2.0 [FMI-2] adds for model exchange; part of `fmu_source`.

The host integrates the states. Its event indicators are the guards of the switches; time events are
the instants at which a course of the scenario jumps or bends.
"""

from __future__ import annotations

EXCHANGE = r"""/* ---- the functions for model exchange ---- */

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

/* The instance, if it is one for model exchange after its initialisation; else NULL. */
static Instance *exchanged(fmi2Component c, const char *function) {
    Instance *f = (Instance *)c;
    if (!f) return NULL;
    if (f->exchange && f->core.phase == STEPPING) return f;
    failed(f, "%s: only for model exchange, after the initialisation", function);
    return NULL;
}

/* Whether a switch changes now, that is, its guard is or soon will be negative (`before` has the
   guards): a host stops on either side of a change. */
static int due(const Instance *f, int k) {
    return f->before[k] + APART * f->before[SWITCHES + k] < 0;
}

static void guards_now(Instance *f) {
    place_all(f);
    guards(f, f->core.point[0], f->core.point + AT_STATES, f->before);
}

EXPORT fmi2Status FMI(EnterEventMode)(fmi2Component c) {
    return exchanged(c, "fmi2EnterEventMode") ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status FMI(EnterContinuousTimeMode)(fmi2Component c) {
    return exchanged(c, "fmi2EnterContinuousTimeMode") ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status FMI(NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info) {
    Instance *f = exchanged(c, "fmi2NewDiscreteStates");
    if (!f || !info) return fmi2Error;
    instants_passed(&f->core);
    guards_now(f);
    for (int k = 0; k < SWITCHES; k++) {
        double *flag = &f->core.point[AT_SWITCHES + k];
        if (due(f, k)) *flag = *flag == 0;
    }
    const int next = next_stop(f->core.point[0]);
    memset(info, 0, sizeof *info);
    info->nextEventTimeDefined = next < STOPS;
    if (next < STOPS) info->nextEventTime = STOP_TIMES[next];
    f->fresh = 0;
    return fmi2OK;
}

EXPORT fmi2Status FMI(CompletedIntegratorStep)(
    fmi2Component c, fmi2Boolean final, fmi2Boolean *event, fmi2Boolean *terminate
) {
    Instance *f = exchanged(c, "fmi2CompletedIntegratorStep");
    (void)final;
    if (!f || !event || !terminate) return fmi2Error;
    *event = *terminate = 0;
    guards_now(f);
    for (int k = 0; k < SWITCHES; k++) *event |= due(f, k);
    return fmi2OK;
}

EXPORT fmi2Status FMI(SetTime)(fmi2Component c, fmi2Real time) {
    Instance *f = exchanged(c, "fmi2SetTime");
    if (!f) return fmi2Error;
    if (!isfinite(time)) return failed(f, "fmi2SetTime: the time is not finite");
    f->core.point[0] = time;
    f->fresh = 0;
    return fmi2OK;
}

EXPORT fmi2Status FMI(SetContinuousStates)(fmi2Component c, const fmi2Real *x, size_t count) {
    Instance *f = exchanged(c, "fmi2SetContinuousStates");
    if (!f || !x) return fmi2Error;
    if (count != STATES) return failed(f, "fmi2SetContinuousStates: there are %d", (int)STATES);
    for (int k = 0; k < STATES; k++)
        if (!isfinite(x[k])) return failed(f, "fmi2SetContinuousStates: a state is not finite");
    memcpy(f->core.point + AT_STATES, x, sizeof(double) * STATES);
    f->fresh = 0;
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetContinuousStates)(fmi2Component c, fmi2Real *x, size_t count) {
    Instance *f = exchanged(c, "fmi2GetContinuousStates");
    if (!f || !x) return fmi2Error;
    if (count != STATES) return failed(f, "fmi2GetContinuousStates: there are %d", (int)STATES);
    memcpy(x, f->core.point + AT_STATES, sizeof(double) * STATES);
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetDerivatives)(fmi2Component c, fmi2Real *slopes, size_t count) {
    Instance *f = exchanged(c, "fmi2GetDerivatives");
    if (!f || !slopes) return fmi2Error;
    if (count != STATES) return failed(f, "fmi2GetDerivatives: there are %d", (int)STATES);
    place_all(f);
    computed(&RATES, f, slopes);
    for (int k = 0; k < STATES; k++)
        if (!isfinite(slopes[k])) return fmi2Discard; /* the host tries a shorter step */
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetEventIndicators)(fmi2Component c, fmi2Real *indicators, size_t count) {
    Instance *f = exchanged(c, "fmi2GetEventIndicators");
    if (!f || (count && !indicators)) return fmi2Error;
    if (count != SWITCHES) return failed(f, "fmi2GetEventIndicators: there are %d", (int)SWITCHES);
    guards_now(f);
    for (int k = 0; k < SWITCHES; k++) /* guards as they are: positive while the switch is on */
        indicators[k] = f->core.point[AT_SWITCHES + k] != 0 ? f->before[k] : -f->before[k];
    return fmi2OK;
}

EXPORT fmi2Status FMI(GetNominalsOfContinuousStates)(
    fmi2Component c, fmi2Real *nominals, size_t count
) {
    Instance *f = exchanged(c, "fmi2GetNominalsOfContinuousStates");
    if (!f || !nominals) return fmi2Error;
    if (count != STATES) return failed(f, "fmi2GetNominals: there are %d", (int)STATES);
    for (int k = 0; k < STATES; k++) nominals[k] = TOLERANCES[k] / RELATIVE;
    return fmi2OK;
}
"""
