// How fast physical time runs in numerical time while contacts persist, and the step variables of the contacts (theory.md section 2).
#pragma once

#include <span>
#include <vector>

namespace tf::runtime {

// β = dt/dτ: the root of β = Π_i (1 − λ_i β / a_i) in (0, min(1, min_i a_i/λ_i)], unique. normalForce λ_i ≥ 0 (negative ones, which
// occur within rounding, count as 0), rate a_i > 0, of the same length; 1 without contacts. One contact: a/(a + λ).
double timeSpeed(std::span<const double> normalForce, std::span<const double> rate);

// dτ/dt = 1/β. With one or two contacts it is continued smoothly to forces below zero: an integrator's step that reaches beyond the end of
// a mode, which is where a force vanishes, then sees no kink there.
// `ratios`: workspace.
double numericalTimeRate(std::span<const double> normalForce, std::span<const double> rate, std::vector<double> &ratios);

// push_i = λ_i β / a_i = (1 − α1_i)(1 − α2_i) on c1 = c2 = 0.
void pushes(std::span<const double> normalForce, std::span<const double> rate, double timeSpeed, std::span<double> push);

// α3 of λ_t = (1 − 2 α3) limit: 1 where c3 > 0, 0 where c3 < 0, fractional in stick; ½ where the limit is 0.
double slipStepVariable(double tangentForce, double limit);

}  // namespace tf::runtime
