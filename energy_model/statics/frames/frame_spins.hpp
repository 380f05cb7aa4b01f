#pragma once

#include <Eigen/Core>

#include "frames/rod_frames.hpp"

namespace dlo::energy_model {

/// Angular velocities and accelerations of cross-sections at the nodes of elements (nodes x 3) and
/// at the end.
struct FrameSpins {
  Eigen::MatrixX3d velocities, accelerations;
  Eigen::Vector3d end_velocity, end_acceleration;
};

/// Rates v and accelerations a of a rod's unknowns, and angular velocity and acceleration of its
/// start frame in space, without the rotation of a free start.
struct FrameRates {
  Eigen::VectorXd v, a;
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  Eigen::Vector3d spin_rate = Eigen::Vector3d::Zero();
};

/// Computes angular velocities and accelerations in space,
///     omega_s = R u',  alpha_s = R u'' + omega x R u',
/// by the same collocation as the directors.
[[nodiscard]] FrameSpins frame_spins(const RodFrames& frames, const RodFrames::State& state,
                                     const FrameRates& rates);

}  // namespace dlo::energy_model
