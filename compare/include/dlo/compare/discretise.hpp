#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/problem.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::compare {

/// c_b [N] of the paper's law for a material.
///     formula_21:      EI k^2 / ((1 - cos a) sin(a/2)),  a = L k (Formula 21 with L = l/(N-1))
///     moment_matched:  the same over a, so that the joint's moment at curvature k is EI k
/// @param bending_stiffness  EI [N m^2], > 0;  @param curvature  k [1/m], > 0
/// @param segment_length     L [m], > 0, with L k < pi
[[nodiscard]] double paper_bending_stiffness(BendingRule rule, double bending_stiffness,
                                             double curvature, double segment_length);

/// Parameters of the force model as they follow from a scene.
struct Parameters {
  double segment_length = 0;    ///< L [m]
  double c_b = 0;               ///< [N]; 0 for hooke
  double c_c = 0;               ///< [N]
  double design_curvature = 0;  ///< k of Formula 21 [1/m]; 0 for hooke or a given c_b
  double point_weight = 0;      ///< of an inner point [N]
};

/// A scene as points and segments.
struct Discretisation {
  force_model::Rod rod;
  Eigen::Matrix3Xd weights;        ///< the part of rod.loads that is gravity [N]
  Eigen::Matrix3Xd straight;       ///< straight from the gripper, where a simulation starts [m]
  std::vector<double> arc_length;  ///< of the points; a point inside the gripper is negative, or
                                   ///< beyond the rod's length [m]
  double length = 0;               ///< l, the rod's own part [m]
  Parameters parameters;

  /// The rod's own part, arc length 0 to l: points inside the gripper give way to the point where
  /// the gripper holds the rod.
  [[nodiscard]] Shape shape(const Eigen::Matrix3Xd& points) const;
};

/// Derives the force model of a scene with one clamp at either end.
/// @throws InputError if the force model does not know such a scene
[[nodiscard]] Discretisation discretise(const Scene& scene, const ForceModelSettings& settings);

/// The same polygon for the chain solver. @throws InputError unless the scene is planar
struct ChainScene {
  energy_model::ChainProblem problem;
  Eigen::Vector3d origin, x, y;  ///< frame of its plane

  [[nodiscard]] Eigen::Matrix3Xd to_space(const Eigen::Matrix2Xd& points) const;
};
[[nodiscard]] ChainScene chain_scene(const Scene& scene, const Discretisation& discretisation,
                                     const ForceModelSettings& settings);

/// The scene as the energy model sees it.
[[nodiscard]] energy_model::Problem energy_problem(const Scene& scene);

/// The stepper a scene asks for. @throws InputError if it lacks a constant that its stepper needs
[[nodiscard]] force_model::StepOptions step_options(const ForceModelSettings& settings,
                                                    const Discretisation& discretisation);

}  // namespace dlo::compare
