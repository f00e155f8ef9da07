#include "tests/unit/runtime/hand_written_models.h"

#include "tests/unit/runtime/model_tables.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace tf::runtime::test {

namespace {

// Point mass in `n` dimensions above the floor (last coordinate = 0), force u. Parameters in the order m, g, mu, e, then those of the
// model.
template <int n, int rateParameter> struct Particle {
  static constexpr int tangents = n - 1, nx = 3 * n + 1;
  enum { m, g, mu, e };

  static void dynamics(In in, Out out, Mask) {
    const double *u = in[TF_IN_U], *p = in[TF_IN_P];
    std::fill_n(out[0], n * n, 0.0);
    for (int i = 0; i < n; ++i) {
      out[0][i * n + i] = p[m];
      out[1][i] = u[i];
    }
    out[1][n - 1] -= p[m] * p[g];
  }
  static void switching(In in, Out out, Mask mask) {
    if (selected(mask, 0)) {
      out[0][0] = in[TF_IN_Q][n - 1];
      out[1][0] = in[TF_IN_V][n - 1];
    }
    if (selected(mask, 1))
      std::copy_n(in[TF_IN_V], tangents, out[2]);
  }
  static void contactTerms(In in, Out out, Mask mask) {
    if (!selected(mask, 0))
      return;
    std::fill_n(out[0], n, 0.0);
    out[0][n - 1] = 1;
    out[1][0] = 0;
    std::fill_n(out[2], tangents * n, 0.0);
    for (int k = 0; k < tangents; ++k) {
      out[2][k * n + k] = 1;
      out[3][k] = out[5][k] = 0;
    }
    out[4][0] = in[TF_IN_P][mu];
  }
  static void contactParameters(In in, Out out, Mask) {
    out[0][0] = in[TF_IN_P][rateParameter];
    out[1][0] = in[TF_IN_P][e];
  }
  // d(M A - f)/du = -1; everything else is constant.
  static void dynamicsDerivatives(In, Out out, Mask mask) {
    std::fill_n(out[0], n * nx, 0.0);
    for (int i = 0; i < n; ++i)
      out[0][i * nx + 2 * n + i] = -1;
    if (!selected(mask, 0))
      return;
    std::fill_n(out[2], nx, 0.0);
    std::fill_n(out[3], tangents * nx, 0.0);
    std::fill_n(out[4], nx, 0.0);
    std::fill_n(out[5], tangents * nx, 0.0);
  }
  static double kineticEnergy(In in) {
    double square = 0;
    for (int i = 0; i < n; ++i)
      square += in[TF_IN_V][i] * in[TF_IN_V][i];
    return 0.5 * in[TF_IN_P][m] * square;
  }
  static void outputs(In in, Out out, Mask) { out[0][0] = kineticEnergy(in); }
  static void energies(In in, Out out, Mask) {
    const double *p = in[TF_IN_P];
    out[0][0] = kineticEnergy(in);
    out[1][0] = p[m] * p[g] * in[TF_IN_Q][n - 1];
    out[2][0] = 0;
    for (int i = 0; i < n; ++i)
      out[2][0] += in[TF_IN_U][i] * in[TF_IN_V][i];
  }

  static void setFunctions(tf_model &model) {
    model.dynamics = dynamics;
    model.switching = switching;
    model.contact_terms = contactTerms;
    model.contact_parameters = contactParameters;
    model.dynamics_derivatives = dynamicsDerivatives;
    model.outputs = outputs;
    model.energies = energies;
    model.nu = n;
    model.no = 1;
  }
};

void inputs(ModelTables &tables, int count) {
  for (int i = 0; i < count; ++i)
    tables.variable({.name = "u[" + std::to_string(i + 1) + "]",
                     .kind = TF_KIND_INPUT,
                     .index = i,
                     .flags = TF_SETTABLE,
                     .unit = "N",
                     .description = "applied force"});
}

void commonEnd(ModelTables &tables) { tables.variable({.name = "timeSpeed", .kind = TF_KIND_TIME_SPEED}); }

}  // namespace

