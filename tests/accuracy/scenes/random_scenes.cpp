#include "tests/accuracy/scenes/random_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fmt/format.h>
#include <random>

namespace tf::test {

namespace {

constexpr double duration = 2, tolerance = 1e-8;
constexpr int observations = 40;

class Random {
public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}
  // std::uniform_real_distribution differs between libraries.
  double between(double low, double high) { return low + (high - low) * static_cast<double>(generator_() >> 11) * 0x1p-53; }
  int below(int count) { return static_cast<int>(generator_() % static_cast<std::uint64_t>(count)); }
  // A share of the scenes has the extreme values.
  double coefficient(double high) {
    const int choice = below(6);
    return choice == 0 ? 0 : choice == 1 ? high : between(0, high);
  }

private:
  std::mt19937_64 generator_;
};

struct PlanarKind {
  int polygons, corners, disks;
};

constexpr std::array<PlanarKind, 10> planarKinds = {
    {{1, 3, 0}, {1, 4, 0}, {1, 5, 0}, {0, 3, 1}, {0, 3, 2}, {0, 3, 3}, {2, 3, 1}, {2, 4, 0}, {1, 4, 2}, {2, 4, 2}}};

const char *const laws[] = {"Poisson", "Stronge", "Newton"};

std::string polygonsText(const PlanarKind &kind, const char *law) {
  if (kind.polygons == 0)
    return "";
  return fmt::format(R"(  parameter Real corner[{0}, {1}, 2] = zeros({0}, {1}, 2), m[{0}] = ones({0}), J[{0}] = ones({0});
  coordinate Real r[{0}, 2], phi[{0}];
  Real p[{0}, {1}, 2] = {{{{{{r[i, 1] + cos(phi[i])*corner[i, j, 1] - sin(phi[i])*corner[i, j, 2],
    r[i, 2] + sin(phi[i])*corner[i, j, 1] + cos(phi[i])*corner[i, j, 2]}} for j in 1:{1}}} for i in 1:{0}}};
  body polygon[{0}](mass = m, position = r, angle = phi, inertia = J);
  contact corner_floor[{0}, {1}](gap = p[:, :, 2], slip = der(p[:, :, 1]), each friction = mu[1], each restitution = e[1], each law = ImpactLaw.{2});
  contact corner_slope[{0}, {1}](gap = p[:, :, 1]*sin(a) + p[:, :, 2]*cos(a) + fill(w*sin(a), {0}, {1}),
    slip = der(p[:, :, 1]*cos(a) - p[:, :, 2]*sin(a)), each friction = mu[2], each restitution = e[2], each law = ImpactLaw.{2});
)",
                     kind.polygons, kind.corners, law);
}

std::string disksText(const PlanarKind &kind, const char *law) {
  if (kind.disks == 0)
    return "";
  std::string text = fmt::format(R"(  parameter Real R[{0}] = ones({0}), md[{0}] = ones({0});
  coordinate Real c[{0}, 2], psi[{0}];
  body disk[{0}](mass = md, position = c, angle = psi, inertia = md .* R .* R/2);
  contact disk_floor[{0}](gap = c[:, 2] - R, slip = der(c[:, 1]) + R .* der(psi), each friction = mu[3], each restitution = e[3], each law = ImpactLaw.{1});
  contact disk_slope[{0}](gap = c[:, 1]*sin(a) + c[:, 2]*cos(a) + fill(w*sin(a), {0}) - R,
    slip = der(c[:, 1]*cos(a) - c[:, 2]*sin(a)) + R .* der(psi), each friction = mu[4], each restitution = e[4], each law = ImpactLaw.{1});
)",
                                 kind.disks, law);
  for (int i = 1; i <= kind.disks; ++i)
    for (int j = i + 1; j <= kind.disks; ++j)
      text += fmt::format(R"(  Real d{0}{1}[2] = c[{1}, :] - c[{0}, :];
  Real s{0}{1} = sqrt(d{0}{1}*d{0}{1});
  contact pair{0}{1}(gap = s{0}{1} - R[{0}] - R[{1}],
    slip = (d{0}{1}[2]*(der(c[{0}, 1]) - der(c[{1}, 1])) - d{0}{1}[1]*(der(c[{0}, 2]) - der(c[{1}, 2])))/s{0}{1} - R[{0}]*der(psi[{0}]) - R[{1}]*der(psi[{1}]),
    friction = mu[5], restitution = e[5], law = ImpactLaw.{2});
)",
                          i, j, law);
  return text;
}

