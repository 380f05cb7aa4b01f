#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/chain.hpp"

namespace dlo::energy_model {

/// What the joints of chains and polygons of n segments may be.
/// @throws std::invalid_argument naming `problem` and the first number that is out of range
void require_unlike_joints(const char* problem, JointLaw law, const Eigen::VectorXd& stiffnesses,
                           const Eigen::VectorXd& natural_turns, Eigen::Index n);

}  // namespace dlo::energy_model
