#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "dynamics/span_integrator.hpp"
#include "problem/split.hpp"
#include "search/placed_shape.hpp"

namespace dlo::energy_model {

/// What one span does at one time, SI units.
struct SpanFrame {
  EnergyBalance energy;
  std::vector<std::pair<std::size_t, Reaction>> grips;             ///< by index of the grip
  std::vector<std::pair<std::size_t, Eigen::Vector3d>> obstacles;  ///< by index
  PlacedShape shape;
};

/// How it went with one span.
struct SpanRun {
  std::vector<SpanFrame> frames;  ///< at the begin, and at the times that were reached
  SolveStatus status = SolveStatus::failed;
  std::string message;
  bool left_plane = false;  ///< a planar span has been asked to leave its plane
  long steps = 0;
  double smallest_step = std::numeric_limits<double>::infinity();  ///< [s]
  double error = 0;                                                ///< of the length
  double depth = 0;                                                ///< within rigid obstacles [m]
};

/// A span between clamps that move.
class MovingSpan {
 public:
  /// @param rod    of which Problem::grips are where they are at the begin, and each has a motion
  /// @param begin  [s]
  MovingSpan(const MovingRod& rod, PlacedSpan placed, double begin);

  /// @param masses  point masses that no other span carries
  [[nodiscard]] SpanRun run(const StartingShape& start, const std::vector<PointMass>& masses,
                            std::span<const double> times, const DynamicsOptions& options,
                            const Deadline& deadline) const;

 private:
  /// With one law of contact; ends where it lets the rod in too deep.
  [[nodiscard]] std::string settle(SpanIntegrator& integrator, SpanDynamics& model,
                                   const DynamicsOptions& options, SpanInstant& at) const;
  [[nodiscard]] SpanRun run_with(const ContactLaw& contact, const StartingShape& start,
                                 const std::vector<PointMass>& masses,
                                 std::span<const double> times, const DynamicsOptions& options,
                                 const Deadline& deadline) const;
  [[nodiscard]] BodyPlace place(std::size_t obstacle, double seconds,
                                const Eigen::Matrix3d& axes) const;
  [[nodiscard]] SpanInertia inertia(const std::vector<PointMass>& masses) const;
  [[nodiscard]] Eigen::Matrix3d to_axes(double time) const;
  [[nodiscard]] SpanDrive drive(double time) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> first_d1(const StartingShape& start) const;
  [[nodiscard]] SpanFrame frame(SpanIntegrator& integrator, SpanDynamics& model,
                                const SpanInstant& at) const;
  [[nodiscard]] GripPose pose(std::size_t grip, double time) const;
  [[nodiscard]] std::vector<double> own_breaks() const;
  [[nodiscard]] Eigen::VectorXd equilibrium_rates(SpanDynamics& model, const SpanInstant& at) const;
  [[nodiscard]] Eigen::MatrixX3d point_velocities(const StartingVelocities& velocities,
                                                  const SpanDynamics& model) const;
  void take(const SpanIntegrator& integrator, SpanRun& run) const;

  const MovingRod& rod_;
  PlacedSpan placed_;
  std::vector<std::size_t> grips_;  // that hold it, the anchor first
  double begin_;
  double length_, force_, time_, mass_;  // units
  std::vector<Eigen::Quaterniond> first_turns_;
};

}  // namespace dlo::energy_model
