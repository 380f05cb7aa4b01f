#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace dlo::energy_model {

/// Checks the arguments of solve_polygon().
/// @throws std::invalid_argument naming the first number out of range
void require_polygon(const PolygonProblem& problem, const Eigen::Ref<const Eigen::Matrix3Xd>& start,
                     const PolygonOptions& options);

/// Checks stiffnesses and natural turns of the joints of chains and polygons with n segments.
/// @throws std::invalid_argument naming `problem` and the first number out of range
void require_unlike_joints(const char* problem, JointLaw law, const Eigen::VectorXd& stiffnesses,
                           const Eigen::VectorXd& natural_turns, Eigen::Index n);

}  // namespace dlo::energy_model
