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
/// angles `roll` at the nodes [rad]; for three fields. The frame at the start is not rotated.
[[nodiscard]] Eigen::VectorXd rolled(const RodFrames& frames, const Eigen::VectorXd& x,
                                     const Eigen::VectorXd& roll);

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

/// Computes angular velocities and accelerations in space from the strains' time derivatives,
///     d omega / ds = R u_t,  d alpha / ds = R u_tt + omega x R u_t,
/// by the same collocation as the directors.
[[nodiscard]] FrameSpins frame_spins(const RodFrames& frames, const RodFrames::State& state,
                                     const FrameRates& rates);

}  // namespace dlo::energy_model
