/* What a compiled TF model is: a shared library that exports one constant `tf_model` under the name TF_MODEL_SYMBOL.
 *
 * The model is the controlled complementarity Lagrangian system (CLS)
 *     q' = N(q) v,   M(q, t) v' = f(t, q, v, z, u, p, alpha) + Jn^T ln + Jt^T lt + H^T nu,   z' = g(t, q, v, z, u, p, alpha)
 * with nc unilateral contacts (normal forces ln >= 0), nt tangential rows (of contacts with slip, then of friction elements;
 * forces lt), nh constraint rows (multipliers nu) and ns switching functions c_j(t, q, v, z, u) with step variables alpha_j in [0, 1]
 * (1 where c_j > 0). Rotations have four coordinates, a unit quaternion (w, x, y, z) that takes vectors of the body's frame to the world's,
 * and three velocities, the angular velocity in the body's frame; elsewhere N is the identity: nv = nq - nr.
 *
 * Generated functions are pure: no allocation, no input or output, no globals. All have the signature tf_function:
 * `in[k]` points to the array of TF_IN k, `out[k]` to the array that the function's comment lists as number k. Matrices are row-major.
 * `mask` selects rows where a function says so (mask[i] == 0: row i of the masked outputs is left untouched); where it says nothing,
 * mask may be null. Output arrays must not overlap input arrays. Values are SI or the model's own units. No function ever reads beyond the
 * lengths of the model's table.
 */
#ifndef TF_MODEL_H
#define TF_MODEL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TF_ABI_VERSION 16u
#define TF_MAGIC 0x54464D31u /* "TFM1" */
#define TF_MODEL_SYMBOL "tf_model_v1"

/* Argument arrays and their lengths. */
enum tf_in {
  TF_IN_TIME = 0,        /* 1: physical time */
  TF_IN_Q = 1,           /* nq: coordinates */
  TF_IN_V = 2,           /* nv: velocities */
  TF_IN_Z = 3,           /* nz: continuous states */
  TF_IN_U = 4,           /* nu: inputs */
  TF_IN_P = 5,           /* np: parameters */
  TF_IN_ALPHA = 6,       /* ns: step variables */
  TF_IN_A = 7,           /* nv: accelerations v' */
  TF_IN_NORMAL = 8,      /* nc: normal forces */
  TF_IN_TANGENT = 9,     /* nt: tangential forces */
  TF_IN_ZDOT = 10,       /* nz: z' */
  TF_IN_MULTIPLIER = 11, /* nh: multipliers of constraint rows */
  TF_IN_RADIUS = 12,     /* nq + 1: half the width of a box around q, then around the time */
  TF_IN_DIRECTIONS = 13, /* nv x TF_DIRECTIONS: velocities, one direction in each column */
  TF_IN_COUNT = 14
};

/* Directions that are followed at once. */
#define TF_DIRECTIONS 8

typedef void (*tf_function)(const double *const *in, double *const *out, const uint8_t *mask);

/* The columns of every derivative matrix: x = (q, v, z, u, t), nx = nq + nv + nz + nu + 1. */

/* What a variable's value is. Index counts within the kind. */
enum tf_kind {
  TF_KIND_TIME = 0,
  TF_KIND_NUMERICAL_TIME = 1, /* tau */
  TF_KIND_COORDINATE = 2,     /* q */
  TF_KIND_VELOCITY = 3,       /* v */
  TF_KIND_ACCELERATION = 4,   /* v' */
  TF_KIND_STATE = 5,          /* z */
  TF_KIND_STATE_DERIVATIVE = 6,
  TF_KIND_INPUT = 7,
  TF_KIND_PARAMETER = 8,
  TF_KIND_OUTPUT = 9,          /* of the function `outputs` */
  TF_KIND_GAP = 10,            /* contact index */
  TF_KIND_NORMAL_FORCE = 11,   /* contact index */
  TF_KIND_TANGENT_FORCE = 12,  /* tangential row */
  TF_KIND_SLIP = 13,           /* tangential row */
  TF_KIND_CLOSED = 14,         /* contact index, 0/1 */
  TF_KIND_STICKING = 15,       /* tangential row, 0/1 */
  TF_KIND_IMPULSE = 16,        /* contact index: accumulated normal impulse of impacts */
  TF_KIND_TIME_SPEED = 17,     /* dt/dtau = beta */
  TF_KIND_STEP_VARIABLE = 18,  /* alpha_j of switch j */
  TF_KIND_GAP_STEP = 19,       /* contact index: alpha_1, 0 while closed */
  TF_KIND_GAP_RATE_STEP = 20,  /* contact index: alpha_2, 1 - push while closed */
  TF_KIND_SLIP_STEP = 21,      /* tangential row: alpha_3 */
  TF_KIND_PUSH = 22,           /* contact index: (1 - alpha_1)(1 - alpha_2), the weight of its auxiliary fields */
  TF_KIND_THETA_BACKWARD = 23, /* tangential row: push alpha_3, of the field with friction against positive slip */
  TF_KIND_THETA_FORWARD = 24,  /* tangential row: push (1 - alpha_3) */
  TF_KIND_MULTIPLIER = 25,     /* constraint row: the force along its increasing residual */
  TF_KIND_KINETIC_ENERGY = 26,
  TF_KIND_POTENTIAL_ENERGY = 27,
  TF_KIND_FRICTION_LOSS = 28, /* dissipated by friction while time runs */
  TF_KIND_IMPACT_LOSS = 29,   /* lost in impacts */
  TF_KIND_WORK = 30           /* of inputs, applied forces, moving boundaries and time-dependent constraints */
};

