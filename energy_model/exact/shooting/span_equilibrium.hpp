#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/rod_flow.hpp"
#include "shooting/second_variation.hpp"
#include "shooting/shooting_system.hpp"

namespace dlo::energy_model {

/// An equilibrium of a span in its own units, or why there is none.
struct SpanEquilibrium {
  bool converged = false;
  std::string message = "never ran";
  int shots = 0;  ///< integrations of the whole span, with or without linearisation
  /// Largest gap in r, R, m / f, n / f^2 at a node, f^2 the largest |n| or 1.
  double residual = -1;
  Eigen::VectorXd s;            ///< nodes, which are grips, loads and some between
  std::vector<RodState> nodes;  ///< m and n are those after the node
  Energies energy;              ///< zero where points sit at the problem's first grip
  std::vector<double> turns;    ///< int u_3 ds of each interval
  ClampFrames frames;           ///< that it is an equilibrium with
  RodContacts contacts;         ///< and what it touches
  SecondVariation stability;    ///< of an equilibrium that has converged

  [[nodiscard]] bool stable() const { return converged && stability.stable(); }
};

/// Growth of errors over an interval, its length times bending_force^(1/2), that is too much.
inline constexpr double largest_growth = 3;

/// The length of its longest interval.
[[nodiscard]] double longest_of(const RodMesh& mesh);

/// The nodes to which Newton's method leads from a start (shooting_system.hpp), without a look at
/// energies and stability. Frames that are held at both ends of a round rod are rotated by many
/// turns, and its shape slides for nearly nothing: close_gaps.hpp says how it steps then.
/// @param start  one for each node of the mesh
[[nodiscard]] SpanEquilibrium close_span(const RodSpan& span, const RodMesh& mesh,
                                         const std::vector<RodState>& start,
                                         const ClampFrames& frames, const ShootingOptions& options);

/// Newton's method from a start, on a finer mesh once more if what bends the rod turns out to be
/// large; energies and stability of where it leads.
[[nodiscard]] SpanEquilibrium shoot_span(const RodSpan& span, RodMesh mesh,
                                         std::vector<RodState> start, const ClampFrames& frames,
                                         const ShootingOptions& options);

/// The mesh on which it has been closed.
[[nodiscard]] RodMesh closed_mesh(const RodSpan& span, const SpanEquilibrium& equilibrium);

/// Energies of an equilibrium that close_span() has found, and its stability if the span's loads
/// have a potential.
void complete(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium);

/// Looks at the second variation of an equilibrium.
/// @param tolerance  of the integrator
void judge_stability(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium);

/// What bends a rod over lengths of one over its root: the largest |n| / b, (|m| / b)^2 and square
/// of a natural strain.
[[nodiscard]] double bending_force(const RodSpan& span, const std::vector<RodState>& states);

/// The cross-sections at arc lengths that grow; NaN if the integrator gave up.
[[nodiscard]] std::vector<RodState> states_at(const SpanEquilibrium& equilibrium,
                                              const RodSpan& span, const std::vector<double>& s,
                                              double tolerance);

/// Frames for states whose tangents, moments and forces are known, one for each node: they follow
/// that of the first clamp, or any if there is none, from node to node by the rod's equations and
/// by the shortest rotation to the next tangent.
void carry_frames(const RodSpan& span, const RodMesh& mesh, double tolerance,
                  std::vector<RodState>& states);

}  // namespace dlo::energy_model
