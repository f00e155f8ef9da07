/* libtf: simulation of compiled TF models, without compiler and front end. C API, one header.
 *
 * Every function that can fail returns a tf_status; tf_error_text(simulation) says what went wrong in the latest call that failed, in terms
 * of the model. Indices of values are those of tf_find. Units are the model's. A simulation is not shared between threads; different
 * simulations are independent.
 *
 * An exception that a callback throws ends the call that it was called from, with TF_FAILED and the exception's text: a run behind the step
 * of the callback, from where it can go on; one of an input at the last good point.
 */
#ifndef TF_H
#define TF_H

#include "runtime/abi/tf_model.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tf_status {
  TF_OK = 0,
  TF_TERMINATED = 1,   /* the model ended the simulation */
  TF_BAD_ARGUMENT = 2, /* unknown name, wrong phase, bad file */
  TF_FAILED = 3        /* the run failed; results up to the failure are valid */
} tf_status;

typedef enum tf_integrator { TF_AUTO = 0, TF_STEP = 1, TF_CVODE = 2, TF_EXPLICIT = 3 } tf_integrator;

typedef enum tf_event_kind {
  TF_EVENT_IMPACT = 0,
  TF_EVENT_OPENING,
  TF_EVENT_CLOSING,
  TF_EVENT_STICK,
  TF_EVENT_SLIP,
  TF_EVENT_SLIP_REVERSAL,
  TF_EVENT_SLIDING,
  TF_EVENT_REST,
  TF_EVENT_PAINLEVE,
  TF_EVENT_TIME,
  TF_EVENT_STATE,
  TF_EVENT_TERMINATE,
  TF_EVENT_COUNT
} tf_event_kind;

typedef struct tf_event {
  double time, tau;
  int32_t kind;                 /* tf_event_kind */
  int32_t element;              /* contact index; nc + friction index; nc + nf + switch index; -1 for none */
  const double *before, *after; /* q, v, z [nq + nv + nz] */
} tf_event;

/* What a run has to tell beside its events. */
typedef enum tf_note_kind {
  TF_NOTE_INTEGRATOR = 0, /* another integrator goes on: which one and why, "cvode: stiff" */
  TF_NOTE_REDUNDANT = 1   /* a constraint follows from others: which ones, and where it is declared */
} tf_note_kind;

typedef struct tf_note {
  double time, tau;
  int32_t kind; /* tf_note_kind */
  const char *text;
  const double *state; /* q, v, z [nq + nv + nz] */
} tf_note;

typedef struct tf_statistics {
  long long steps, rejected_steps, evaluations, jacobians, newton_iterations, contact_solves, frozen_phases, breakpoints,
      events[TF_EVENT_COUNT];
  long long cvode_steps, explicit_steps, step_steps;
  double cvode_time, explicit_time, step_time; /* physical time that each integrator has covered */
  /* How often another integrator took over: because stability limited the steps of the explicit one; because the tolerance could not be
   * met; for slips of two components that start from zero, which are stiff at first; for low bounces beside cvode. */
  long long stiff_changes, failure_changes, launch_changes, bounce_changes;
  double worst_residual;        /* of all contact problems at acceleration level, relative to their scale */
  double worst_impact_residual; /* of all impacts, relative to the largest velocity, at least 1 */
  /* Over outputs and steps with samples, with tf_set_energy_balance over all steps: least gap, least normal force (infinity without
   * contacts), largest residual of a constraint or of its rate, largest error of the energy balance relative to the largest energy, or to
   * that which has passed through the system; and where and when. Of samples inside steps, which are as exact as the tolerance, clear
   * penetration only. */
  double worst_gap, worst_normal_force, worst_constraint, worst_energy_error;
  double worst_gap_time, worst_normal_force_time, worst_constraint_time, worst_energy_error_time;
  int32_t worst_gap_contact, worst_normal_force_contact, worst_constraint_element;
  double largest_normal_force;   /* over the same points: what the least one is measured against */
  int32_t redundant_constraints; /* constraint rows that follow from others, the most so far */
  /* With tf_set_energy_balance: length of the steps inside which the motion could not be evaluated everywhere, so that work and loss by
   * friction are estimated from the rest of them. */
  double estimated_energy_time;
  /* Of the explicit steps and of their time: the part of the stabilised method, which follows damping that is stiff. */
  long long stabilised_steps;
  double stabilised_time;
} tf_statistics;

typedef struct tf_simulation tf_simulation;

/* Loads a compiled model from a shared library. *simulation is set even on failure, so that the error text can be read; free it. */
tf_status tf_load(const char *path, tf_simulation **simulation);
/* A simulation of a model that is already in memory; the model must outlive it. */
tf_status tf_create(const tf_model *model, tf_simulation **simulation);
void tf_free(tf_simulation *simulation);
const char *tf_error_text(const tf_simulation *simulation);
const tf_model *tf_get_model(const tf_simulation *simulation);

/* Variable's number by name or alias, -1 if there is none. */
int32_t tf_find(const tf_simulation *simulation, const char *name);

