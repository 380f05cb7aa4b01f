#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
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

}  // namespace dlo::compare
