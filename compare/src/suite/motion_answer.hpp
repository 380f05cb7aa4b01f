#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/solve.hpp"
#include "suite/battery.hpp"

namespace dlo::compare {

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