enum tf_variable_flags {
  TF_FIXED = 1,      /* the start is exact, not a guess */
  TF_SETTABLE = 2,   /* parameters and starts that --set may change (not final, protected or structural) */
  TF_STRUCTURAL = 4, /* a parameter whose value is compiled in */
  TF_BOOLEAN = 8,
  TF_INTEGER = 16,
  TF_BOUND = 32,  /* a parameter whose value is computed from others unless it is set */
  TF_OUTPUT = 64, /* declared `output` */
  TF_PROTECTED = 128
};

typedef struct tf_location {
  const char *file;
  int32_t line, column; /* from 1 */
} tf_location;

typedef struct tf_variable {
  const char *name; /* scalar: "q[2]", "der(q[2])", "floor.normalForce" */
  const char *unit; /* "" where none */
  const char *description;
  int32_t kind; /* enum tf_kind */
  int32_t index;
  int32_t flags;
  double min, max, nominal; /* -inf, inf, 1 where not given */
  tf_location location;
} tf_variable;

/* Another name of a variable: `v` where `Real v = der(x)`. value = sign * value of the variable. */
typedef struct tf_alias {
  const char *name;
  const char *description;
  int32_t variable; /* in the table of variables */
  double sign;
} tf_alias;

enum tf_impact_law { TF_LAW_POISSON = 0, TF_LAW_STRONGE = 1, TF_LAW_NEWTON = 2 };

/* How a slip of two components is opposed. */
enum tf_friction_form {
  TF_FRICTION_EXACT = 0,     /* its two rows share the disk |lt| <= limit */
  TF_FRICTION_RELAXED = 1,   /* with c3 = |slip| - slip radius, see below */
  TF_FRICTION_POLYHEDRAL = 2 /* rows along several directions, each |lt| <= limit on its own */
};

/* The rows of a relaxed form: the two components of the slip, which take part in impacts only, as those of the exact form, and two that
   take part while time runs, each |lt| <= limit on its own. With s = |slip| - radius outside of the disk, (slip^2 - radius^2)/(2 radius)
   inside, which are not affine in v as all others are: steady (s + radius), which is positive, and edge s. Their forces add up to limit
   outside, against the slip, and to (edge - steady) limit at the edge inside, along it. */
#define TF_RELAXED_ROWS 4
#define TF_RELAXED_STEADY_ROW 2
#define TF_RELAXED_EDGE_ROW 3
#define TF_RELAXED_STEADY 0.4999995
#define TF_RELAXED_EDGE 0.5000005

typedef struct tf_contact {
  const char *name;
  int32_t tangent_first, tangent_count; /* its tangential rows: 0, 1 or 2, 4 of a relaxed form, or the directions of a polyhedral one */
  int32_t friction_form;                /* enum tf_friction_form; TF_FRICTION_EXACT of slips of one component */
  int32_t law;                          /* enum tf_impact_law */
  double nominal;                       /* length scale of the gap */
  tf_location location;
  int32_t friction_varies; /* 1: its coefficient depends on more than parameters, so that it may be zero at one instant only */
  int32_t gap_is_affine;   /* 1: nr = 0, and its gap is an affine function of the coordinates, with coefficients that are parameters' */
} tf_contact;

