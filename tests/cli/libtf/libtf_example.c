/* A C program that simulates a compiled model with libtf: no compiler, no front end, no LLVM in the process.
 *
 *   libtf_example PARTICLE.so
 *
 * The model is examples/particle.tf, a point mass above a floor. It is pushed to the right with 7 N (a table) and, from t = 1 on, pulled
 * upwards with the force 2 g (t - 1) (a callback with a breakpoint). It hits the floor at sqrt(2/g), and leaves it at t = 1.5, when the
 * pull exceeds its weight. All numbers are compared with their closed forms. Exit code 0: all is well.
 */
#include "runtime/tf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

static void fail(const char *what, const char *detail) {
  fprintf(stderr, "FAILED: %s: %s\n", what, detail);
  ++failures;
}

static void expectOk(tf_status status, const tf_simulation *simulation, const char *what) {
  if (status != TF_OK)
    fail(what, tf_error_text(simulation));
}

static void expectNear(tf_simulation *simulation, const char *name, double expected, double tolerance) {
  double value = 0;
  char detail[128];
  expectOk(tf_get_named(simulation, name, &value), simulation, name);
  if (!(fabs(value - expected) <= tolerance * fmax(1, fabs(expected)))) {
    snprintf(detail, sizeof detail, "%.15g at t = %.15g, expected %.15g", value, tf_time(simulation), expected);
    fail(name, detail);
  }
}

/* The pull upwards: data is the acceleration of gravity. */
static double pull(void *data, double time, double segment) { return segment < 1 ? 0 : 2 * *(const double *)data * (time - 1); }

static double pullBreakpoint(void *data, double time) {
  (void)data;
  return time < 1 ? 1 : INFINITY;
}

typedef struct EventCounts {
  int count[TF_EVENT_COUNT];
  double impactTime, openingTime;
} EventCounts;

static void countEvent(void *data, const tf_event *event) {
  EventCounts *counts = data;
  ++counts->count[event->kind];
  if (event->kind == TF_EVENT_IMPACT)
    counts->impactTime = event->time;
  if (event->kind == TF_EVENT_OPENING)
    counts->openingTime = event->time;
}

static void setUp(tf_simulation *simulation, double *gravity, EventCounts *counts) {
  static const double times[] = {0, 1}, forces[] = {7, 7};
  *gravity = 9.81;
  memset(counts, 0, sizeof *counts);
  expectOk(tf_set(simulation, "mu", 0), simulation, "mu");
  expectOk(tf_set(simulation, "g", *gravity), simulation, "g");
  expectOk(tf_set(simulation, "q[2]", 1), simulation, "start of q[2]");
  expectOk(tf_set(simulation, "der(q[1])", 0), simulation, "start of der(q[1])");
  expectOk(tf_set_input_table(simulation, "u[1]", times, forces, 2, 0), simulation, "table of u[1]");
  expectOk(tf_set_input_callback(simulation, "u[2]", pull, pullBreakpoint, gravity), simulation, "callback of u[2]");
  expectOk(tf_set_tolerance(simulation, 1e-10), simulation, "tolerance");
  expectOk(tf_set_event_callback(simulation, countEvent, counts), simulation, "event callback");
}

static void checkFlight(tf_simulation *simulation, const EventCounts *counts) {
  const double g = 9.81;
  expectOk(tf_step(simulation, 0.4), simulation, "step to 0.4");
  expectNear(simulation, "q[1]", 3.5 * 0.4 * 0.4, 1e-8);
  expectNear(simulation, "q[2]", 1 - 0.5 * g * 0.4 * 0.4, 1e-8);
  expectOk(tf_step(simulation, 1), simulation, "step to 1");
  expectNear(simulation, "q[2]", 0, 1e-9);
  expectNear(simulation, "floor.normalForce", g, 1e-7);
  expectNear(simulation, "u[1]", 7, 0);
  if (counts->count[TF_EVENT_IMPACT] != 1 || !(fabs(counts->impactTime - sqrt(2 / g)) < 1e-8))
    fail("impact", "not once, or at another time");
}

