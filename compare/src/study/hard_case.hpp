#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace dlo::compare {

/// Motion of the first gripper before the rod is left to itself, in equal increments per step.
struct GripMotion {
  long steps = 0;                                      ///< number of steps of the motion
  Eigen::Vector3d movement = Eigen::Vector3d::Zero();  ///< translation over the whole motion [m]
  double turn = 0;  ///< rotation about +z over the whole motion [rad]
};

/// Rod and initial shape that are difficult for a stepper.
struct HardCase {
  std::string name;               ///< short name, for --case
  std::string difficulty;         ///< one line: the difficulty of the case
  Discretisation discretisation;  ///< the rod before the motion
  Eigen::Matrix3Xd start;         ///< [m], 3 x N
  GripMotion motion;              ///< motion of the first gripper
  /// Number of steps from the rest shape during which the rod must stay at rest; 0: the rod has to
  /// come to rest.
  long steps_at_rest = 0;
  /// Message of discretise() that refuses the case because it has no physical solution; empty if it
  /// has one.
  std::string refusal;

  /// Moves points [m] with the first gripper through a fraction (0 to 1) of the motion.
  [[nodiscard]] Eigen::Matrix3Xd moved(const Eigen::Matrix3Xd& points, double share) const;

  /// Returns the rod after that fraction of the motion.
  [[nodiscard]] force_model::Rod rod(double share) const;
};

/// Returns the equilibrium of a polygon that solve_polygon finds from a start.
/// @param name  of the rod, for the message;  @param start  [m], 3 x N
/// @throws ConvergenceError if it finds none
[[nodiscard]] energy_model::PolygonResult polygon_at_rest(const std::string& name,
                                                          const force_model::Rod& rod,
                                                          const Eigen::Matrix3Xd& start);

/// Returns the scene of the rod that hard_cases() describes.
[[nodiscard]] Scene hard_case_scene();

/// Returns the hard cases of `dlo stability`, in the order of its table.
///
/// Unless a case states otherwise, the rod is the paper's spring steel rod (0.5 m long, 2 mm thick)
/// with N = 16, law hooke and convention consistent. It is clamped horizontally, and gravity is
/// scaled such that Gamma = 2. Its c_c is so large that the loads stretch it by at most a
/// thousandth, and at least AE / 1000, the paper's own choice for this rod. The cases with c_c = AE
/// show the cost that this choice saves. Initial shapes that are the rest shape of another problem,
/// as before a gripper jumps, are computed by solve_polygon; random ones have fixed seeds.
/// @param steps_at_rest  HardCase::steps_at_rest of the case that starts at rest, > 0
/// @throws ConvergenceError if solve_polygon finds no start
[[nodiscard]] std::vector<HardCase> hard_cases(long steps_at_rest);

}  // namespace dlo::compare