typedef struct tf_friction { /* a friction element: tangential rows with a bound instead of a normal force */
  const char *name;
  int32_t tangent_first, tangent_count;
  int32_t friction_form; /* enum tf_friction_form */
  tf_location location;
  int32_t bound_by_velocity; /* 1: its bound depends on velocities, so that it may have a peak where the slip is zero */
} tf_friction;

typedef struct tf_constraint {
  const char *name;
  int32_t row_first, row_count;
  int32_t holonomic; /* 1: g(q, t) = 0; 0: A(q, t) v + b(q, t) = 0 */
  double nominal;    /* scale of the residual */
  tf_location location;
} tf_constraint;

enum tf_switch_kind {
  TF_SWITCH_SLIDING = 0,    /* discontinuous across c = 0: a sliding mode is possible */
  TF_SWITCH_CONTINUOUS = 1, /* abs, min, max: located, no sliding */
  TF_SWITCH_TIME = 2,       /* c depends on time and parameters only: a time event */
  TF_SWITCH_REST = 3        /* alpha = 1 while the c of an earlier switch, which is this one's too, stays 0 without sliding, else 0 */
};

typedef struct tf_switch {
  const char *text; /* the condition as written, "x > 0" */
  int32_t kind;
  int32_t zero_is_positive; /* on c = 0, off any sliding, the relation as written has alpha = 1 (>=) or 0 (>) */
  tf_location location;
  int32_t of; /* TF_SWITCH_REST: that switch; else -1 */
} tf_switch;

/* On what a function depends explicitly. */
enum tf_variation { TF_VARIES_WITH_TIME = 1, TF_VARIES_WITH_INPUTS = 2 };

/* What may change at a place and be the same on both sides of it, as functions of the coordinates with exp or tanh, or that noEvent or
   smooth chooses. */
enum tf_locality { TF_LOCAL_GUARDS = 1 /* gaps, c */, TF_LOCAL_FORCES = 2 /* what accelerations follow from */ };

