// Random scenes of rigid bodies that fall, collide, slide and come to rest: polygons and disks above a floor and a slope in the plane,
// boxes and spheres in space. A seed is a scene: the same on every machine.
#pragma once

#include "tests/accuracy/support/compiled_model.h"

#include <cstdint>
#include <string>

namespace tf::test {

struct Scene {
  std::string model;  // source text
  std::string name;   // of its kind, "plane, 2 polygons of 4, 1 disks, Poisson"; scenes of one kind have the same model
  Settings settings;
  bool mayGainEnergy = false;  // restitution by Newton's law
};

// Three quarters of the seeds are in the plane.
[[nodiscard]] Scene randomScene(std::uint64_t seed);
[[nodiscard]] bool isPlanar(const Scene &scene);
// Whether boxes in space, with several frictional contacts at once, are in it.
[[nodiscard]] bool hasBoxes(const Scene &scene);

struct SceneOutcome {
  enum class Kind : std::uint8_t { Good, NoContinuation, Failed, Violated };
  Kind kind = Kind::Good;
  std::string text;    // what is wrong
  double seconds = 0;  // CPU
  double penetration = 0, energyError = 0;
};

// Runs the scene for two seconds of physical time at tolerance 1e-8 and checks: no penetration above 1e-9, energy balance closed to 1e-7,
// energy that never rises (but by Newton's law).
[[nodiscard]] SceneOutcome runScene(const Scene &scene);

}  // namespace tf::test
