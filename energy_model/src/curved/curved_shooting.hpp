#pragma once

#include <string>
#include <vector>

#include "base/deadline.hpp"
#include "curved/curved_rod.hpp"
#include "curved/curved_variation.hpp"

namespace dlo::energy_model {

struct CurvedOptions {
  double tolerance = 1e-13;  ///< of the integrator, see follow_curved
  int max_iterations = 40;   ///< Newton steps
  Deadline deadline{};       ///< the result is a failure once it has passed
};

/// An equilibrium of a curved rod, or why there is none.
struct CurvedEquilibrium {
  bool converged = false;
  std::string message = "never ran";
  int shots = 0;  ///< integrations of the whole rod, with or without linearisation
  /// Largest gap in r, R, m / f, n / f^2 at a node, f^2 the largest |n| or 1.
  double residual = -1;
  Eigen::VectorXd s;               ///< nodes
  std::vector<CurvedState> nodes;  ///< m and n are those after the node
  Energies energy;                 ///< zero where points sit at the problem's first grip
  std::vector<double> turns;       ///< int u_3 ds of each interval
  ClampFrames frames;              ///< that it is an equilibrium with
  CurvedStability stability;       ///< of an equilibrium that has converged

  [[nodiscard]] bool stable() const { return converged && stability.negative == 0; }
};

/// Multiple shooting of all of a rod: Newton's method closes the gaps in r, R, m and n between
/// integrations over short intervals. m and n jump at grips: where a position is given n is free;
/// at a clamp two of R and two of m, at one that holds the frame all three. At each node Newton
/// moves r, m, n and a spin of R. Energies and stability of where it leads.
/// @param start  one for each node of the mesh
[[nodiscard]] CurvedEquilibrium shoot_curved(const CurvedRod& rod, RodMesh mesh,
                                             std::vector<CurvedState> start,
                                             const ClampFrames& frames,
                                             const CurvedOptions& options);

/// What bends a rod over lengths of one over its root, of states and natural strains.
[[nodiscard]] double bending_force(const CurvedRod& rod, const std::vector<CurvedState>& states);

/// The cross-sections at arc lengths that grow; NaN if the integrator gave up.
[[nodiscard]] std::vector<CurvedState> curved_states_at(const CurvedEquilibrium& equilibrium,
                                                        const CurvedRod& rod,
                                                        const std::vector<double>& s,
                                                        double tolerance);

}  // namespace dlo::energy_model
