#pragma once

#include <Eigen/Core>

#include "frames/rod_frames.hpp"

namespace dlo::energy_model {

/// Number of Newton steps after which more steps do not improve a fit of tangents.
inline constexpr int most_fit_steps = 3;

/// Returns the unknowns whose tangents at the nodes come nearest to `tangents` (3 x nodes), by
/// least squares on each element; without twist.
/// @param most_steps  maximum number of Newton steps, each with one evaluation into `scratch`
[[nodiscard]] Eigen::VectorXd fit(const RodFrames& frames, const Eigen::Matrix3Xd& tangents,
                                  int most_steps, RodFrames::State& scratch);

/// Returns the unknowns of the same shape with the rod's frame rotated about the tangent by the
/// angles `roll` at the nodes [rad]; for three fields.
[[nodiscard]] Eigen::VectorXd rolled(const RodFrames& frames, const Eigen::VectorXd& x,
                                     const Eigen::VectorXd& roll);

}  // namespace dlo::energy_model
