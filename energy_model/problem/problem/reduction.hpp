#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/plane.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// A rod clamped at one end, in its plane and in its own units: lengths in l, forces in EI/l^2,
/// energies in EI/l. The clamp is at the origin, and the rod leaves it along +x. s is the distance
/// from the clamp along the rod.
struct PlanarCantilever {
  /// A force and a couple at one point.
  struct Load {
    double at = 0;                                    ///< s of the load, 0 < s <= 1
    Eigen::Vector2d force = Eigen::Vector2d::Zero();  ///< in EI/l^2
    double couple = 0;                                ///< in EI/l, about the normal of the plane
  };
  /// Weight of the rod; its norm is Gamma = w l^3 / (EI).
  Eigen::Vector2d weight = Eigen::Vector2d::Zero();
  std::vector<Load> loads;  ///< sorted by `at`
};

/// A problem with one clamp, at one end of the rod, reduced to its plane and its own units. It
/// contains geometry and units only.
struct ReducedCantilever {
  PlanarCantilever rod;
  Plane plane;            ///< origin at the clamp, x along the rod at the clamp
  bool reversed = false;  ///< whether the clamp is at the end: s = 1 - arc length / l
};

/// Reduces a problem with one clamp to its plane.
/// @return std::nullopt if the problem is not planar, or not held by one clamp at an end
/// @throws std::invalid_argument if the problem is out of range
[[nodiscard]] std::optional<ReducedCantilever> reduce_cantilever(const Problem& problem);

/// Returns the distances from the clamp, in units of l, of these arc lengths [m].
[[nodiscard]] std::vector<double> distances_from_clamp(const Problem& problem, bool reversed,
                                                       std::span<const double> arc_lengths);

/// A planar shape in the rod's own units, as a solver returns it.
struct PlanarSamples {
  Eigen::Matrix2Xd points;
  Eigen::VectorXd angle;  ///< angle of the tangent that points away from the clamp [rad]
  Eigen::VectorXd curvature;

  explicit PlanarSamples(Eigen::Index count) : points(2, count), angle(count), curvature(count) {}
};

/// Converts a planar shape to space and SI units.
[[nodiscard]] Samples restore(const Problem& problem, const ReducedCantilever& reduced,
                              std::span<const double> arc_lengths, const PlanarSamples& planar);

/// Returns force and torque of the clamp on the rod: the force balances weight and loads, the
/// torque bends the rod to its curvature at the clamp and balances couples of loads at the clamp.
/// @param clamp_curvature  curvature in 1/l, in the plane's frame
[[nodiscard]] Reaction clamp_reaction(const Problem& problem, const ReducedCantilever& reduced,
                                      double clamp_curvature);

/// Converts energies from EI/l to [J].
[[nodiscard]] Energies restore(const Problem& problem, const Energies& own_units);

/// Moves the energy of line loads from `gravity` to `load`, because solvers treat line loads as
/// weight. It is integrated by Gauss's quadrature between the kinks of the shape. No effect on a
/// shape that cannot be sampled.
void separate_line_loads(const Problem& problem, Equilibrium& result);

}  // namespace dlo::energy_model
