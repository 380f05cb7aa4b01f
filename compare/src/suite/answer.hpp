#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "suite/battery.hpp"

namespace dlo::compare {

/// Equilibrium of a scene other than its answer.
struct OtherEquilibrium {
  double energy_J = 0;    ///< total energy [J]
  bool stable = false;    ///< whether it is stable, as far as known
  double distance_m = 0;  ///< RMS distance from the answer [m]
};

/// Bounds of the differences between the results of two methods. The bound of the points includes
/// the error estimates of both, if they are known.
struct AnswerBounds {
  double points_m = 0;              ///< largest distance of a point plus the error estimates [m]
  std::vector<double> forces_N;     ///< difference of the force of each gripper [N]
  std::vector<double> torques_Nm;   ///< difference of the torque of each gripper [N m]
  double energy_J = 0;              ///< difference of the total energy [J]
  std::vector<double> obstacles_N;  ///< difference of the force of each obstacle [N]
};

/// Equilibrium of a scene, computed by two methods.
struct Answer {
  BatteryScene battery_scene;  ///< the scene
  Solution first;              ///< the answer: by `energy`, or by `exact` if the rod stretches
  std::string second_method;   ///< name of the second method: "exact", "chain, N = 1024"
  AnswerBounds bounds;         ///< differences between both solutions
  /// Other equilibria that a search has found, in the order of energy; none if the rod stretches,
  /// since no search is then made.
  std::vector<OtherEquilibrium> others;
  bool is_lowest = true;  ///< whether no stable equilibrium with less energy was found
};

/// Number of points of an answer, at equal arc lengths.
inline constexpr int answer_points = 101;

/// Largest allowed AnswerBounds::points_m, divided by the length. If it is larger, the methods do
/// not agree.
inline constexpr double method_tolerance = 1e-6;
/// Largest allowed AnswerBounds::points_m, divided by the length, if the second method is a chain,
/// which has a discretisation error.
inline constexpr double chain_method_tolerance = 2e-4;

/// Solves a scene by both methods, compares them, and, unless the rod stretches, searches for other
/// equilibria.
/// @throws ConvergenceError if a method does not converge, or if they do not agree
[[nodiscard]] Answer certified_answer(const BatteryScene& scene);

/// Returns the model of the first method.
[[nodiscard]] Model answer_model(const Scene& scene);

/// Result of the balance of moments along a shape.
struct MomentBalance {
  /// Norm of the moments that nothing balances, divided by that of the bending moments [-].
  double imbalance = 0;
  double stiffness = 1;  ///< fitted factor c of EI
  double weight = 1;  ///< fitted factor a of the weight; 1 unless there is weight and another load
  /// Relative error of the moments due to the distance h of the points: in a rod with bending
  /// layers of length sqrt(EI / F), due to forces F, curvatures are accurate to a quarter of h^2 F
  /// / EI. EI is the scene's stiffness or, if it is less, the fitted one [-]
  double resolution = 0;
};

/// Computes the fraction of a shape's bending moments that is balanced neither by its loads nor by
/// forces and torques of the grippers at its ends, for any stiffness and weight,
///     min over c, a, M, F of |c EI kappa_i - a w_i - m_i - M - (P_n - P_i) x F| / |c EI kappa_i|.
/// w_i and m_i are the moments about P_i of the weight and of the other loads beyond it. At rest
/// this fraction is a discretisation error. Joints adjacent to the ends are left out, and a is 1
/// unless there are weight and other loads. Returns std::nullopt unless the rod is round, straight,
/// of one section, held only at its ends, subject to nothing else, and bent, with at least six
/// segments.
/// @param scene  without drag and loads that follow the rod, which is not checked
/// @param shape  shape of the whole rod, in the scene's frame
/// @param power  exponent of 2 sin(angle / 2) in the moments of the springs, > 0; 1: EI kappa
[[nodiscard]] std::optional<MomentBalance> moment_balance(const Scene& scene, const Shape& shape,
                                                          double power = 1);

/// Motion of a scene, computed by two methods.
struct MotionAnswer {
  BatteryScene battery_scene;            ///< the scene, which has a motion
  std::vector<double> times;             ///< times of the frames [s]
  std::vector<double> arc_length;        ///< arc lengths of the points [m]
  std::vector<Eigen::Matrix3Xd> frames;  ///< points of the answer at each time, by `energy` [m]
  std::string second_method;             ///< name of the second method
  /// Largest distance of a point from the second method's, plus the error estimates of both [m].
  double points_bound_m = 0;
};

/// Number of points of a motion's answer, at equal arc lengths.
inline constexpr int motion_points = 25;

/// Largest allowed MotionAnswer::points_bound_m, divided by the length. If it is larger, the
/// methods do not agree.
inline constexpr double motion_method_tolerance = 2e-4;

/// Computes a motion by the energy model, and by chains of 24, 48 and 96 hinges (hinge_limit()).
/// @throws ConvergenceError if a method does not reach the end, or if they do not agree
[[nodiscard]] MotionAnswer certified_motion(const BatteryScene& scene);

}  // namespace dlo::compare
