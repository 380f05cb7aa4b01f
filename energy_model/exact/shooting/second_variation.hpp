#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/constrained_pencil.hpp"
#include "shooting/rod_flow.hpp"

namespace dlo::energy_model {

/// What the second variation says of an equilibrium of a span.
struct SecondVariation {
  int negative = -1;  ///< eigenvalues below -neutral_eigenvalue: the ways in which it is unstable
  int neutral = -1;   ///< eigenvalues that count as zero: zero modes
  double smallest = std::numeric_limits<double>::quiet_NaN();  ///< eigenvalue
  Eigen::VectorXd s;      ///< arc lengths of the mode of the smallest eigenvalue, in the span
  Eigen::Matrix3Xd spin;  ///< of the frames there, the largest of length 1

  [[nodiscard]] bool stable() const { return negative == 0; }  ///< neutral modes allowed

  /// The mode's spins at other arc lengths, linear between those that it has, of which there must
  /// be some.
  [[nodiscard]] Eigen::Matrix3Xd spin_at(const Eigen::VectorXd& at) const;
};

/// The states of a span at growing arc lengths within it; r is not asked for.
using SpanStates = std::function<std::vector<RodState>(const std::vector<double>& s)>;

/// Second variation of the energy of a span at an equilibrium, from nothing but its states.
/// Frames exp(hat(eta)) R have the strains u + R^T (eta' - eta x eta' / 2 + ...), so that
///     Q(eta) = int eta' . (R K R^T eta') - m . (eta x eta')
///                  + (n.t) |eta|^2 - (n.eta) (t.eta) ds,
/// n and m with what the grips add. eta is zero where a clamp holds the frame and along t where it
/// holds the direction alone; int eta x t ds between neighbouring grips is zero. Where the rod
/// touches a body that pushes with f, or p ds, dr = int eta x t ds stays on it, N.dr = 0, and its
/// curvature costs
///     - f dr.(H dr),   of a point that may slide also   + f (N.(eta x t) + dr.(H t))^2 / g'',
/// H the normal's derivative, g'' that of the gap along the rod. It leaves the
/// plane even of a planar shape, so that buckling out of plane and rotation around a line are among
/// its modes. Of a round rod that nothing twists eta along t costs nothing and is left out, with c.
///
/// What lies is kept on its surface at the ends of elements alone, so that no shape is called more
/// stable than it is.
///
/// Of a section that stretches by a the strain eps that is least for eta and for the multipliers mu
/// of the constraint is eliminated, eps = a (n.(eta x t) - mu.t): (1 + a n.t) multiplies the terms
/// in n and eta x t, - a (n.(eta x t))^2 is added to Q, a (n.(eta x t)) t to the constraint, and
/// - a (mu.t)^2 costs what stretch gives.
///
/// Where couples act on a span with a plane, eta is a rotation around its normal alone.
///
/// Eigenvalues over int |eta'|^2 + |eta|^2 ds, by finite elements of fourth order and the signs of
/// pivots (ConstrainedPencil).
/// @param force  what bends the span over lengths of one over its root: of the elements
/// @return counts of -1 if the states are not finite
/// @param mesh  with what the rod touches; empty: nothing
[[nodiscard]] SecondVariation second_variation(const RodSpan& span, const RodMesh& mesh,
                                               const ClampFrames& frames, double force,
                                               const SpanStates& states);

/// Writes the verdict into a shape that is an equilibrium: `converged`, or `saddle` if it is
/// unstable; neutral modes are named in the message.
void judge(const SecondVariation& stability, Equilibrium& shape);

}  // namespace dlo::energy_model
