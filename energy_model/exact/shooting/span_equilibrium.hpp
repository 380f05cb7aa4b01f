#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"
#include "shooting/rod_flow.hpp"
#include "shooting/second_variation.hpp"
#include "shooting/shooting_system.hpp"

namespace dlo::energy_model {

/// An equilibrium of a span in its own units, or the reason why there is none.
struct SpanEquilibrium {
  bool converged = false;
  std::string message = "never ran";
  int integrations = 0;  ///< integrations of the whole span, with or without linearisation
  /// Largest gap in r, R, m / f, n / f^2 at a node, where f^2 is the largest of |n|, |m|^2, the
  /// total load and 1 in the initial guess. From scan_tip() the distance of the unit tangent at the
  /// clamp from its direction.
  double residual = -1;
  Eigen::VectorXd s;  ///< arc lengths of the nodes: grips, loads and others between them
  /// Cross-sections at the nodes; m and n are those just after the node.
  std::vector<RodState> nodes;
  Energies energy;  ///< gravity and loads are zero if their points are at the problem's first grip
  std::vector<double> turns;  ///< int u_3 ds of each interval [rad]
  /// Cross-sections just before the nodes; that of the first node is without action.
  std::vector<RodState> before;
  ClampFrames frames;         ///< frames that its clamps hold
  RodContacts contacts;       ///< contacts
  SecondVariation stability;  ///< second variation of a converged equilibrium

  [[nodiscard]] bool stable() const { return converged && stability.stable(); }
};

/// Largest growth exponent of errors over an interval: its length times bending_force()^(1/2).
inline constexpr double largest_growth = 3;

/// Component of tangents or directors normal to the plane of a span up to which they lie in it.
inline constexpr double plane_tolerance = 1e-6;

/// Local error of the integrator where 10 digits of a shape suffice: on a branch before its end,
/// for the second variation, whose elements are accurate to 1e-8, and to compare shapes.
inline constexpr double coarse_tolerance = 1e-10;

[[nodiscard]] double longest_of(const RodMesh& mesh);

/// Solves for the nodes by Newton's method from an initial guess (shooting_system.hpp), without
/// energies and stability. If clamps twist a round rod, its shape may have nearly zero modes;
/// close_gaps.cpp describes the steps then.
/// @param start  cross-sections, one for each node of the mesh
[[nodiscard]] SpanEquilibrium close_span(const RodSpan& span, const RodMesh& mesh,
                                         const std::vector<RodState>& start,
                                         const ClampFrames& frames, const ShootingOptions& options);

/// Solves by Newton's method from an initial guess, and again on a finer mesh if the force that
/// bends the rod turns out to be large for the mesh. Computes energies and stability of a converged
/// result.
[[nodiscard]] SpanEquilibrium shoot_span(const RodSpan& span, RodMesh mesh,
                                         std::vector<RodState> start, const ClampFrames& frames,
                                         const ShootingOptions& options);

/// Returns the mesh of the equilibrium, with its contacts.
[[nodiscard]] RodMesh closed_mesh(const RodSpan& span, const SpanEquilibrium& equilibrium);

/// Computes the energies of an equilibrium of close_span(), and its stability if the span's loads
/// have a potential; otherwise it counts as stable().
void complete(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium);

/// Computes the second variation of an equilibrium; if that fails, the equilibrium no longer counts
/// as converged.
/// @param tolerance  local error of the integrator
void judge_stability(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium);

/// Returns the force over b that determines the length 1 / force^(1/2) over which a rod bends: the
/// largest of 1, |n| / b, (|m| / b)^2 and the square of a natural strain.
[[nodiscard]] double bending_force(const RodSpan& span, const std::vector<RodState>& states);

/// Returns the cross-sections at growing arc lengths; NaN if the integrator failed.
[[nodiscard]] std::vector<RodState> states_at(const SpanEquilibrium& equilibrium,
                                              const RodSpan& span, const std::vector<double>& s,
                                              double tolerance);

/// Computes frames for states with known tangents, moments and forces, one for each node. They
/// start from that of the first clamp, or an arbitrary one without a clamp, and are continued from
/// node to node by the rod's equations and the shortest rotation to the next tangent.
void carry_frames(const RodSpan& span, const RodMesh& mesh, double tolerance,
                  std::vector<RodState>& states);

/// Returns the largest component of a tangent across the span's plane; infinite without a plane.
[[nodiscard]] double out_of_plane(const RodSpan& span, const std::vector<RodState>& states);

/// The spans of a rod, and an equilibrium of each.
struct SolvedRod {
  std::vector<RodSpan> spans;  ///< by growing arc length
  std::vector<SpanEquilibrium> equilibria;

  /// Whether the rod is a single span whose directors are integrated from end to end.
  [[nodiscard]] bool has_directors() const {
    return spans.front().has_axes || !spans.front().round();
  }
};

/// Combines the spans to an equilibrium of the rod with its status, in the problem's units;
/// `failed` if a span has none.
/// @param tolerance  local error of the integrator, also for later samples of the shape
[[nodiscard]] Equilibrium assemble(const Problem& problem, SolvedRod solved, double tolerance);

}  // namespace dlo::energy_model