typedef struct tf_model {
  uint32_t magic, abi_version;
  const char *name, *description;
  const char *generator; /* "tfc 0.1.0" */
  const char *hash;      /* of everything that the code was made from */

  int32_t nq, nv, nz, nu, np, nc, nt, ns, no, nf; /* nf: friction elements */
  int32_t nr, nk, nh;                             /* rotations, constraint elements, constraint rows */
  int32_t variable_count, alias_count;
  const tf_variable *variables; /* in the order of the result columns; the first two are time and tau */
  const tf_alias *aliases;
  const tf_contact *contacts;       /* nc */
  const tf_friction *frictions;     /* nf */
  const tf_switch *switches;        /* ns */
  const tf_constraint *constraints; /* nk; rows in order, without gaps */
  const int32_t *quaternions;       /* nr: the first coordinate of each unit quaternion */
  const double *parameters;         /* np: the values of unbound parameters (0 for bound ones) */
  int32_t binding_depth;            /* bindings must be evaluated this often for all bound parameters to be right */
  int32_t mass_is_constant;         /* M depends on parameters only */
  int32_t mass_products;            /* `dynamics` has them */
  int32_t locality;                 /* bits of tf_locality */
  int32_t uniform_flight;           /* nz = nh = nr = 0, and f depends on parameters only as well: free flight has constant accelerations */
  /* Entries of M below the diagonal that may differ from zero: mass_columns[mass_rows[i]] ... mass_columns[mass_rows[i + 1] - 1] of row i,
     ascending. mass_rows: nv + 1; null where all entries may. */
  const int32_t *mass_rows, *mass_columns;
  /* What varies beside the state, by the bits of tf_variation: gaps [nc], slips [nt], c [ns], then one entry for everything that contact
     forces and sliding step variables follow from (f, z', M, the contact terms and the constraints' rows). Null where nothing does. */
  const int32_t *variation;
  double start_time, stop_time, tolerance, interval; /* of annotation(experiment); NaN where not given */

  /* in: P. out: 0 values [np] of bound parameters out of the others. */
  tf_function bindings;
  /* in: TIME, P. out: 0 q [nq], 1 v [nv], 2 z [nz], 3 u [nu]: the starts. */
  tf_function starts;
  /* in: TIME, Q, V. out: 0 q' = N(q) v [nq]. Null where nq = nv and q' = v. */
  tf_function kinematics;
  /* in: TIME, Q, V. out: 0 N [nq x nv], 1 d(N v)/dq [nq x nq]. Null where `kinematics` is. */
  tf_function kinematics_derivatives;
  /* in: TIME, Q, V, Z, U, P, ALPHA. out: 0 M [nv x nv] symmetric, both halves; 1 f [nv], all forces but those of contacts, frictions and
     constraints, less the bias terms of M v'; 2 z' [nz]. Where mass_products and a mask are given, in: DIRECTIONS as well, out: 3 their
     products with M [nv x TF_DIRECTIONS], which cost less than M; of 0 entries that are zero everywhere at most. The mask is not read. */
  tf_function dynamics;
  /* in: TIME, Q, V, Z, U, P, ALPHA. out: 0 gap [nc], 1 its rate [nc] = Jn v + d gap/dt, 2 slip [nt], 3 c [ns]. mask:
     2 nc + nf + 1 bytes, gap and rate of each contact, slips of each contact, slip of each friction element, all c. */
  tf_function switching;
  /* in: TIME, Q, V, Z, U, P, ALPHA. out: 0 Jn [nc x nv], 1 normal bias [nc]: gap'' = Jn v' + bias, 2 Jt [nt x nv], 3 tangential bias [nt]:
     slip' = Jt v' + bias (without du/dt terms: slips do not depend on inputs), 4 friction coefficient mu [nc], 5 bound [nt] of friction
     elements' rows (0 on contacts' rows). mask: nc + nf bytes, contacts then friction elements. */
  tf_function contact_terms;
  /* in: P. out: 0 rate a_n [nc], 1 restitution [nc]. */
  tf_function contact_parameters;
  /* in: TIME, Q, V, P. out: 0 residual [nh]: g(q, t) of holonomic rows, A v + b of the others; 1 rate [nh]: dg/dt, and A v + b again; 2 H
     [nh x nv]: d rate/dv; 3 bias [nh]: d rate/dt = H v' + bias. Masked by blocks: mask[0] outputs 0 and 1, mask[1] outputs 2 and 3.
     Null where nh = 0. */
  tf_function constraint_terms;
  /* in: TIME, Q, V, Z, U, P, ALPHA. out: 0 dc/dx [ns x nx]. mask: ns bytes. */
  tf_function switch_gradients;
  /* in: TIME, Q, V, Z, U, P, ALPHA. out: 0 df/dalpha [nv x ns], 1 dz'/dalpha [nz x ns]. */
  tf_function step_derivatives;
  /* All first derivatives of the dynamics at fixed alpha, v' = A, ln = NORMAL, lt = TANGENT, nu = MULTIPLIER.
     in: all but ZDOT. out: 0 d(M A - f - Jn^T ln - Jt^T lt - H^T nu)/dx [nv x nx], 1 dz'/dx [nz x nx], 2 d(Jn A + bias)/dx [nc x nx],
     3 d(Jt A + bias)/dx [nt x nx], 4 dmu/dx [nc x nx], 5 dbound/dx [nt x nx], 6 d(H A + bias)/dx [nh x nx] (where nh > 0).
     mask: nc + nf bytes, rows of 2..5. Output 0 has the terms of all forces: those of contacts and friction elements that are not
     selected must be 0. */
  tf_function dynamics_derivatives;
  /* in: all. out: 0 outputs [no]. */
  tf_function outputs;
  /* in: TIME, Q, V, Z, U, P, ALPHA, A. out: 0 kinetic energy [1], 1 potential energy [1] (gravity and potential elements), 2 power [1] of
     everything else that is applied: force elements and what drives positions and energies by their explicit dependence on time and states.
     d(kinetic + potential)/dt = power + (Jn v).ln + (Jt v).lt + (H v).nu at constant inputs. */
  tf_function energies;
  /* `dynamics` and `contact_terms` at one point, with what they have in common evaluated once. in: TIME, Q, V, Z, U, P, ALPHA. out: 0..2
     those of `dynamics`, 3..8 those of `contact_terms`. mask: that of `contact_terms`. Null: both are to be called (no contacts and
     friction elements, or so many that the code would be there twice without need). */
  tf_function contact_dynamics;
  /* in: TIME, Q, P, ALPHA, RADIUS. out: 0 gap [nc], 1 by how much each gap can differ from it at most (to rounding) [nc] while q and the
     time differ from Q and TIME by at most RADIUS, whatever the step variables become; infinite or not a number where no bound is known.
     Null: so few contacts that all gaps are read as fast. */
  tf_function gap_bounds;
} tf_model;

#ifdef __cplusplus
}
#endif

#endif
