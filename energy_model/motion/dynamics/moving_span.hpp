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

/// Results of one span at one time, in SI units.
struct SpanFrame {
  EnergyBalance energy;
  std::vector<std::pair<std::size_t, Reaction>> grips;             ///< by index of the grip
  std::vector<std::pair<std::size_t, Eigen::Vector3d>> obstacles;  ///< by index
  PlacedShape shape;
};

/// Results of one run of a span.
struct SpanRun {
  std::vector<SpanFrame> frames;  ///< at the begin and at the times that were reached
  SolveStatus status = SolveStatus::failed;
  std::string message;
  bool left_plane = false;  ///< whether the motion would move a planar span out of its plane
  long steps = 0;
  double smallest_step = std::numeric_limits<double>::infinity();  ///< [s]
  double error = 0;                                                ///< divided by the rod length
  double depth = 0;  ///< largest depth within rigid obstacles [m]
};

/// A span between moving clamps.
class MovingSpan {
 public:
  /// @param rod    Problem::grips are at their positions at the begin, and each has a motion
  /// @param begin  time of the begin [s]
  MovingSpan(const MovingRod& rod, PlacedSpan placed, double begin);

  /// Simulates the span. @param masses  point masses that no other span carries
  [[nodiscard]] SpanRun run(const StartingShape& start, const std::vector<PointMass>& masses,
                            std::span<const double> times, const DynamicsOptions& options,
                            const Deadline& deadline) const;

 private:
  /// settle() prepares the initial state. run_with() simulates with one contact law and ends when
  /// the rod enters a rigid obstacle too deeply.
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
  std::vector<std::size_t> grips_;  // grips of the span, the anchor first
  double begin_;
  double length_, force_, time_, mass_;  // units
  std::vector<Eigen::Quaterniond> first_turns_;
};

}  // namespace dlo::energy_model
