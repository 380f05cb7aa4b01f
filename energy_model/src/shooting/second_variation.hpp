#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_flow.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/constrained_pencil.hpp"

namespace dlo::energy_model {

/// What the second variation says of an equilibrium of a span.
struct SecondVariation {
  int negative = -1;  ///< eigenvalues below -neutral_eigenvalue: the ways in which it is unstable
  int neutral = -1;   ///< eigenvalues that count as zero: it can move for nothing
  double smallest = std::numeric_limits<double>::quiet_NaN();  ///< eigenvalue
  Eigen::VectorXd s;           ///< arc lengths of the mode of the smallest eigenvalue, in the span
  Eigen::Matrix3Xd direction;  ///< change of the tangents there, the largest of length 1

  [[nodiscard]] bool stable() const { return negative == 0; }  ///< neutral modes allowed
};

/// The states t, v and n of a span at growing arc lengths within it; r is not asked for.
using SpanStates = std::function<std::vector<RodState>(const std::vector<double>& s)>;

/// Second variation of the energy of a span at an equilibrium, from nothing but its states. For a
/// change eta of the tangent, across it,
///     Q(eta) = int b |eta'|^2 + (n.t - b |t'|^2) |eta|^2 ds,
/// and where the clamps at the ends hold the twist Psi of a rod,
///     Q(eta) + int M t . (eta' x eta) ds + (int (t x t') . eta ds)^2 / k,   k = int ds / c,
/// in units of the rod (rod_flow.hpp), M = Psi / k: the last integral is the change of Psi. n is
/// the force that the span carries with what the grips add: the constraints' curvature is in n.t.
/// eta is zero at clamps and its integral between neighbouring grips is zero; in space and free of
/// the plane even for a planar shape, so that buckling sideways and turning about a line are among
/// its modes. Finite elements of fourth order; the signs of the pivots of
///     (K - mu S   C^T)
///     (C          -0 )
/// count the eigenvalues below mu (Sylvester's law of inertia), K of Q, S of int |eta'|^2 +
/// |eta|^2, C the constraints. The square of the twist would fill K: its integral is one more row
/// of C, with -k in place of -0.
/// @return counts of -1 if the states are not finite
[[nodiscard]] SecondVariation second_variation(const RodSpan& span, const SpanStates& states);

/// Changes of the tangents in the mode of the smallest eigenvalue, at other arc lengths: linear
/// between those of the mode, which must have some.
[[nodiscard]] Eigen::Matrix3Xd mode_at(const SecondVariation& variation, const Eigen::VectorXd& s);

/// Writes the verdict into a shape that is an equilibrium: `converged`, or `saddle` if it is
/// unstable; neutral modes are named in the message.
void judge(const SecondVariation& stability, Equilibrium& shape);

}  // namespace dlo::energy_model
