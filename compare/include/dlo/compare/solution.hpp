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
  energy,  ///< minimises the energy of the continuous rod
  chain,   ///< minimises the energy of the force model's polygon
  exact,   ///< solves the boundary value problem of the rod by shooting, with GSL
  force,   ///< steps the paper's model to rest
};

/// Names of the models in options and files.
template <>
struct Choices<Model> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<Model> all[] = {
      {Model::energy, "energy", "the rod's lowest energy"},
      {Model::chain, "chain", "the lowest energy of the force model's polygon"},
      {Model::exact, "exact", "the rod's balance, shot"},
      {Model::force, "force", "the paper's model, stepped to rest"}};
};

/// Limits and options of the solvers.
struct SolveOptions {
  int terms = 0;  ///< energy_model::EnergyOptions::terms of the energy model, 0: as many as needed
  int max_evaluations = 20000;  ///< largest number of evaluations of one descent of a minimiser
  long max_steps = 20'000'000;  ///< largest number of steps of one simulation of the force model
  double time_limit = 20;       ///< limit of each solve of a model [s], > 0
  /// RMS distance from the rest shape below which the force model is at rest, divided by the length
  double rest_tolerance = 1e-7;
  /// Whether solvers return a shape whose status is `not_verified` or `near_singular`, to show it
  /// with that status. No conclusion may be drawn from such a shape.
  bool accept_unverified = false;
  /// Equilibrium of a similar scene that is followed, instead of a search for the lowest; for the
  /// energy model, and for exact if the rod stretches.
  const energy_model::Equilibrium* start = nullptr;
  /// Stretch is counted, or reported as neglected, if it changes the shape by more than this share
  /// of the length, or the largest tension by more than this share of it [-], > 0.
  double target = 1e-3;
};

/// Energies [J]. The bending energy of a polygon is that of its joints. The twisting energy is zero
/// if the model neglects twist.
using SceneEnergies = energy_model::Energies;

/// Force and torque of a gripper on the rod; the torque is about the gripper's position.
using GripperLoad = energy_model::Reaction;

/// Estimated effect of axial stretch on a shape of a model without stretch, to first order in N/EA.
/// NaN: the effect or EA is unknown, or the strain is too small to matter.
struct StretchEffect {
  double strain = std::numeric_limits<double>::quiet_NaN();  ///< largest |N| / EA [-]
  /// RMS displacement of the points [m].
  double displacement_m = std::numeric_limits<double>::quiet_NaN();
  /// Relative change of the largest tension [-].
  double tension = std::numeric_limits<double>::quiet_NaN();
};

/// Outcome of the estimate of stretch in a scene with Stretch::automatic.
enum class StretchDecision {
  /// no estimate decides: the scene has another Stretch, or segments stretch (chain, force)
  given,
  counted,       ///< stretch matters and is included
  below_target,  ///< stretch does not matter and is neglected
  not_modelled,  ///< stretch matters, but the model has none, or none for such a scene
};

/// Names of the decisions in JSON.
template <>
struct Choices<StretchDecision> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<StretchDecision> all[] = {
      {StretchDecision::given, "given", "the scene states it"},
      {StretchDecision::counted, "counted", "stretch exceeds the target error"},
      {StretchDecision::below_target, "below_target", "stretch is below the target error"},
      {StretchDecision::not_modelled, "not_modelled", "stretch matters, the model neglects it"}};
};

/// Twist and writhe of an interval of the rod between clamps that hold frames, in turns. The writhe
/// is that of the interval, continued by straight lines at its ends.
struct Linking {
  double begin = 0;         ///< arc length [m]
  double end = 0;           ///< arc length [m]
  double held = 0;          ///< link that the grips prescribe, whole turns counted
  double twist = 0;         ///< twist of the shape, from TwistedPart::angle
  double writhe = 0;        ///< writhe of the axis
  double writhe_error = 0;  ///< estimated error of the writhe
};

