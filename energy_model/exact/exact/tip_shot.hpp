#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "problem/reduction.hpp"

namespace dlo::energy_model {

/// Forces in the frame whose x axis is the direction of the last force.
struct TipFrame {
  double axis_angle = 0;  // angle of the last force from the clamp's tangent [rad]
  Eigen::Vector2d weight = Eigen::Vector2d::Zero();
  std::vector<PlanarCantilever::Load> loads;  // by growing sigma = 1 - s; `at` contains sigma

  [[nodiscard]] bool parallel() const;
};

[[nodiscard]] TipFrame tip_frame(const PlanarCantilever& rod);

/// Returns the sum of the norms of weight and forces [EI/l^2] and of couples [EI/l].
[[nodiscard]] double total_load(const PlanarCantilever& rod);

/// Result of a shot at the clamp, NaN if the integrator failed: the angle psi of the tangent from
/// the last force, including the whole turns of the rod [rad], and its derivative by psi at the
/// tip.
struct TipShot {
  double psi = 0;
  double psi_change = 0;
};

/// Integrates from the tip, where psi = start, to the clamp.
/// @param tolerance  local error per step
[[nodiscard]] TipShot shoot(const TipFrame& frame, double start, double tolerance);
/// Returns the angle psi of shoot() without its derivative.
[[nodiscard]] double shoot_angle(const TipFrame& frame, double start, double tolerance);

/// Returns the shape whose tip angle is `start`, in the frame of the clamp; NaN if the shot fails.
/// @param distances  distances s from the clamp
[[nodiscard]] PlanarSamples sample(const TipFrame& frame, double start, double tolerance,
                                   const std::vector<double>& distances);

/// Returns the energies of the shape whose tip angle is `start` [EI/l]; NaN if the shot fails.
[[nodiscard]] Energies energies(const PlanarCantilever& rod, const TipFrame& frame, double start,
                                double tolerance);

}  // namespace dlo::energy_model
