#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"

namespace dlo::compare {

/// How the first gripper moves before the rod is left to itself, by equal shares a step.
struct GripMotion {
  long steps = 0;                                      ///< over which the motion is spread
  Eigen::Vector3d movement = Eigen::Vector3d::Zero();  ///< of the whole motion [m]
  double turn = 0;                                     ///< of the whole motion, about +z [rad]
};

/// A rod and a start that a stepper may stumble over.
struct HardCase {
  std::string name;               ///< short, for --case
  std::string what;               ///< one line: what is hard about it
  Discretisation discretisation;  ///< of the rod, before the motion
  Eigen::Matrix3Xd start;         ///< [m], 3 x N
  GripMotion motion;              ///< of the first gripper
  /// Steps from the rest shape on, in which nothing may happen; 0: the rod is to come to rest.
  long steps_at_rest = 0;
  /// Why there is no physical answer, as discretise says it; empty where there is one.
  std::string refusal;

  /// Points [m] that move with the first gripper through a share (0 to 1) of the motion.
  [[nodiscard]] Eigen::Matrix3Xd moved(const Eigen::Matrix3Xd& points, double share) const;

  /// The rod after that share.
  [[nodiscard]] force_model::Rod rod(double share) const;
};

/// The rod of the hard cases, see hard_cases.
[[nodiscard]] Scene hard_case_scene();

/// The hard cases of `dlo stability`, in the order of its table.
///
/// Unless a case says otherwise it is the paper's spring steel rod (0.5 m long, 2 mm thick), N =
/// 16, law hooke, bookkeeping consistent, clamped horizontally, gravity such that Gamma = 2. Its
/// c_c lets the loads stretch it by a thousandth at most and is no lower than AE / 1000, the
/// paper's own choice for this rod; the cases with c_c = AE show what that choice saves. Starts
/// that are the rest shape of something else, as before a gripper jumps, come from solve_polygon;
/// random ones have fixed seeds.
/// @param steps_at_rest  of the case that stays at rest, > 0
/// @throws ConvergenceError if solve_polygon finds no start
[[nodiscard]] std::vector<HardCase> hard_cases(long steps_at_rest);

}  // namespace dlo::compare
