#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "problem/reduction.hpp"

namespace dlo::energy_model {

/// Forces in the frame whose x axis is the last force.
struct TipFrame {
  double axis_angle = 0;  // of the last force against the clamp's tangent
  Eigen::Vector2d weight = Eigen::Vector2d::Zero();
  std::vector<PlanarCantilever::Load> loads;  // by growing sigma; `at` is sigma here

  [[nodiscard]] bool parallel() const;
};

[[nodiscard]] TipFrame tip_frame(const PlanarCantilever& rod);

/// Sum of the sizes of weight and loads [EI/l^2].
[[nodiscard]] double total_load(const PlanarCantilever& rod);

/// What a shot has at the clamp, NaN if the integrator failed: the angle psi of the tangent against
/// the last force, with the whole turns that the rod makes on its way [rad], and its derivative by
/// psi at the tip.
struct TipShot {
  double psi = 0;
  double psi_change = 0;
};

/// Integrates from the tip, psi = start there, to the clamp.
/// @param tolerance  local error per step
[[nodiscard]] TipShot shoot(const TipFrame& frame, double start, double tolerance);
/// The same without the derivative.
[[nodiscard]] double shoot_angle(const TipFrame& frame, double start, double tolerance);

/// The shape whose tip starts at this angle, seen from the clamp; NaN if the shot fails.
/// @param distances  from the clamp, s
[[nodiscard]] PlanarSamples sample(const TipFrame& frame, double start, double tolerance,
                                   const std::vector<double>& distances);

/// Its energies [EI/l]; NaN if the shot fails.
[[nodiscard]] Energies energies(const PlanarCantilever& rod, const TipFrame& frame, double start,
                                double tolerance);

}  // namespace dlo::energy_model
