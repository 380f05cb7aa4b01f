#pragma once

#include <Eigen/Core>

#include "dlo/energy_model/polygon.hpp"

namespace dlo::energy_model {

/// What solve_polygon takes. @throws std::invalid_argument naming the first number that is out of
/// range
void require_polygon(const PolygonProblem& problem, const Eigen::Ref<const Eigen::Matrix3Xd>& start,
                     const PolygonOptions& options);

}  // namespace dlo::energy_model
