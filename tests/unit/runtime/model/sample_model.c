/* A compiled model in C: z' = -k z. Variants with one defect each are built for the tests of loading. */
#include "runtime/abi/tf_model.h"

#include <math.h>
#include <stddef.h>

#ifdef SAMPLE_IS_NEWER
#define SAMPLE_ABI_VERSION (TF_ABI_VERSION + 1u)
#else
#define SAMPLE_ABI_VERSION TF_ABI_VERSION
#endif
#ifndef SAMPLE_MAGIC
#define SAMPLE_MAGIC TF_MAGIC
#endif
#ifndef SAMPLE_SYMBOL
#define SAMPLE_SYMBOL tf_model_v1
#endif

static void nothing(const double *const *in, double *const *out, const uint8_t *mask) {
  (void)in;
  (void)out;
  (void)mask;
}

static void starts(const double *const *in, double *const *out, const uint8_t *mask) {
  (void)in;
  (void)mask;
  out[2][0] = 1;
}

#ifndef SAMPLE_WITHOUT_DYNAMICS
static void dynamics(const double *const *in, double *const *out, const uint8_t *mask) {
  (void)mask;
  out[2][0] = -in[TF_IN_P][0] * in[TF_IN_Z][0];
}
#endif

/* x = (z, t) */
static void dynamicsDerivatives(const double *const *in, double *const *out, const uint8_t *mask) {
  (void)mask;
  out[1][0] = -in[TF_IN_P][0];
  out[1][1] = 0;
}

static const tf_variable variables[] = {
    {"time", "s", "", TF_KIND_TIME, 0, 0, -INFINITY, INFINITY, 1, {"sample.tf", 1, 1}},
    {"tau", "s", "", TF_KIND_NUMERICAL_TIME, 0, 0, -INFINITY, INFINITY, 1, {"sample.tf", 1, 1}},
    {"z", "", "decays", TF_KIND_STATE, 0, TF_FIXED | TF_SETTABLE, -INFINITY, INFINITY, 1, {"sample.tf", 2, 3}},
    {"k", "1/s", "rate", TF_KIND_PARAMETER, 0, TF_SETTABLE, 0, INFINITY, 1, {"sample.tf", 3, 3}},
};
static const double parameters[] = {2};

extern const tf_model SAMPLE_SYMBOL;
const tf_model SAMPLE_SYMBOL = {
    .magic = SAMPLE_MAGIC,
    .abi_version = SAMPLE_ABI_VERSION,
    .name = "Sample",
    .description = "",
    .generator = "written by hand",
    .hash = "sample",
    .nz = 1,
    .np = 1,
    .variable_count = 4,
    .variables = variables,
    .parameters = parameters,
    .start_time = 0,
    .stop_time = NAN,
    .tolerance = NAN,
    .interval = NAN,
    .bindings = nothing,
    .starts = starts,
#ifndef SAMPLE_WITHOUT_DYNAMICS
    .dynamics = dynamics,
#endif
    .switching = nothing,
    .contact_terms = nothing,
    .contact_parameters = nothing,
    .switch_gradients = nothing,
    .step_derivatives = nothing,
    .dynamics_derivatives = dynamicsDerivatives,
    .outputs = nothing,
    .energies = nothing,
};
