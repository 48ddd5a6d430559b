/* The kernel of the machine (`machine.h`, whose text precedes this) for a GPU: one design a thread.

   Slot k of design t is V[k * designs + t]: neighbouring threads read and write neighbouring
   numbers. All threads run the same instruction at the same time, so that they read it once.
   Constants stay in their table, which all threads share.
*/
#ifndef KERNEL
#define KERNEL extern "C" __global__
#endif

#define RETURNED(name, result) case OP_##name: return (result);

INLINE double result_of(int operation, double a, double b, double c) {
    switch (operation) {
        OPERATIONS(RETURNED)
        default: return NAN;
    }
}

#define SLOT(k) ((k) < slots ? V[(k) * designs + t] : constants[(k) - slots])

/* points: (inputs, designs); values: (results, designs); V: (slots, designs) */
KERNEL void run_designs(
    const uint16_t *code, ptrdiff_t count, const int32_t *extra, const int32_t *outputs,
    ptrdiff_t results, const double *constants, ptrdiff_t slots, ptrdiff_t inputs,
    const double *points, ptrdiff_t designs, double *V, double *values
) {
    const ptrdiff_t t = (ptrdiff_t)blockIdx.x * blockDim.x + threadIdx.x;
    if (t >= designs) return;
    for (ptrdiff_t k = 0; k < inputs; k++) V[k * designs + t] = points[k * designs + t];
    for (ptrdiff_t k = 0; k < count; k++) {
        const uint16_t *at = code + WORDS * k;
        if (OPERATION(at) == OP_roots) {
            double p[MOST_DEGREE + 1];
            for (int j = 0; j <= at[3]; j++) p[j] = SLOT(extra[at[2] + j]);
            roots_of(at, p, V + at[1] * designs + t, (size_t)designs);
            continue;
        }
        V[at[1] * designs + t] = result_of(OPERATION(at), SLOT(at[2]), SLOT(at[3]), SLOT(at[4]));
    }
    for (ptrdiff_t k = 0; k < results; k++) values[k * designs + t] = SLOT(outputs[k]);
}
