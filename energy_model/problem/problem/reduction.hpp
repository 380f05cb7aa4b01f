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
/// energies in EI/l. The clamp is the origin and the rod leaves it along +x; s is the distance from
/// the clamp along the rod.
struct PlanarCantilever {
  /// A force and a couple at a point.
  struct Load {
    double at = 0;                                    ///< s, 0 < s <= 1
    Eigen::Vector2d force = Eigen::Vector2d::Zero();  ///< in EI/l^2
    double couple = 0;                                ///< in EI/l
  };
  Eigen::Vector2d weight = Eigen::Vector2d::Zero();  ///< its norm is Gamma = w l^3 / (EI)
  std::vector<Load> loads;                           ///< sorted by `at`
};

/// A problem with one clamp at either end, reduced to its plane and its own units. Only geometry
/// and units live here.
struct ReducedCantilever {
  PlanarCantilever rod;
  Plane plane;            ///< origin at the clamp, x along the rod as it leaves the clamp
  bool reversed = false;  ///< the clamp is at the end: s = 1 - arc length / l
};

/// @return nothing if the problem is not planar or not held by one clamp at an end
/// @throws std::invalid_argument if the problem is out of range
[[nodiscard]] std::optional<ReducedCantilever> reduce_cantilever(const Problem& problem);

/// Distances from the clamp in units of l.
[[nodiscard]] std::vector<double> distances_from_clamp(const Problem& problem, bool reversed,
                                                       std::span<const double> arc_lengths);

/// A planar shape in the rod's own units, as a solver leaves it.
struct PlanarSamples {
  Eigen::Matrix2Xd points;
  Eigen::VectorXd angle;  ///< of the tangent that points away from the clamp [rad]
  Eigen::VectorXd curvature;

  explicit PlanarSamples(Eigen::Index count) : points(2, count), angle(count), curvature(count) {}
};

/// Back to space and SI units.
[[nodiscard]] Samples restore(const Problem& problem, const ReducedCantilever& reduced,
                              std::span<const double> arc_lengths, const PlanarSamples& planar);

/// What the clamp exerts on the rod: the force that holds weight and loads, the torque that bends
/// the rod to the curvature it has there.
/// @param clamp_curvature  in 1/l, in the plane's frame
[[nodiscard]] Reaction clamp_reaction(const Problem& problem, const ReducedCantilever& reduced,
                                      double clamp_curvature);

/// From EI/l to [J].
[[nodiscard]] Energies restore(const Problem& problem, const Energies& own_units);

/// Solvers carry line loads with the weight: moves their energy from `gravity` to `load`, by
/// Gauss's quadrature between what the shape has kinks at. Of a shape that can be sampled.
void separate_line_loads(const Problem& problem, Equilibrium& result);

}  // namespace dlo::energy_model
