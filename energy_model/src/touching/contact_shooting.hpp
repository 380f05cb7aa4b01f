#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace dlo::energy_model {

/// What the free end of a planar cantilever does. Units: lengths l, forces EI/l^2, moments EI/l.
enum class EndContact {
  none,   ///< it is free
  tip,    ///< gap = 0, the force f along the normal
  lying,  ///< from s = reach on the rod is on the plane: gap = slope = curvature = 0 there, f too
};

/// A half-space whose plane is across the rod's: gap = normal . r - height.
struct Floor {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitY();  ///< unit, to the free side
  double height = 0;
};

/// Of a section: x, y, angle, curvature.
using ArcState = std::array<double, 4>;

/// A shape of Kirchhoff's equations by multiple shooting, with n' = -w, kappa' = n x t.
struct TouchingShape {
  Eigen::Vector2d weight = Eigen::Vector2d::Zero();
  EndContact contact = EndContact::none;
  Floor floor;                  ///< that is touched
  double end_angle = 0;         ///< of the lying part
  double force = 0;             ///< f, concentrated at s = reach
  double reach = 1;             ///< arc length up to which the rod is off the plane
  std::vector<ArcState> nodes;  ///< where the arcs begin, which share `reach` in equal parts
  double residual = 1;          ///< largest gap that the arcs leave
  double step = 1;              ///< largest component of Newton's last step
  int shots = 0;                ///< of all arcs, for this shape and those on the way to it
  bool positive = true;         ///< sign of the system's determinant
};

/// Closes the gaps between the arcs by Newton's method, the first node's position and angle held.
/// @return whether the residual came below 1e-9
[[nodiscard]] bool close_arcs(TouchingShape& shape);

/// State at an arc length within [0, 1].
[[nodiscard]] ArcState state_at(const TouchingShape& shape, double s);

/// Whether the second variation is positive, in the plane and out of it, with the rates of eta^2
/// lower by `margin` of 1 and of their terms:
///     in it      int eta'^2 + (n.t) eta^2 ds,             eta = 0 at the clamp and where it lies,
///                of those eta that leave the touching point on the plane,
///     out of it  int eta'^2 + (n.t - kappa^2) eta^2 ds,   eta = 0 at the clamp,
/// eta the angle by which the tangent turns, in linear elements and by the signs of pivots.
/// @param margin  1e-3; -1e-3 raises the rates: what is not stable then is a saddle
[[nodiscard]] bool is_stable(const TouchingShape& shape, double margin);

}  // namespace dlo::energy_model