/// A shape and the cost of its solution. Solvers return converged shapes only, except that
/// SolveOptions::accept_unverified admits shapes that are not verified or near singular, and that a
/// balance under loads without a potential is returned as `not_verified`.
struct Solution {
  Model model = Model::energy;  ///< model that solved the scene
  /// `converged`, `roundoff_limited`, `not_verified` or `near_singular`; from solve_all(), and from
  /// solve_near() with `accept_unverified`, also `saddle`.
  energy_model::SolveStatus status = energy_model::SolveStatus::converged;
  std::string message;     ///< how the solver terminated
  double penetration = 0;  ///< Equilibrium::penetration, of energy and exact [m]
  Shape shape;             ///< points of the rod
  /// Curvature at the shape's points [1/m], of energy and exact; from solve() also of a polygon's
  /// joints.
  std::vector<double> curvature;
  /// Tension at the shape's points [N], of energy and exact, positive if the rod is pulled. At a
  /// gripper or load inside the rod it is the value of the side towards l. Empty if a compliant
  /// obstacle is touched.
  std::vector<double> tension;
  Eigen::Matrix3Xd d1;                ///< Samples::d1 at the shape's points, of energy and exact
  SceneEnergies energy;               ///< energies of the shape
  std::vector<GripperLoad> grippers;  ///< loads of the grippers, in the scene's order
  std::vector<Eigen::Vector3d> obstacles;  ///< force of each obstacle on the rod [N]
  /// Contacts with rigid obstacles, of energy and exact; `obstacle` is the index in the scene.
  std::vector<energy_model::ContactPart> contacts;
  std::vector<energy_model::TwistedPart> twists;  ///< as Equilibrium::twists
  /// Twist and writhe of the same intervals, of energy and exact; without those whose end
  /// directions are opposite and along the chord, which leaves writhe and held turns undetermined.
  std::vector<Linking> linking;
  /// Effects that the scene has and the model neglects: "twist", "natural curvature", "friction"
  /// (if the rod touches an obstacle with friction; in Comparison if either model does), "stretch"
  /// (of energy and exact, if its estimated effect exceeds SolveOptions::target; of chain with
  /// rigid segments, if the scene counts stretch).
  std::vector<std::string> neglected;
  /// Estimated effect of stretch, of energy and exact, from solve(), solve_near() and solve_all().
  /// It refers to the shape without stretch, also if the estimate led to a solution with stretch.
  StretchEffect stretch;
  /// decision on stretch, from solve(), solve_near() and solve_all()
  StretchDecision stretch_decision = StretchDecision::given;
  /// Equilibrium::smallest_eigenvalue, of energy and exact; else NaN.
  double smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// Equilibrium::stable_energies of the energy model [J], from solve() and solve_all().
  std::vector<double> stable_energies;
  int other_side_starts = 0;  ///< Equilibrium::other_side_starts of the energy model
  /// Number of directions in which a `near_singular` equilibrium of the energy model is singular,
  /// at a fold or bifurcation.
  int neutral_directions = 0;
  long evaluations = 0;   ///< evaluations of a minimiser, or shots of exact
  long steps = 0;         ///< steps of the force model
  int terms = 0;          ///< Equilibrium::terms of the energy model
  double seconds = 0;     ///< wall time of the solver
  Parameters parameters;  ///< parameters of chain and force
  double c_F = 0;         ///< c_F of the force model at its last step [m/N]
  double c_h = 0;         ///< c_h of the force model at its last step [-]
  /// Estimated distance of the points from an equilibrium of the model [m]: of energy
  /// Equilibrium::error_estimate times l, of force a bound of the RMS distance. NaN: unknown.
  double error_estimate = std::numeric_limits<double>::quiet_NaN();
  Eigen::Matrix3Xd to_rest;  ///< Newton's step to rest from each point of the force model [m]
};

}  // namespace dlo::compare
