#pragma once

#include <string>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/rod_flow.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/boundary_value.hpp"
#include "shooting/second_variation.hpp"

namespace dlo::energy_model {

/// An equilibrium of a span in its own units, or why there is none.
struct SpanEquilibrium {
  bool converged = false;
  std::string message = "never ran";
  int shots = 0;
  double residual = -1;
  Eigen::VectorXd s;            ///< nodes, which are grips, loads and some between
  std::vector<RodState> nodes;  ///< n is the force after the node
  Energies energy;              ///< zero where points sit at the problem's first grip
  SecondVariation stability;    ///< of an equilibrium that has converged
  Eigen::Matrix3Xd tangents;    ///< of an equilibrium, at equal distances, to compare it

  [[nodiscard]] bool stable() const { return converged && stability.stable(); }
};

/// Newton's method from a start, on a finer mesh once more if the force turns out to be large;
/// energies and stability of where it leads.
[[nodiscard]] SpanEquilibrium shoot_span(const RodSpan& span, RodMesh mesh,
                                         std::vector<RodState> start,
                                         const ShootingOptions& options);

/// Looks at the second variation of an equilibrium.
/// @param tolerance  of the integrator
void judge_stability(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium);

/// Intervals that resolve boundary layers under a force over b, and the bends of a span without
/// any.
[[nodiscard]] double longest_interval(const RodSpan& span, double force);

/// The cross-section at s; NaN if the integrator gave up.
[[nodiscard]] RodState state_at(const SpanEquilibrium& equilibrium, const RodSpan& span, double s,
                                double tolerance);

/// The same at arc lengths that grow, each from the one before.
[[nodiscard]] std::vector<RodState> states_at(const SpanEquilibrium& equilibrium,
                                              const RodSpan& span, const std::vector<double>& s,
                                              double tolerance);

}  // namespace dlo::energy_model
