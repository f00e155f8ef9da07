#include "tests/unit/runtime/hand_written_models.h"
#include "tests/unit/runtime/model_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace tf::runtime::test {

namespace {

struct Point {
  double x, y;  // in the body's frame
};

struct Rod {
  static constexpr std::array points{Point{-0.5, 0}, Point{0.5, 0}};
  static constexpr std::array names{"left", "right"};
  static constexpr double mass = 1, inertia = 1.0 / 12, friction = 0.3;
  static std::array<double, 3> q0() { return {0, 0.5 * std::sin(std::numbers::pi / 4) + 0.5, std::numbers::pi / 4}; }
  static constexpr std::array<double, 3> v0{2, 0, 0};
};

struct Box {
  static constexpr std::array points{Point{-0.5, -0.3}, Point{0.5, -0.3}, Point{0.5, 0.3}, Point{-0.5, 0.3}};
  static constexpr std::array names{"corner[1]", "corner[2]", "corner[3]", "corner[4]"};
  static constexpr double mass = 1, inertia = 1.36 / 12, friction = 0.2;
  static std::array<double, 3> q0() { return {0, 1, 0.9}; }
  static constexpr std::array<double, 3> v0{3, 0, 4};
};

// A point's height above the centre h = sin(th) bx + cos(th) by and its derivative dh/dth = r = cos(th) bx - sin(th) by; dr/dth = -h.
// gap = y + h, d gap/dt = vy + r w, gap'' = vy' + r w' - h w^2; slip = vx - h w, slip' = vx' - h w' - r w^2.
template <class Body> struct PlanarBody {
  static constexpr int nc = static_cast<int>(Body::points.size()), nx = 7;
  enum { m, J, g, mu, e, rate };

  struct Arm {
    double h, r;
  };
  static Arm arm(In in, int i) {
    const double s = std::sin(in[TF_IN_Q][2]), c = std::cos(in[TF_IN_Q][2]);
    const Point &point = Body::points[static_cast<std::size_t>(i)];
    return {s * point.x + c * point.y, c * point.x - s * point.y};
  }

  static void starts(In, Out out, Mask) {
    const auto q0 = Body::q0();
    std::copy_n(q0.data(), 3, out[0]);
    std::copy_n(Body::v0.data(), 3, out[1]);
  }
  static void dynamics(In in, Out out, Mask) {
    const double *p = in[TF_IN_P];
    std::fill_n(out[0], 9, 0.0);
    out[0][0] = out[0][4] = p[m];
    out[0][8] = p[J];
    out[1][0] = out[1][2] = 0;
    out[1][1] = -p[m] * p[g];
  }
  static void switching(In in, Out out, Mask mask) {
    const double *q = in[TF_IN_Q], *v = in[TF_IN_V];
    for (int i = 0; i < nc; ++i) {
      const Arm a = arm(in, i);
      if (selected(mask, i)) {
        out[0][i] = q[1] + a.h;
        out[1][i] = v[1] + a.r * v[2];
      }
      if (selected(mask, nc + i))
        out[2][i] = v[0] - a.h * v[2];
    }
  }
  static void contactTerms(In in, Out out, Mask mask) {
    const double w = in[TF_IN_V][2];
    for (int i = 0; i < nc; ++i) {
      if (!selected(mask, i))
        continue;
      const Arm a = arm(in, i);
      double *normal = out[0] + 3 * i, *tangent = out[2] + 3 * i;
      normal[0] = 0;
      normal[1] = 1;
      normal[2] = a.r;
      out[1][i] = -a.h * w * w;
      tangent[0] = 1;
      tangent[1] = 0;
      tangent[2] = -a.h;
      out[3][i] = -a.r * w * w;
      out[4][i] = in[TF_IN_P][mu];
      out[5][i] = 0;
    }
  }
  static void contactParameters(In in, Out out, Mask) {
    std::fill_n(out[0], nc, in[TF_IN_P][rate]);
    std::fill_n(out[1], nc, in[TF_IN_P][e]);
  }
  // x = (q, v, t): columns 2 (th) and 5 (w) only.
  static void dynamicsDerivatives(In in, Out out, Mask mask) {
    const double w = in[TF_IN_V][2], angularAcceleration = in[TF_IN_A][2];
    std::fill_n(out[0], 3 * nx, 0.0);
    for (int i = 0; i < nc; ++i) {
      if (!selected(mask, i))
        continue;
      const Arm a = arm(in, i);
      out[0][2 * nx + 2] += a.h * in[TF_IN_NORMAL][i] + a.r * in[TF_IN_TANGENT][i];
      for (int block = 2; block <= 5; ++block)
        std::fill_n(out[block] + nx * i, nx, 0.0);
      out[2][nx * i + 2] = -a.h * angularAcceleration - a.r * w * w;
      out[2][nx * i + 5] = -2 * a.h * w;
      out[3][nx * i + 2] = -a.r * angularAcceleration + a.h * w * w;
      out[3][nx * i + 5] = -2 * a.r * w;
    }
  }
  static void energies(In in, Out out, Mask) {
    const double *p = in[TF_IN_P], *v = in[TF_IN_V];
    out[0][0] = 0.5 * (p[m] * (v[0] * v[0] + v[1] * v[1]) + p[J] * v[2] * v[2]);
    out[1][0] = p[m] * p[g] * in[TF_IN_Q][1];
    out[2][0] = 0;
  }
  static void outputs(In in, Out out, Mask) {
    double energy[3];
    double *const blocks[] = {energy, energy + 1, energy + 2};
    energies(in, blocks, nullptr);
    out[0][0] = energy[0] + energy[1];
  }

  static std::unique_ptr<ModelTables> tables(const char *name, const char *description) {
    auto built = std::make_unique<ModelTables>(name, description);
    built->coordinates({"x", "y", "th"}, "m");
    built->parameter("m", Body::mass, TF_SETTABLE, "kg");
    built->parameter("J", Body::inertia, TF_SETTABLE, "kg.m2");
    built->parameter("g", 9.81, TF_SETTABLE, "m/s2");
    built->parameter("mu", Body::friction, TF_SETTABLE, "", 0);
    built->parameter("e", 0, TF_SETTABLE, "", 0, 1);
    built->parameter("rate", 1, TF_SETTABLE, "N");
    for (const char *contactName : Body::names)
      built->contact(contactName, 1);
    built->variable({.name = "energy", .kind = TF_KIND_OUTPUT, .index = 0, .flags = TF_OUTPUT, .unit = "J"});
    built->variable({.name = "timeSpeed", .kind = TF_KIND_TIME_SPEED});
    tf_model &model = built->model();
    model.starts = starts;
    model.dynamics = dynamics;
    model.switching = switching;
    model.contact_terms = contactTerms;
    model.contact_parameters = contactParameters;
    model.dynamics_derivatives = dynamicsDerivatives;
    model.energies = energies;
    model.outputs = outputs;
    model.no = 1;
    built->finish();
    return built;
  }
};

}  // namespace

const tf_model &rodModel() {
  static const auto tables = PlanarBody<Rod>::tables("Rod", "falling rod whose friction reverses inside the impact");
  return tables->model();
}

const tf_model &boxModel() {
  static const auto tables = PlanarBody<Box>::tables("Box", "falling box that comes to rest on a face");
  return tables->model();
}

}  // namespace tf::runtime::test
