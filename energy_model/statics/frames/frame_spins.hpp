#pragma once

#include <Eigen/Core>

#include "frames/rod_frames.hpp"

namespace dlo::energy_model {

/// How cross-sections turn: at the pieces' nodes (nodes x 3) and at the end.
struct FrameSpins {
  Eigen::MatrixX3d velocities, accelerations;
  Eigen::Vector3d end_velocity, end_acceleration;
};

/// The rates v and accelerations a of a rod's unknowns, and those of its start in space, without
/// the turn of a free one.
struct FrameRates {
  Eigen::VectorXd v, a;
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  Eigen::Vector3d spin_rate = Eigen::Vector3d::Zero();
};

/// Angular velocities and accelerations in space,
///     omega_s = R u',  alpha_s = R u'' + omega x R u',
/// collocated as the directors are.
[[nodiscard]] FrameSpins frame_spins(const RodFrames& frames, const RodFrames::State& state,
                                     const FrameRates& rates);

}  // namespace dlo::energy_model
