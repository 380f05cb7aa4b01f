#pragma once

#include <Eigen/Core>

#include "frames/rod_frames.hpp"

namespace dlo::energy_model {

/// Newton's steps after which tangents are fitted as well as the coefficients can.
inline constexpr int most_fit_steps = 3;

/// Unknowns whose tangents at the nodes are these (3 x nodes), by least squares on each piece;
/// without twist.
/// @param most_steps  of Newton's method towards them, an evaluation into `scratch` each
[[nodiscard]] Eigen::VectorXd fit(const RodFrames& frames, const Eigen::Matrix3Xd& tangents,
                                  int most_steps, RodFrames::State& scratch);

/// Of three fields: the same shape with the rod's frame turned ahead by these angles at the nodes
/// [rad].
[[nodiscard]] Eigen::VectorXd rolled(const RodFrames& frames, const Eigen::VectorXd& x,
                                     const Eigen::VectorXd& roll);

}  // namespace dlo::energy_model
