#pragma once

#include <Eigen/Core>
#include <functional>

#include "dlo/energy_model/polygon.hpp"

namespace dlo::energy_model {

/// Takes a 3 x 3 block of a Hessian that belongs to the points `row` and `column`; every block is
/// given, those below the diagonal too, some more than once to be added up.
using AddBlock =
    std::function<void(Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block)>;

/// Hessian of polygon_energy.
void polygon_hessian(const PolygonProblem& problem,
                     const Eigen::Ref<const Eigen::Matrix3Xd>& points, const AddBlock& add);

}  // namespace dlo::energy_model