std::string planarText(const PlanarKind &kind, const char *law) {
  return "model Scene\n  parameter Real mu[5] = zeros(5), e[5] = zeros(5), a = 0.5, w = 1;\n  gravity weight(acceleration = {0, "
         "-9.81});\n" +
         polygonsText(kind, law) + disksText(kind, law) + "end Scene;\n";
}

// Corners in convex position around the centre of mass at (0, 0); a disk's density gives mass and inertia.
void addPolygon(Scene &scene, Random &random, int number, int corners, double place) {
  const double size = random.between(0.2, 0.6), turn = random.between(0, 6.28);
  std::vector<std::array<double, 2>> points;
  double x = 0, y = 0;
  for (int k = 0; k < corners; ++k) {
    const double angle = turn + 6.283185307179586 * (k + random.between(-0.25, 0.25)) / corners;
    points.push_back({size * std::cos(angle), size * std::sin(angle)});
    x += points.back()[0] / corners;
    y += points.back()[1] / corners;
  }
  double reach = 0;
  for (int k = 0; k < corners; ++k) {
    const std::array<double, 2> point = {points[static_cast<std::size_t>(k)][0] - x, points[static_cast<std::size_t>(k)][1] - y};
    reach = std::max(reach, std::hypot(point[0], point[1]));
    for (int axis = 0; axis < 2; ++axis)
      scene.settings.emplace_back(fmt::format("corner[{},{},{}]", number, k + 1, axis + 1), point[static_cast<std::size_t>(axis)]);
  }
  const double mass = random.between(0.2, 3);
  scene.settings.emplace_back(fmt::format("m[{}]", number), mass);
  scene.settings.emplace_back(fmt::format("J[{}]", number), mass * size * size * random.between(0.2, 0.6));
  scene.settings.emplace_back(fmt::format("r[{},1]", number), place);
  scene.settings.emplace_back(fmt::format("r[{},2]", number), reach + random.between(0.05, 1));
  scene.settings.emplace_back(fmt::format("phi[{}]", number), random.between(-3, 3));
  scene.settings.emplace_back(fmt::format("der(r[{},1])", number), random.between(-4, 4));
  scene.settings.emplace_back(fmt::format("der(r[{},2])", number), random.between(-3, 3));
  scene.settings.emplace_back(fmt::format("der(phi[{}])", number), random.between(-8, 8));
}

void addDisk(Scene &scene, Random &random, int number, double place) {
  const double radius = random.between(0.1, 0.4);
  scene.settings.emplace_back(fmt::format("R[{}]", number), radius);
  scene.settings.emplace_back(fmt::format("md[{}]", number), random.between(0.2, 3));
  scene.settings.emplace_back(fmt::format("c[{},1]", number), place);
  scene.settings.emplace_back(fmt::format("c[{},2]", number), radius + random.between(0.05, 1));
  scene.settings.emplace_back(fmt::format("der(c[{},1])", number), random.between(-4, 4));
  scene.settings.emplace_back(fmt::format("der(c[{},2])", number), random.between(-3, 3));
  scene.settings.emplace_back(fmt::format("der(psi[{}])", number), random.between(-15, 15));
}

Scene planarScene(Random &random) {
  const PlanarKind &kind = planarKinds[static_cast<std::size_t>(random.below(static_cast<int>(planarKinds.size())))];
  const int choice = random.below(8);
  const char *law = laws[choice < 5 ? 0 : choice < 7 ? 1 : 2];
  Scene scene;
  scene.name = fmt::format("plane, {} polygons of {}, {} disks, {}", kind.polygons, kind.polygons > 0 ? kind.corners : 0, kind.disks, law);
  scene.model = planarText(kind, law);
  scene.mayGainEnergy = choice == 7;
  const bool isInelastic = random.below(3) == 0;
  for (int k = 1; k <= 5; ++k) {
    scene.settings.emplace_back(fmt::format("mu[{}]", k), random.coefficient(2));
    scene.settings.emplace_back(fmt::format("e[{}]", k), isInelastic ? 0 : random.coefficient(1));
  }
  // The slope rises to the left of x = −w.
  scene.settings.emplace_back("a", random.between(0.3, 1.2));
  scene.settings.emplace_back("w", 2);
  double place = 0;
  for (int i = 1; i <= kind.polygons; ++i, place += 1.3)
    addPolygon(scene, random, i, kind.corners, place);
  for (int i = 1; i <= kind.disks; ++i, place += 1.3)
    addDisk(scene, random, i, place);
  return scene;
}

// Up to 19 contacts.
struct SpatialKind {
  int boxes, spheres;
};