const tf_model &particleModel() {
  static const auto tables = [] {
    auto built = std::make_unique<ModelTables>("Particle", "point mass above a rough floor");
    built->coordinates({"q[1]", "q[2]"}, "m");
    inputs(*built, 2);
    built->parameter("m", 1, TF_SETTABLE, "kg");
    built->parameter("g", 9.81, TF_SETTABLE, "m/s2");
    built->parameter("mu", 0, TF_SETTABLE, "", 0);
    built->parameter("e", 0, TF_SETTABLE, "", 0, 1);
    built->parameter("weight", 0, TF_SETTABLE | TF_BOUND, "N");
    built->parameter("rate", 0, TF_SETTABLE | TF_BOUND, "N");
    built->contact("floor", 1);
    built->variable({.name = "energy", .kind = TF_KIND_OUTPUT, .index = 0, .flags = TF_OUTPUT, .unit = "J"});
    commonEnd(*built);
    built->alias("x", "q[1]", 1);
    built->alias("vy", "der(q[2])", 1);
    built->alias("depth", "q[2]", -1);
    Particle<2, 5>::setFunctions(built->model());
    built->model().binding_depth = 2;
    built->model().bindings = [](In in, Out out, Mask) {
      const double *p = in[TF_IN_P];
      out[0][4] = p[0] * p[1];
      out[0][5] = p[4] / p[0];
    };
    built->model().starts = [](In, Out out, Mask) {
      out[0][0] = 0;
      out[0][1] = 1;
      std::fill_n(out[1], 2, 0.0);
      std::fill_n(out[3], 2, 0.0);
    };
    built->finish();
    return built;
  }();
  return tables->model();
}

const tf_model &particle3dModel() {
  static const auto tables = [] {
    auto built = std::make_unique<ModelTables>("Particle3D", "point mass on a rough floor in three dimensions");
    built->coordinates({"q[1]", "q[2]", "q[3]"}, "m");
    inputs(*built, 3);
    built->parameter("m", 1, TF_SETTABLE, "kg");
    built->parameter("g", 9.81, TF_SETTABLE, "m/s2");
    built->parameter("mu", 0.5, TF_SETTABLE, "", 0);
    built->parameter("e", 0, TF_SETTABLE, "", 0, 1);
    built->parameter("rate", 1, TF_SETTABLE, "N");
    built->contact("floor", 2);
    built->variable({.name = "energy", .kind = TF_KIND_OUTPUT, .index = 0, .flags = TF_OUTPUT, .unit = "J"});
    commonEnd(*built);
    Particle<3, 4>::setFunctions(built->model());
    built->model().starts = [](In, Out out, Mask) {
      std::fill_n(out[0], 3, 0.0);
      out[1][0] = 3;
      out[1][1] = 4;
      out[1][2] = 0;
      std::fill_n(out[3], 3, 0.0);
    };
    built->finish();
    return built;
  }();
  return tables->model();
}

