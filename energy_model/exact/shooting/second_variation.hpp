#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/constrained_pencil.hpp"
#include "shooting/rod_flow.hpp"

namespace dlo::energy_model {

/// Eigenvalues of the second variation at an equilibrium of a span.
struct SecondVariation {
  /// Number of eigenvalues below -neutral_eigenvalue, each an unstable mode; -1: unknown.
  int negative = -1;
  /// Number of eigenvalues that count as zero (zero modes); not meaningful if `negative` is -1.
  int neutral = -1;
  double smallest = std::numeric_limits<double>::quiet_NaN();  ///< smallest eigenvalue
  Eigen::VectorXd s;  ///< arc lengths in the span at which `spin` is given
  /// Spins of the frames in the mode of the smallest eigenvalue, scaled to a largest length of 1.
  Eigen::Matrix3Xd spin;

  [[nodiscard]] bool stable() const { return negative == 0; }  ///< zero modes are allowed

  /// Returns the spins of the mode at other arc lengths by linear interpolation. There have to be
  /// spins.
  [[nodiscard]] Eigen::Matrix3Xd spin_at(const Eigen::VectorXd& at) const;
};

/// Returns the states of a span at growing arc lengths within it. Positions r are used only if the
/// rod touches a body.
using SpanStates = std::function<std::vector<RodState>(const std::vector<double>& s)>;

/// Computes the second variation of the energy of a span at an equilibrium, from its states alone.
/// Frames exp(hat(eta)) R have the strains u + R^T (eta' - eta x eta' / 2 + ...), so that
///     Q(eta) = int eta' . (R K R^T eta') - m . (eta x eta')
///                  + (n.t) |eta|^2 - (n.eta) (t.eta) ds,
/// where n and m include the reactions of the grips. eta is zero where a clamp holds the frame, and
/// along t where it holds the direction only; int eta x t ds between neighbouring grips is zero.
/// Where the rod touches a body with the force f, or p ds, dr = int eta x t ds is tangential to the
/// body, N.dr = 0, and the body's curvature contributes
///     - f dr.(H dr),   for a point that may slide also   + f (N.(eta x t) + dr.(H t))^2 / g'',
/// with the derivative H of the normal, and the second derivative g'' of the gap along the rod. eta
/// is not restricted to the plane of a planar shape, so that buckling out of the plane and rotation
/// about a line are among the modes. For a round rod that nothing twists, eta along t does not
/// change the energy and is omitted, together with c.
///
/// A part that lies on a surface is constrained to it at the ends of elements only, so that no
/// shape is classified as more stable than it is.
///
/// For a section that stretches by a, the strain eps is eliminated at its minimum for given eta and
/// multipliers mu of the constraint, eps = a (n.(eta x t) - mu.t). (1 + a n.t) then multiplies the
/// terms in n and eta x t, - a (n.(eta x t))^2 is added to Q, a (n.(eta x t)) t to the constraint,
/// and - a (mu.t)^2 is added for the compliance of the stretch.
///
/// If couples act on a span with a plane, eta is a rotation about its normal only.
///
/// Eigenvalues are relative to int |eta'|^2 + |eta|^2 ds, by finite elements of fourth order and
/// the signs of pivots (ConstrainedPencil).
/// @param force  force over b that bends the span over lengths of 1 / force^(1/2): determines the
///               elements
/// @param mesh   mesh with the contacts of the rod; empty: none
/// @return `negative` = -1 if it cannot be determined, as for states that are not finite
[[nodiscard]] SecondVariation second_variation(const RodSpan& span, const RodMesh& mesh,
                                               const ClampFrames& frames, double force,
                                               const SpanStates& states);

}  // namespace dlo::energy_model
