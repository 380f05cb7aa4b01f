#pragma once

#include <Eigen/Core>
#include <optional>

#include "linear/free_hessian.hpp"

namespace dlo::energy_model {

/// The step p that lowers g.p + p.H p / 2 most in |p| <= radius, of the free directions of H.
/// @param flat     g is zero but for its tolerance
/// @param nearest  a Newton step as short as this is no step
/// @return nothing next to a minimum
[[nodiscard]] std::optional<Eigen::VectorXd> region_step(FreeHessian& hessian,
                                                         const Eigen::VectorXd& gradient,
                                                         double radius, bool flat, double nearest);

}  // namespace dlo::energy_model