/* Flight after t = 1.5: q[2]'' = 2 g (t - 1) - g. */
static void checkEnd(tf_simulation *simulation, const EventCounts *counts) {
  const double g = 9.81;
  expectNear(simulation, "q[1]", 31.5, 1e-8);
  expectNear(simulation, "q[2]", g * pow(1.5, 3) / 3, 1e-8);
  expectNear(simulation, "der(q[2])", g * 1.5 * 1.5, 1e-8);
  if (counts->count[TF_EVENT_OPENING] != 1 || !(fabs(counts->openingTime - 1.5) < 1e-8))
    fail("opening", "not once, or at another time");
}

/* Runs to the end twice from the same saved state: all values must be the same bits, in this and in another simulation of the same model.
 */
static void checkContinuation(tf_simulation *simulation, tf_simulation *other) {
  const size_t count = (size_t)tf_get_model(simulation)->variable_count, size = tf_state_size(simulation);
  double *values = calloc(2 * count, sizeof(double));
  void *state = malloc(size);
  int i;
  if (values == NULL || state == NULL)
    abort();
  expectOk(tf_save_state(simulation, state, size), simulation, "save");
  expectOk(tf_step(simulation, 3), simulation, "step to 3");
  expectOk(tf_get_all(simulation, values), simulation, "values");
  for (i = 0; i < 2; ++i) {
    tf_simulation *again = i == 0 ? simulation : other;
    expectOk(tf_restore_state(again, state, size), again, "restore");
    expectOk(tf_step(again, 3), again, "step to 3 again");
    expectOk(tf_get_all(again, values + count), again, "values again");
    if (memcmp(values, values + count, count * sizeof(double)) != 0)
      fail("continuation", i == 0 ? "differs after restoring" : "differs in another simulation");
  }
  if (tf_restore_state(simulation, state, size - 1) != TF_BAD_ARGUMENT)
    fail("restore", "accepts a truncated state");
  free(values);
  free(state);
}

static void checkErrors(tf_simulation *simulation) {
  if (tf_find(simulation, "no such variable") != -1)
    fail("find", "finds a variable that does not exist");
  if (tf_set(simulation, "mu", -0.5) != TF_BAD_ARGUMENT)
    fail("set", "accepts a value below the minimum");
  if (tf_step(simulation, 0) != TF_BAD_ARGUMENT || strlen(tf_error_text(simulation)) == 0)
    fail("step", "goes back in time");
}

/* Nothing of the compiler is in this process. */
static void checkMappedLibraries(void) {
  static const char *const unwanted[] = {"libLLVM", "libtfcodegen", "libclang", "liblld"};
  char line[4096];
  size_t i;
  FILE *maps = fopen("/proc/self/maps", "r");
  if (maps == NULL) {
    fail("/proc/self/maps", "cannot be read");
    return;
  }
  while (fgets(line, sizeof line, maps) != NULL)
    for (i = 0; i < sizeof unwanted / sizeof *unwanted; ++i)
      if (strstr(line, unwanted[i]) != NULL)
        fail("mapped library", line);
  fclose(maps);
}

int main(int argc, char **argv) {
  tf_simulation *simulation, *other;
  double gravity[2];
  EventCounts counts[2];
  if (argc != 2) {
    fprintf(stderr, "usage: libtf_example PARTICLE.so\n");
    return 2;
  }
  if (tf_load(argv[1], &simulation) != TF_OK || tf_load(argv[1], &other) != TF_OK) {
    fprintf(stderr, "%s\n", tf_error_text(simulation));
    return 1;
  }
  setUp(simulation, &gravity[0], &counts[0]);
  setUp(other, &gravity[1], &counts[1]);
  expectOk(tf_initialise(simulation, 0), simulation, "initialise");
  expectOk(tf_initialise(other, 0), other, "initialise the other");
  checkFlight(simulation, &counts[0]);
  checkContinuation(simulation, other);
  counts[0].count[TF_EVENT_OPENING] = 1; /* it was passed twice */
  checkEnd(simulation, &counts[0]);
  checkEnd(other, &counts[1]);
  checkErrors(simulation);
  checkMappedLibraries();
  printf("t = %g: q = (%g, %g), tau = %g, %lld steps\n", tf_time(simulation), tf_get(simulation, tf_find(simulation, "q[1]")),
         tf_get(simulation, tf_find(simulation, "q[2]")), tf_get(simulation, tf_find(simulation, "tau")),
         tf_get_statistics(simulation)->steps);
  tf_free(simulation);
  tf_free(other);
  return failures == 0 ? 0 : 1;
}
