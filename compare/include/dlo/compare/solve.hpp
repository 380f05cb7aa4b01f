#pragma once

#include <limits>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/model.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Limits of the solvers.
struct SolveOptions {
  int terms = 0;                 ///< of the energy model, 0: as many as needed
  int max_evaluations = 20000;   ///< of the minimisers
  long max_steps = 20'000'000;   ///< of the force model
  double time_limit = 20;        ///< of each solve of a model [s], > 0
  double rest_tolerance = 1e-7;  ///< of the force model, share of the rod's length
  /// Take a shape of the energy model whose status is `not_resolved`, to show it with that status;
  /// nothing may be concluded from it.
  bool accept_unresolved = false;
  /// Of the energy model: an equilibrium of a similar scene to follow, instead of the lowest.
  const energy_model::Equilibrium* start = nullptr;
};

/// Energies [J]; gravity and loads are zero at the first gripper.
struct SceneEnergies {
  double bending = 0;  ///< of the joints or the curvature
  double gravity = 0;  ///< of the rod's weight
  double load = 0;     ///< of point loads
  double stretch = 0;  ///< of elastic segments
  double contact = 0;  ///< of obstacles that yield

  /// Of all [J].
  [[nodiscard]] double total() const { return bending + gravity + load + stretch + contact; }
};

/// What a gripper exerts on the rod, torque about its position.
struct GripperLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
};

/// A shape and what it cost. Only converged shapes are returned, and those that are not resolved to
/// whoever accepts them (SolveOptions::accept_unresolved).
struct Solution {
  Model model = Model::energy;  ///< that solved it
  /// `converged`, `roundoff_limited` or `not_resolved`; of solve_all() `saddle` too.
  energy_model::SolveStatus status = energy_model::SolveStatus::converged;
  std::string message;     ///< how the solver ended
  double penetration = 0;  ///< of energy: Equilibrium::penetration [m]
  Shape shape;             ///< of the rod
  /// From solve() and solve_all(), at the shape's points: curvature [1/m], a polygon's that of its
  /// joints.
  std::vector<double> curvature;
  /// Of energy and exact: tension [N] there, positive where the rod is pulled; at a gripper or load
  /// inside the rod that of the side towards l. None where an obstacle is touched.
  std::vector<double> tension;
  SceneEnergies energy;                    ///< of that shape
  std::vector<GripperLoad> grippers;       ///< in the scene's order
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each on the rod [N]
  /// Smallest eigenvalue of the second variation over EI/l, where a search looked; else NaN.
  double smallest_curvature = std::numeric_limits<double>::quiet_NaN();
  long evaluations = 0;        ///< of minimisers; shots of exact
  long steps = 0;              ///< of force
  int terms = 0;               ///< curvature coefficients of energy
  double seconds = 0;          ///< wall time of the solver
  Parameters parameters;       ///< of chain and force
  double c_F = 0;              ///< of force, at its last step
  double c_h = 0;              ///< of force, at its last step [-]
  double remaining_error = 0;  ///< of force: estimated distance to rest [m]
  Eigen::Matrix3Xd to_rest;    ///< of force: Newton's step to rest from each point [m]
};

/// The continuous reference of a scene: `energy` or `exact`.
/// @throws InputError, ConvergenceError; that too where a shape is not resolved, unless
/// `accept_unresolved` is set
[[nodiscard]] energy_model::Equilibrium solve_reference(const Scene& scene, Model model,
                                                        const SolveOptions& options = {});

/// Every equilibrium that the energy model finds, as it is: stable ones first, by energy; never
/// empty. @throws InputError, ConvergenceError
[[nodiscard]] std::vector<energy_model::Equilibrium> reference_states(
    const Scene& scene, const SolveOptions& options = {});

/// Solves a scene, without the obstacles that its rod cannot reach (see make_plan), whose forces
/// are zero. Continuous models are sampled at `arc_lengths` (or at 101 equal ones if empty);
/// polygons keep their points, or are resampled on straight lines when `arc_lengths` are given.
/// @throws InputError if the model does not know such a scene, ConvergenceError
[[nodiscard]] Solution solve(const Scene& scene, Model model, const SolveOptions& options = {},
                             const std::vector<double>& arc_lengths = {});

/// Every equilibrium that the energy model finds, stable ones first, by energy; an unstable one has
/// a negative smallest_curvature. @throws InputError, ConvergenceError
[[nodiscard]] std::vector<Solution> solve_all(const Scene& scene, const SolveOptions& options = {},
                                              const std::vector<double>& arc_lengths = {});

/// The polygon of minimal energy: one clamp at an end, forces in a plane and no obstacle, of rigid
/// segments; else of segments with the force model's c_c, of several starts' shapes the lowest.
/// @throws InputError, ConvergenceError; that too where a segment differs from its rest length by
/// more than largest_strain(), with the number of points that would do
[[nodiscard]] Solution solve_chain(const Scene& scene, const ForceModelSettings& settings,
                                   const SolveOptions& options = {});

/// The chain of elastic segments in the equilibrium that a shape falls to; its c_c is the
/// settings'. For the paper's law between unequal segments see energy_model::PolygonProblem.
/// @param start  any polygon of the scene's rod
/// @throws InputError, ConvergenceError
[[nodiscard]] Shape chain_from(const Scene& scene, const ForceModelSettings& settings,
                               const Shape& start, const SolveOptions& options = {});

/// The force model at rest. Between several grippers it starts where the chain's lowest shape came
/// from, and from near that shape where it ends in another state, so that both are in the same one;
/// where it still does not, the message says so. @throws InputError, ConvergenceError as
/// solve_chain
[[nodiscard]] Solution solve_force(const Scene& scene, const ForceModelSettings& settings,
                                   const SolveOptions& options = {});

}  // namespace dlo::compare