/* Before tf_initialise: parameters, starts of coordinates, velocities and states; set later they (and tolerance, integrator, step options,
 * longest step, energy balance, sensitivities) end the run, which then begins anew with tf_initialise. Also inputs, held constant, at any
 * time. */
tf_status tf_set(tf_simulation *simulation, const char *name, double value);
/* An input's table: count points (times nondecreasing); zero-order hold or linear interpolation; the last value is held. Copied. */
tf_status tf_set_input_table(tf_simulation *simulation, const char *name, const double *times, const double *values, size_t count,
                             int linear);
/* An input by callback. `value` must be smooth between the breakpoints that `next_breakpoint` returns (the first one after time, infinity
 * for none; null: no breakpoints); `segment` is a time inside the smooth piece that is meant. */
typedef double (*tf_input_value)(void *data, double time, double segment);
typedef double (*tf_input_breakpoint)(void *data, double time);
tf_status tf_set_input_callback(tf_simulation *simulation, const char *name, tf_input_value value, tf_input_breakpoint next_breakpoint,
                                void *data);

tf_status tf_set_tolerance(tf_simulation *simulation, double tolerance);
tf_status tf_set_integrator(tf_simulation *simulation, tf_integrator integrator);
/* Step integrator: number of Radau IIA stages 1..4 (0: chosen by tolerance) and a fixed step (0: error-controlled). */
tf_status tf_set_step_options(tf_simulation *simulation, int stages, double fixed_step);
/* No step of any integrator is longer (infinity: as long as the errors allow): against forces of time or place that act for a small part of
 * a step in which the motion is simple otherwise. */
tf_status tf_set_longest_step(tf_simulation *simulation, double length);
/* Keeps account of work and losses (on != 0): the results energy.work, energy.frictionLoss and energy.impactLoss, NaN without it, and the
 * balance's error in the statistics, where all worst values are then taken over all steps. It costs a few evaluations of the model in each
 * step. Off at first. */
tf_status tf_set_energy_balance(tf_simulation *simulation, int on);
/* Forward sensitivities: the run is differentiated by the named parameters, starts (of coordinates, velocities, states) and inputs (a
 * constant added to them), across switches and impacts. Replaces an earlier list; count 0 ends it. */
tf_status tf_set_sensitivities(tf_simulation *simulation, const char *const *names, size_t count);
/* Derivatives of all variables by name number `column` of that list, at the current point, in the order of model->variables. Work, losses
 * and impulses are not differentiated (0). */
tf_status tf_get_sensitivity(tf_simulation *simulation, size_t column, double *values);
/* In an event callback: the same just before the event. */
tf_status tf_get_sensitivity_before(tf_simulation *simulation, size_t column, double *values);
/* Called at every event, in order. */
typedef void (*tf_event_callback)(void *data, const tf_event *event);
tf_status tf_set_event_callback(tf_simulation *simulation, tf_event_callback callback, void *data);

/* Called with every note, in order; the text is valid during the call. The first integrator is no note. */
typedef void (*tf_note_callback)(void *data, const tf_note *note);
tf_status tf_set_note_callback(tf_simulation *simulation, tf_note_callback callback, void *data);

/* Evaluates parameters and starts and resolves contacts and an impact at the start time. */
tf_status tf_initialise(tf_simulation *simulation, double start_time);
/* Advances to `time` exactly; on failure the state is that of the last good point (tf_time). */
tf_status tf_step(tf_simulation *simulation, double time);
/* As tf_step to `end`; on the way `callback` is called at samples, which end no step: their values are those inside it, to the tolerance.
 * The first one is at `first_sample` >= tf_time; each call gives the time of the next one, which is later (infinity: no more; not a number:
 * the run ends behind the sample, TF_TERMINATED). Samples at `end` and behind it are not taken; one at the time of an event comes after the
 * event. The callback has the time that was asked for, and can read the values of its sample. */
typedef double (*tf_sample_callback)(void *data, double time);
tf_status tf_run(tf_simulation *simulation, double end, double first_sample, tf_sample_callback callback, void *data);
double tf_time(const tf_simulation *simulation);

/* Value of variable number `index` at the current point; tf_get_all: all of model->variables, in order. */
double tf_get(tf_simulation *simulation, int32_t index);
tf_status tf_get_all(tf_simulation *simulation, double *values);
/* In an event callback: all variables just before the event (tf_get_all gives them just after it). */
tf_status tf_get_all_before(tf_simulation *simulation, double *values);
/* Value by name or alias. */
tf_status tf_get_named(tf_simulation *simulation, const char *name, double *value);

/* Complete state, with sensitivities and the account of energy where they are asked for: only a simulation that has the same takes it, and
   with constant inputs that have been set and that the next step will take; tables and callbacks are those of the simulation. The
   integration begins anew where it is saved as where it is restored: with the same calls from there on, further saves among them, both
   continue bit-identically. Size in bytes by tf_state_size. */
size_t tf_state_size(const tf_simulation *simulation);
tf_status tf_save_state(const tf_simulation *simulation, void *buffer, size_t size);
tf_status tf_restore_state(tf_simulation *simulation, const void *buffer, size_t size);

const tf_statistics *tf_get_statistics(const tf_simulation *simulation);

#ifdef __cplusplus
}
#endif

#endif