namespace {

enum BeltParameter { beltMass, beltStiffness, beltLoad, beltFriction, beltSpeed };

void setBeltFunctions(tf_model &model) {
  model.starts = [](In, Out out, Mask) {
    out[0][0] = 0;
    out[1][0] = 0.3;
  };
  model.dynamics = [](In in, Out out, Mask) {
    out[0][0] = in[TF_IN_P][beltMass];
    out[1][0] = -in[TF_IN_P][beltStiffness] * in[TF_IN_Q][0];
  };
  model.switching = [](In in, Out out, Mask mask) {
    if (selected(mask, 0))
      out[2][0] = in[TF_IN_V][0] - in[TF_IN_P][beltSpeed];
  };
  model.contact_terms = [](In in, Out out, Mask mask) {
    if (!selected(mask, 0))
      return;
    out[2][0] = 1;
    out[3][0] = 0;
    out[5][0] = in[TF_IN_P][beltFriction] * in[TF_IN_P][beltLoad];
  };
  // x = (q, v, t).
  model.dynamics_derivatives = [](In in, Out out, Mask mask) {
    out[0][0] = in[TF_IN_P][beltStiffness];
    out[0][1] = out[0][2] = 0;
    if (!selected(mask, 0))
      return;
    std::fill_n(out[3], 3, 0.0);
    std::fill_n(out[5], 3, 0.0);
  };
  model.energies = [](In in, Out out, Mask) {
    const double x = in[TF_IN_Q][0], v = in[TF_IN_V][0];
    out[0][0] = 0.5 * in[TF_IN_P][beltMass] * v * v;
    out[1][0] = 0.5 * in[TF_IN_P][beltStiffness] * x * x;
    out[2][0] = 0;
  };
}

void setRelayFunctions(tf_model &model) {
  model.starts = [](In, Out out, Mask) {
    out[2][0] = 1;
    out[2][1] = 0;
  };
  model.dynamics = [](In in, Out out, Mask) {
    const double sign = 2 * in[TF_IN_ALPHA][0] - 1;
    out[2][0] = -2 * sign + in[TF_IN_P][0] * std::cos(in[TF_IN_TIME][0]);
    out[2][1] = sign;
  };
  model.switching = [](In in, Out out, Mask mask) {
    if (selected(mask, 0))
      out[3][0] = in[TF_IN_Z][0];
  };
  // x = (z, t).
  model.switch_gradients = [](In, Out out, Mask mask) {
    if (!selected(mask, 0))
      return;
    out[0][0] = 1;
    out[0][1] = out[0][2] = 0;
  };
  model.step_derivatives = [](In, Out out, Mask) {
    out[1][0] = -4;
    out[1][1] = 2;
  };
  model.dynamics_derivatives = [](In in, Out out, Mask) {
    std::fill_n(out[1], 6, 0.0);
    out[1][2] = -in[TF_IN_P][0] * std::sin(in[TF_IN_TIME][0]);
  };
  model.energies = [](In, Out out, Mask) { out[0][0] = out[1][0] = out[2][0] = 0; };
  model.nz = 2;
}

}  // namespace

const tf_model &beltModel() {
  static const auto tables = [] {
    auto built = std::make_unique<ModelTables>("StickSlip", "mass on a spring, dragged by a moving belt");
    built->coordinates({"x"}, "m");
    built->parameter("m", 1, TF_SETTABLE, "kg");
    built->parameter("k", 4, TF_SETTABLE, "N/m");
    built->parameter("N", 2, TF_SETTABLE, "N");
    built->parameter("mu", 0.5, TF_SETTABLE, "");
    built->parameter("belt", 0.3, TF_SETTABLE, "m/s");
    built->friction("dry");
    commonEnd(*built);
    setBeltFunctions(built->model());
    built->finish();
    return built;
  }();
  return tables->model();
}

const tf_model &relayModel() {
  static const auto tables = [] {
    auto built = std::make_unique<ModelTables>("Relay", "x is driven to the surface x = 0 and slides on it");
    const char *const names[] = {"x", "z"};
    for (int i = 0; i < 2; ++i)
      built->variable({.name = names[i], .kind = TF_KIND_STATE, .index = i, .flags = TF_FIXED | TF_SETTABLE});
    for (int i = 0; i < 2; ++i)
      built->variable({.name = std::string("der(") + names[i] + ")", .kind = TF_KIND_STATE_DERIVATIVE, .index = i});
    built->parameter("k", 1, TF_SETTABLE, "");
    built->switchFunction("x > 0", TF_SWITCH_SLIDING, false);
    commonEnd(*built);
    setRelayFunctions(built->model());
    built->finish();
    return built;
  }();
  return tables->model();
}

}  // namespace tf::runtime::test
