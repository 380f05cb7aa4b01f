#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "curved/curved_rod.hpp"

namespace dlo::energy_model {

/// What the second variation says of an equilibrium of a curved rod.
struct CurvedStability {
  int negative = -1;  ///< eigenvalues below -neutral_eigenvalue: the ways in which it is unstable
  int neutral = -1;   ///< eigenvalues that count as zero: it can move for nothing
  double smallest = std::numeric_limits<double>::quiet_NaN();  ///< eigenvalue
  Eigen::VectorXd s;      ///< arc lengths of the mode of the smallest eigenvalue
  Eigen::Matrix3Xd spin;  ///< of the frames there, the largest of length 1

  /// The mode's spins at other arc lengths, linear between those that it has, of which there must
  /// be some.
  [[nodiscard]] Eigen::Matrix3Xd spin_at(const Eigen::VectorXd& at) const;
};

/// Second variation of the energy of a curved rod at an equilibrium, from nothing but its states.
/// Frames exp(hat(eta)) R have the strains u + R^T (eta' - eta x eta' / 2 + ...), so that
///     Q(eta) = int eta' . (R K R^T eta') - m . (eta x eta')
///                  + (n.t) |eta|^2 - (n.eta) (t.eta) ds,
/// n and m with what the grips add. eta is zero where a clamp holds the frame and along t where it
/// holds the direction alone; int eta x t ds between neighbouring grips is zero. Eigenvalues over
/// int |eta'|^2 + |eta|^2 ds. Finite elements of fourth order; see ConstrainedPencil.
/// @param force   what bends the rod over a length of one over its root: of the elements
/// @param states  at growing arc lengths
/// @return counts of -1 if the states are not finite
[[nodiscard]] CurvedStability curved_variation(
    const CurvedRod& rod, const ClampFrames& frames, double force,
    const std::function<std::vector<CurvedState>(const std::vector<double>& s)>& states);

}  // namespace dlo::energy_model
