#pragma once

#include <Eigen/Core>

#include "mjcf/mjcf_body.hpp"

namespace dlo::compare {

/// What the joint between two segments makes of a rod like them.
struct MjcfSpring {
  double bending = 0;   ///< EI [N m^2]
  double twisting = 0;  ///< GJ [N m^2]; 0: it holds no twist, or does not let it be
  /// Axis of a single hinge across the segment, in the world, unit; zero: it bends everywhere.
  Eigen::Vector3d hinge = Eigen::Vector3d::Zero();
};

/// Lengths, masses and springs of one rod are alike to a thousandth: what files are rounded to.
[[nodiscard]] bool are_alike(double a, double b);

/// Of a body's joints and its cable plugin.
/// @param direction  of its segment, in the body, unit
/// @param h  length that the joint stands for, half of both its segments [m]
/// @throws InputError naming file, line, element and attribute of what no rod is like
[[nodiscard]] MjcfSpring mjcf_spring(const XmlFile& xml, const MjcfBody& body,
                                     const Eigen::Vector3d& direction, double h);

}  // namespace dlo::compare
