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

/// An equilibrium of a scene beside the answer.
struct OtherEquilibrium {
  double energy_J = 0;             ///< of all of it
  bool stable = false;             ///< as far as that is known
  double smallest_eigenvalue = 0;  ///< Solution::smallest_eigenvalue
  double apart_m = 0;              ///< RMS distance from the answer [m]
};

/// What the two methods' results are apart, and what they say of themselves: each number is within
/// its bound of that of the other method.
struct AnswerBounds {
  double points_m = 0;              ///< largest distance of a point, and the error estimates
  std::vector<double> forces_N;     ///< of each gripper
  std::vector<double> torques_Nm;   ///< of each gripper
  double energy_J = 0;              ///< of the total energy
  std::vector<double> obstacles_N;  ///< of the force of each obstacle
};

/// A scene's equilibrium, by two methods.
struct Answer {
  BatteryScene of;                       ///< the scene
  Solution first;                        ///< the answer: of `energy`, or `exact` if it stretches
  Solution second;                       ///< that it was held against
  std::string second_method;             ///< in words: "exact", "chain, N = 1024"
  AnswerBounds bounds;                   ///< how far these are apart
  std::vector<OtherEquilibrium> others;  ///< that a search has found, by energy
  bool is_lowest = true;                 ///< no other stable one has less energy
};

/// Arc lengths of an answer's points.
inline constexpr int answer_points = 101;

/// How far two methods may be apart, of the length: farther they do not agree.
inline constexpr double methods_agree = 1e-6;
/// The same where the second is a chain, which has an error of its own.
inline constexpr double chain_agrees = 2e-4;

/// Solves a scene by both methods and looks for other equilibria.
/// @throws ConvergenceError if one does not solve it, or if they do not agree
[[nodiscard]] Answer certified_answer(const BatteryScene& scene, const SolveOptions& options = {});

/// Of several scenes, in order. @param threads  0: all cores
[[nodiscard]] std::vector<Answer> certified_answers(const std::vector<BatteryScene>& scenes,
                                                    int threads, const SolveOptions& options = {});

/// The model of the first method.
[[nodiscard]] Model answer_model(const Scene& scene);

/// How far a shape is from balance.
struct MomentBalance {
  double imbalance = 0;  ///< share of its bending moments that nothing explains [-]
  double stiffness = 1;  ///< c, over EI
  double weight = 1;     ///< a, over the scene's; 1 unless there is weight and another load
  /// Share of the moments that is not identifiable from points at such distances: curvatures of a
  /// rod in which forces F bend layers of sqrt(EI / F) are found to a quarter of h^2 F / EI, EI
  /// being the scene's or, if that is less, the shape's [-]
  double resolution = 0;
};

/// The share of a shape's bending moments that neither its loads nor forces and torques of the
/// grippers at its ends explain, whatever the stiffness and the weight are,
///     min over c, a, M, F of |c EI kappa_i - a w_i - m_i - M - (P_n - P_i) x F| / |c EI kappa_i|,
/// w_i and m_i the moments about P_i of the weight and of the loads beyond it. At rest it is an
/// error of discretisation. Nothing where the scene has more than a round, straight rod of one
/// section, held at its ends alone.
/// @param shape  in the scene's frame, along the whole rod
/// @param power  of springs whose moments go with a power of 2 sin(angle / 2), > 0; 1: EI kappa
[[nodiscard]] std::optional<MomentBalance> moment_balance(const Scene& scene, const Shape& shape,
                                                          double power = 1);

/// A scene's motion, by two methods.
struct MotionAnswer {
  BatteryScene of;                       ///< the scene, which has a motion
  std::vector<double> times;             ///< [s]
  std::vector<double> arc_length;        ///< [m]
  std::vector<Eigen::Matrix3Xd> frames;  ///< the answer: points by time, of `energy` [m]
  std::string second_method;             ///< in words
  /// Largest distance of a point from that of the second method, and what both say of their own
  /// errors [m].
  double points_bound_m = 0;
};

/// Arc lengths of such an answer's points.
inline constexpr int motion_points = 25;

/// How far its two methods may be apart, of the length: farther they do not agree.
inline constexpr double motions_agree = 2e-4;

/// By the energy model, and by chains of 24, 48 and 96 hinges (hinge_limit()).
/// @throws ConvergenceError if one does not come to the end, or if they do not agree
[[nodiscard]] MotionAnswer certified_motion(const BatteryScene& scene,
                                            const SolveOptions& options = {});

/// Of several scenes, in order. @param threads  0: all cores
[[nodiscard]] std::vector<MotionAnswer> certified_motions(const std::vector<BatteryScene>& scenes,
                                                          int threads,
                                                          const SolveOptions& options = {});

}  // namespace dlo::compare