constexpr std::array<SpatialKind, 7> spatialKinds = {{{1, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {2, 0}, {2, 2}}};

std::string spatialText(const SpatialKind &kind, const char *law) {
  std::string text = "model Scene\n  parameter Real mu[4] = zeros(4), e[4] = zeros(4);\n  gravity weight(acceleration = {0, 0, -9.81});\n";
  for (int i = 1; i <= kind.boxes; ++i)
    text += fmt::format(R"(  parameter Real side{0}[3] = ones(3), mb{0} = 1;
  coordinate Real r{0}[3];
  coordinate Rotation Q{0};
  Real corner{0}[8, 3] = {{r{0} + Q{0}*{{(if mod(k, 2) == 0 then -side{0}[1] else side{0}[1]), (if mod(div(k, 2), 2) == 0 then -side{0}[2] else side{0}[2]),
    (if div(k, 4) == 0 then -side{0}[3] else side{0}[3])}} for k in 0:7}};
  body box{0}(mass = mb{0}, position = r{0}, orientation = Q{0},
    inertia = mb{0}/3*diagonal({{side{0}[2]^2 + side{0}[3]^2, side{0}[1]^2 + side{0}[3]^2, side{0}[1]^2 + side{0}[2]^2}}));
  contact box_floor{0}[8](gap = corner{0}[:, 3], slip = der(corner{0}[:, 1:2]), each friction = mu[1], each restitution = e[1], each law = ImpactLaw.{1});
)",
                        i, law);
  for (int i = 1; i <= kind.spheres; ++i)
    text += fmt::format(R"(  parameter Real R{0} = 0.2, m{0} = 1;
  coordinate Real c{0}[3];
  coordinate Rotation S{0};
  Real w{0}[3] = S{0}*S{0}.w;
  body sphere{0}(mass = m{0}, position = c{0}, orientation = S{0}, inertia = 0.4*m{0}*R{0}^2*identity(3));
  contact sphere_floor{0}(gap = c{0}[3] - R{0}, slip = {{der(c{0}[1]) - R{0}*w{0}[2], der(c{0}[2]) + R{0}*w{0}[1]}}, friction = mu[2], restitution = e[2], law = ImpactLaw.{1});
)",
                        i, law);
  // The slip of a pair in a frame across its line of centres n, turned from {x, y} the short way: singular only where n points straight
  // down, that is, for a sphere exactly on top of one with a lower number.
  for (int i = 1; i <= kind.spheres; ++i)
    for (int j = i + 1; j <= kind.spheres; ++j)
      text += fmt::format(R"(  Real d{0}{1}[3] = c{1} - c{0};
  Real s{0}{1} = sqrt(d{0}{1}*d{0}{1});
  Real n{0}{1}[3] = d{0}{1}/s{0}{1};
  Real v{0}{1}[3] = der(c{0}) - der(c{1}) + cross(R{0}*w{0} + R{1}*w{1}, n{0}{1});
  contact pair{0}{1}(gap = s{0}{1} - R{0} - R{1}, slip = {{v{0}{1}[1] - n{0}{1}[1]*(n{0}{1}*v{0}{1}) - n{0}{1}[1]*(v{0}{1}[3] - n{0}{1}[3]*(n{0}{1}*v{0}{1}))/(1 + n{0}{1}[3]),
    v{0}{1}[2] - n{0}{1}[2]*(n{0}{1}*v{0}{1}) - n{0}{1}[2]*(v{0}{1}[3] - n{0}{1}[3]*(n{0}{1}*v{0}{1}))/(1 + n{0}{1}[3])}}, friction = mu[3], restitution = e[3], law = ImpactLaw.{2});
)",
                          i, j, law);
  return text + "end Scene;\n";
}

void addVector(Scene &scene, Random &random, const std::string &name, double largest) {
  for (int k = 1; k <= 3; ++k)
    scene.settings.emplace_back(fmt::format(fmt::runtime(name), k), random.between(-largest, largest));
}

// In any attitude: a unit quaternion with uniform distribution (Shoemake, Graphics Gems III, 1992).
void addPose(Scene &scene, Random &random, int number) {
  const double u = random.between(0, 1), a = random.between(0, 6.283185307179586), b = random.between(0, 6.283185307179586);
  const std::array<double, 4> quaternion = {std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b),
                                            std::sqrt(u) * std::cos(b)};
  for (int k = 1; k <= 4; ++k)
    scene.settings.emplace_back(fmt::format("Q{}.q[{}]", number, k), quaternion[static_cast<std::size_t>(k - 1)]);
}

