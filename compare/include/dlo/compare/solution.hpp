#pragma once

#include <limits>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// The models that solve a scene.
enum class Model {
  energy,  ///< minimiser of the continuous rod's energy
  chain,   ///< minimiser over the force model's polygon
  exact,   ///< boundary value problem of the rod, shot with GSL
  force,   ///< the paper's model, stepped to rest
};

/// As options and files spell them.
template <>
struct Choices<Model> {
  /// In the enumeration's order.
  static constexpr Choice<Model> all[] = {
      {Model::energy, "energy", "the rod's lowest energy"},
      {Model::chain, "chain", "the lowest energy of the force model's polygon"},
      {Model::exact, "exact", "the rod's balance, shot"},
      {Model::force, "force", "the paper's model, stepped to rest"}};
};

/// Limits of the solvers.
struct SolveOptions {
  int terms = 0;                 ///< of the energy model, 0: as many as needed
  int max_evaluations = 20000;   ///< of the minimisers
  long max_steps = 20'000'000;   ///< of the force model
  double time_limit = 20;        ///< of each solve of a model [s], > 0
  double rest_tolerance = 1e-7;  ///< of the force model, share of the rod's length
  /// Take a shape whose status is `not_verified` or `near_singular`, to show it with that status;
  /// nothing may be concluded from it.
  bool accept_unverified = false;
  /// Of the energy model, and of exact for a rod that stretches: an equilibrium of a similar scene
  /// to follow, instead of the lowest.
  const energy_model::Equilibrium* start = nullptr;
  /// What is neglected is told from here on, of the length and of the largest tension [-], > 0.
  double target = 1e-3;
};

/// Energies [J]; gravity and loads are zero at the first gripper.
struct SceneEnergies {
  double bending = 0;   ///< of the joints or the curvature
  double twisting = 0;  ///< where the scene holds twist, but for Solution::neglected
  double gravity = 0;   ///< of the rod's weight
  double load = 0;      ///< of loads, at points and per length
  double stretch = 0;   ///< of elastic segments
  double contact = 0;   ///< of obstacles that yield

  /// Of all [J].
  [[nodiscard]] double total() const {
    return bending + twisting + gravity + load + stretch + contact;
  }
};

/// What a gripper exerts on the rod, torque about its position.
struct GripperLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
};

/// What axial stretch would change of a shape whose model has none, to first order in N/EA. NaN:
/// not known, or EA is not, or the strain is too small to matter.
struct StretchEffect {
  double strain = std::numeric_limits<double>::quiet_NaN();   ///< the largest |N| / EA [-]
  double moved_m = std::numeric_limits<double>::quiet_NaN();  ///< the points, RMS [m]
  double tension = std::numeric_limits<double>::quiet_NaN();  ///< by its largest value's share [-]
};

/// What became of the stretch of a scene that leaves it to an estimate (Stretch::automatic).
enum class StretchDecision {
  given,         ///< it does not leave it, or the model is chain or force, whose segments stretch
  counted,       ///< it matters
  below_target,  ///< it does not, and is neglected
  not_modelled,  ///< it matters, and the model has none, or not of this scene
};

/// As JSON spells them.
template <>
struct Choices<StretchDecision> {
  /// In the enumeration's order.
  static constexpr Choice<StretchDecision> all[] = {
      {StretchDecision::given, "given", "the scene says it"},
      {StretchDecision::counted, "counted", "it matters"},
      {StretchDecision::below_target, "below_target", "it does not matter"},
      {StretchDecision::not_modelled, "not_modelled", "it matters, the model has none"}};
};

/// Turns of a part of the rod whose ends hold frames, in turns; the writhe is of that part with its
/// ends going on straight.
struct Linking {
  double begin = 0;         ///< arc length [m]
  double end = 0;           ///< arc length [m]
  double held = 0;          ///< by the grips, whole turns counted
  double twist = 0;         ///< of the shape: TwistedPart::angle
  double writhe = 0;        ///< of its axis
  double writhe_error = 0;  ///< estimate of the error of the writhe
};

/// A shape and what it cost. Only converged shapes are returned, and those that are not verified or
/// near singular to whoever accepts them (SolveOptions::accept_unverified).
struct Solution {
  Model model = Model::energy;  ///< that solved it
  /// `converged`, `roundoff_limited`, `not_verified` or `near_singular`; of solve_all() `saddle`
  /// too.
  energy_model::SolveStatus status = energy_model::SolveStatus::converged;
  std::string message;     ///< how the solver ended
  double penetration = 0;  ///< of energy: Equilibrium::penetration [m]
  Shape shape;             ///< of the rod
  /// From solve() and solve_all(), at the shape's points: curvature [1/m], a polygon's that of its
  /// joints.
  std::vector<double> curvature;
  /// Of energy and exact: tension [N] there, positive where the rod is pulled; at a gripper or load
  /// inside the rod that of the side towards l. None where a yielding obstacle is touched.
  std::vector<double> tension;
  Eigen::Matrix3Xd d1;                     ///< there, of energy and exact: Samples::d1
  SceneEnergies energy;                    ///< of that shape
  std::vector<GripperLoad> grippers;       ///< in the scene's order
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each on the rod [N]
  /// Of energy and exact: where it touches rigid ones, `obstacle` being the obstacle's index in the
  /// scene.
  std::vector<energy_model::ContactPart> contacts;
  std::vector<energy_model::TwistedPart> twists;  ///< as Equilibrium::twists
  /// Of energy and exact, of the same parts; but where an end's line passes through the rod.
  std::vector<Linking> linking;
  /// What the scene has and the model neglects: "twist", "natural curvature", "friction"
  /// (where it touches an obstacle that has it; of Comparison, where either model does), "stretch"
  /// (of energy and exact, where solve() finds that it matters).
  std::vector<std::string> neglected;
  /// Of energy and exact, from solve() and solve_all(): of the shape without stretch, also where
  /// that estimate made stretch count.
  StretchEffect stretch;
  StretchDecision stretch_decision = StretchDecision::given;  ///< likewise
  /// Smallest eigenvalue of the reduced Hessian over EI/l, where a search looked; else NaN.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// Of energy, from solve() and solve_all(): as Equilibrium::stable_energies [J].
  std::vector<double> stable_energies;
  int passing_starts = 0;  ///< of energy: as Equilibrium::passing_starts
  /// Of a `near_singular` one of energy: directions in which it is singular, at a fold or
  /// bifurcation.
  int neutral_directions = 0;
  long evaluations = 0;   ///< of minimisers; shots of exact
  long steps = 0;         ///< of force
  int terms = 0;          ///< curvature coefficients of energy
  double seconds = 0;     ///< wall time of the solver
  Parameters parameters;  ///< of chain and force
  double c_F = 0;         ///< of force, at its last step
  double c_h = 0;         ///< of force, at its last step [-]
  /// What the points may be away from those of an equilibrium of the model [m]: of energy the
  /// estimate of Equilibrium, of force that to rest. NaN: not known.
  double error_estimate = std::numeric_limits<double>::quiet_NaN();
  Eigen::Matrix3Xd to_rest;  ///< of force: Newton's step to rest from each point [m]
};

}  // namespace dlo::compare