// Every other one lies flat.
void addBox(Scene &scene, Random &random, int number) {
  double reach = 0;
  for (int k = 1; k <= 3; ++k) {
    const double side = random.between(0.1, 0.4);
    reach += side * side;
    scene.settings.emplace_back(fmt::format("side{}[{}]", number, k), side);
  }
  scene.settings.emplace_back(fmt::format("mb{}", number), random.between(0.2, 3));
  scene.settings.emplace_back(fmt::format("r{}[3]", number), std::sqrt(reach) + random.between(0.05, 0.8));
  addVector(scene, random, fmt::format("der(r{}[{{}}])", number), 3);
  addVector(scene, random, fmt::format("Q{}.w[{{}}]", number), 6);
  if (random.below(2) == 0)
    addPose(scene, random, number);
}

void addSphere(Scene &scene, Random &random, int number) {
  const double radius = random.between(0.1, 0.3);
  scene.settings.emplace_back(fmt::format("R{}", number), radius);
  scene.settings.emplace_back(fmt::format("m{}", number), random.between(0.2, 3));
  scene.settings.emplace_back(fmt::format("c{}[1]", number), 1.2 * number);
  scene.settings.emplace_back(fmt::format("c{}[3]", number), radius + random.between(0.02, 0.6));
  addVector(scene, random, fmt::format("der(c{}[{{}}])", number), 3);
  addVector(scene, random, fmt::format("S{}.w[{{}}]", number), 20);
}

Scene spatialScene(Random &random) {
  const SpatialKind &kind = spatialKinds[static_cast<std::size_t>(random.below(static_cast<int>(spatialKinds.size())))];
  const int choice = random.below(8);
  const char *law = laws[choice < 5 ? 0 : choice < 7 ? 1 : 2];
  Scene scene;
  scene.name = fmt::format("space, {} boxes, {} spheres, {}", kind.boxes, kind.spheres, law);
  scene.model = spatialText(kind, law);
  scene.mayGainEnergy = choice == 7;
  const bool isInelastic = random.below(2) == 0;
  for (int k = 1; k <= 3; ++k) {
    scene.settings.emplace_back(fmt::format("mu[{}]", k), random.coefficient(2));
    scene.settings.emplace_back(fmt::format("e[{}]", k), isInelastic ? 0 : random.coefficient(1));
  }
  for (int i = 1; i <= kind.boxes; ++i)
    addBox(scene, random, i);
  for (int i = 1; i <= kind.spheres; ++i)
    addSphere(scene, random, i);
  return scene;
}

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

Scene randomScene(std::uint64_t seed) {
  Random random(seed);
  return seed % 4 == 0 ? spatialScene(random) : planarScene(random);
}

bool isPlanar(const Scene &scene) { return scene.name.starts_with("plane"); }

bool hasBoxes(const Scene &scene) { return !isPlanar(scene) && scene.name.find(" 0 boxes") == std::string::npos; }

SceneOutcome runScene(const Scene &scene) {
  SceneOutcome outcome;
  const double begin = cpuSeconds();
  std::string fileName = scene.name + ".tf";
  std::replace_if(fileName.begin(), fileName.end(), [](char c) { return c == ' ' || c == ','; }, '_');
  try {
    CompiledModel model(sourceFile(fileName, scene.model), scene.settings);
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(tolerance).initialise();
    double energy = model.energy();
    for (int k = 1; k <= observations; ++k) {
      model.advance(duration * k / observations);
      const double now = model.energy();
      if (now > energy + 1e-7 * std::max(1.0, energy) && !scene.mayGainEnergy) {
        outcome.kind = SceneOutcome::Kind::Violated;
        outcome.text = fmt::format("the energy rises from {} to {} before time = {}; ", energy, now, model.time());
      }
      energy = now;
    }
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    outcome.penetration = std::max(0.0, -statistics.worst_gap);
    outcome.energyError = statistics.worst_energy_error;
    if (outcome.penetration > 1e-9 || outcome.energyError > 1e-7) {
      outcome.kind = SceneOutcome::Kind::Violated;
      outcome.text += fmt::format("penetration {:.2e}, energy error {:.2e}", outcome.penetration, outcome.energyError);
    }
  } catch (const std::exception &error) {
    outcome.text = error.what();
    const bool isAllowed = outcome.text.find("no consistent continuation") != std::string::npos;
    outcome.kind = isAllowed ? SceneOutcome::Kind::NoContinuation : SceneOutcome::Kind::Failed;
  }
  outcome.seconds = cpuSeconds() - begin;
  return outcome;
}

}  // namespace tf::test
