#include "dynamics/moving_span.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "problem/rod_law.hpp"
#include "search/known_shape.hpp"
#include "strain/span_shape.hpp"
#include "vibration/inertia.hpp"

namespace dlo::energy_model {
namespace {

/// Components across its plane that a planar span may be given, over its own units.
constexpr double motion_plane_rounding = 1e-10;

/// A run is repeated with obstacles that are so much stiffer where they let the rod in too deep;
/// what strikes then goes half as deep.
constexpr double stiffer = 8;
constexpr int most_repeats = 20;

Moving moved_by(const Eigen::Matrix3d& by, const Moving& moving) {
  return {by * moving.value, by * moving.rate, by * moving.acceleration};
}

}  // namespace

MovingSpan::MovingSpan(const MovingRod& rod, PlacedSpan placed, double begin)
    : rod_(rod),
      placed_(std::move(placed)),
      begin_(begin),
      length_(rod.problem.length),
      force_(bending_unit(rod.problem) / (length_ * length_)),
      mass_(total_mass(rod.problem, rod.inertia)) {
  time_ = std::sqrt(mass_ * length_ / force_);
  for (const GripMotion& motion : rod_.motions) {
    first_turns_.push_back(motion(begin).turn.normalized());
  }
}

GripPose MovingSpan::pose(std::size_t grip, double time) const {
  GripPose result = rod_.motions[grip](time);
  result.turn = result.turn.normalized() * first_turns_[grip].conjugate();
  return result;
}

/// From space to the axes of the clamp at the start.
Eigen::Matrix3d MovingSpan::to_axes(double time) const {
  if (!placed_.span.start_direction) return placed_.frame;
  return placed_.frame * pose(placed_.anchor_grip, time).turn.conjugate().toRotationMatrix();
}

/// Where an obstacle is: a point x of its first place is at p + T (x - p0).
BodyPlace MovingSpan::place(std::size_t obstacle, double seconds,
                            const Eigen::Matrix3d& axes) const {
  BodyPlace result;
  result.turn = axes * placed_.frame.transpose();
  if (obstacle >= rod_.obstacle_motions.size() || !rod_.obstacle_motions[obstacle]) return result;
  const GripPose first = rod_.obstacle_motions[obstacle](begin_);
  const GripPose now = rod_.obstacle_motions[obstacle](seconds);
  const Eigen::Matrix3d turn =
      (now.turn.normalized() * first.turn.normalized().conjugate()).toRotationMatrix();
  const Eigen::Vector3d lever = turn * (placed_.anchor_position - first.position);
  result.turn = axes * turn * placed_.frame.transpose();
  result.origin = axes * (now.position + lever - placed_.anchor_position) / length_;
  result.velocity = axes * (now.velocity + now.angular_velocity.cross(lever)) * (time_ / length_);
  result.spin = axes * now.angular_velocity * time_;
  return result;
}

SpanDrive MovingSpan::drive(double time, bool planar, bool& left_plane) const {
  const double seconds = time * time_;
  const GripPose anchor = pose(placed_.anchor_grip, seconds);
  const Eigen::Matrix3d axes = to_axes(seconds);
  const auto position_of = [&](const GripPose& pose) {
    return moved_by(
        axes, {(pose.position - placed_.anchor_position) / length_,
               pose.velocity * (time_ / length_), pose.acceleration * (time_ * time_ / length_)});
  };
  SpanDrive result;
  result.turn = axes * placed_.frame.transpose();
  result.anchor = position_of(anchor);
  if (placed_.span.start_direction) {
    result.spin = axes * anchor.angular_velocity * time_;
    result.spin_rate = axes * anchor.angular_acceleration * (time_ * time_);
  }
  for (const std::size_t grip : placed_.hold_grips) {
    result.holds.push_back(position_of(pose(grip, seconds)));
  }
  const auto out = [&](const Eigen::Vector3d& along) {
    return std::abs(along.z()) > motion_plane_rounding * std::max(1.0, along.norm());
  };
  const auto leans = [&](const Eigen::Vector3d& about) {
    return about.head<2>().norm() > motion_plane_rounding * std::max(1.0, about.norm());
  };
  if (placed_.span.end_direction) {
    const GripPose end = pose(placed_.hold_grips.back(), seconds);
    const Eigen::Matrix3d turn = axes * end.turn.toRotationMatrix() * placed_.frame.transpose();
    result.end_spin = axes * end.angular_velocity * time_;
    const Eigen::Vector3d spin_rate = axes * end.angular_acceleration * (time_ * time_);
    const Eigen::Vector3d direction = *placed_.span.end_direction;
    const Eigen::Vector3d first = planar ? Eigen::Vector3d::UnitZ().cross(direction).eval()
                                         : direction.unitOrthogonal().eval();
    std::vector<Eigen::Vector3d> across = {first};
    if (!planar) across.emplace_back(direction.cross(first));
    for (const Eigen::Vector3d& e : across) {
      Moving moving;
      moving.value = turn * e;
      moving.rate = result.end_spin.cross(moving.value);
      moving.acceleration = spin_rate.cross(moving.value) + result.end_spin.cross(moving.rate);
      result.across_end.push_back(moving);
    }
    left_plane = left_plane || leans(result.end_spin);
  }
  left_plane = left_plane || leans(result.spin) || out(result.anchor.value) ||
               out(result.anchor.rate) || out(result.anchor.acceleration);
  for (const Moving& hold : result.holds) left_plane = left_plane || out(hold.rate);
  for (const Span::SoftObstacle& obstacle : placed_.span.soft_obstacles) {
    result.soft_obstacles.push_back(place(obstacle.index, seconds, axes));
  }
  for (const Span::Obstacle& obstacle : placed_.span.rigid_obstacles) {
    result.rigid_obstacles.push_back(place(obstacle.index, seconds, axes));
  }
  for (const std::vector<BodyPlace>* places : {&result.soft_obstacles, &result.rigid_obstacles}) {
    for (const BodyPlace& moved : *places) {
      left_plane = left_plane || out(moved.velocity) || leans(moved.spin);
    }
  }
  return result;
}

SpanInertia MovingSpan::inertia(const std::vector<PointMass>& masses) const {
  SpanInertia result;
  result.per_length =
      masses_per_length(rod_.problem, rod_.inertia, placed_, pieces_of(placed_.span));
  for (double& mass : result.per_length) mass /= mass_;
  for (const PointMass& point : masses) {
    result.points.push_back({placed_.s_of(point.at, length_), point.mass / mass_});
  }
  result.material_damping = rod_.material_damping / time_;
  result.drag = rod_.air_drag * time_ * length_ / mass_;
  return result;
}

SpanFrame MovingSpan::frame(SpanIntegrator& integrator, SpanDynamics& model,
                            const SpanInstant& at) const {
  SpanFrame result;
  const Eigen::VectorXd multipliers = integrator.settle(at);
  const SpanReactions reactions = model.reactions(multipliers);
  const double seconds = at.time * time_;
  const Eigen::Matrix3d to_space = to_axes(seconds).transpose();
  const double unit = force_ * length_;
  add(model.energies(), unit, result.energy);
  add(at.done, unit, result.energy);
  const auto add_grip = [&](std::size_t grip, const Eigen::Vector3d& force,
                            const Eigen::Vector3d& torque) {
    result.grips.emplace_back(grip, Reaction{to_space * force * force_, to_space * torque * unit});
  };
  add_grip(placed_.anchor_grip, reactions.anchor_force, reactions.anchor_torque);
  for (std::size_t k = 0; k < placed_.hold_grips.size(); ++k) {
    const bool last = placed_.span.end_direction && k + 1 == placed_.hold_grips.size();
    add_grip(placed_.hold_grips[k], reactions.hold_forces[k],
             last ? reactions.end_torque : Eigen::Vector3d::Zero().eval());
  }
  for (const auto& [obstacle, force] : model.obstacle_forces()) {
    result.obstacles.emplace_back(obstacle, to_space * force * force_);
  }
  const double end =
      placed_.reversed ? placed_.start : placed_.start + placed_.span.length * length_;
  result.shape = {model.shape(at.state.x),
                  placed_.reversed,
                  placed_.start,
                  end,
                  to_space,
                  pose(placed_.anchor_grip, seconds).position,
                  {}};
  return result;
}

SpanRun MovingSpan::run(const StartingShape& start, const std::vector<PointMass>& masses,
                        std::span<const double> times, const DynamicsOptions& options, bool planar,
                        const Deadline& deadline) const {
  ContactLaw contact;
  contact.depth = options.contact_depth;
  // What falls by the rod's length or moves as its slowest vibration, and strikes with all of its
  // length: int k d^2 (1 + v / u) dd takes v^2 / 2.
  const double speed = 1 + std::sqrt(2 * placed_.span.total_load());
  contact.stiffness =
      1.5 * speed * speed / (std::pow(contact.depth, 3) * (1 + speed / contact.rebound));
  SpanRun result;
  long steps = 0;
  for (int repeat = 0; repeat < most_repeats; ++repeat) {
    result = run_with(contact, start, masses, times, options, planar, deadline);
    steps += result.steps;
    result.steps = steps;
    if (result.status == SolveStatus::converged || result.left_plane) break;
    if (!(result.depth > contact.depth * length_) || deadline.passed()) break;
    contact.stiffness *= stiffer;
  }
  return result;
}

SpanRun MovingSpan::run_with(const ContactLaw& contact, const StartingShape& start,
                             const std::vector<PointMass>& masses, std::span<const double> times,
                             const DynamicsOptions& options, bool planar,
                             const Deadline& deadline) const {
  SpanRun result;
  Equilibrium at_rest;
  at_rest.sample = start;
  const TangentField tangents = field_of(at_rest, placed_, length_);
  Span span = placed_.span;
  span.planar = planar;
  const Eigen::Vector3d first = tangents(Eigen::VectorXd::Zero(1)).tangents.col(0);
  SpanDynamics model(std::move(span), options.terms, first, inertia(masses), contact);
  const Eigen::Matrix3Xd directions = tangents(model.nodes()).tangents;
  if (planar && directions.row(2).cwiseAbs().maxCoeff() > motion_plane_rounding) {
    result.left_plane = true;
    return result;
  }
  bool left_plane = false;
  SpanIntegrator integrator(
      model, [&](double time) { return drive(time, planar, left_plane); },
      {options.tolerance, options.step / time_, rod_.material_damping > 0 || model.may_touch()});
  SpanInstant at;
  at.time = begin_ / time_;
  at.state.x = model.fit(directions);
  at.state.v = Eigen::VectorXd::Zero(model.size());
  result.message = integrator.project(at);
  const auto stopped = [&] { return !result.message.empty() || (planar && left_plane); };
  if (!stopped()) {
    result.frames.push_back(frame(integrator, model, at));
    if (model.depth() > contact.depth) {
      result.message = "the rod begins within a rigid obstacle";
    }
  }
  const auto too_deep = [&] { return integrator.depth() > contact.depth; };
  const auto expired = [&] { return deadline.passed() || (planar && left_plane) || too_deep(); };
  std::vector<double> breaks = rod_.breaks;
  std::sort(breaks.begin(), breaks.end());
  // Grips that share a break strike the span once.
  const auto same = [&](double a, double b) {
    return SpanIntegrator::same_instant(a / time_, b / time_);
  };
  breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
  auto next_break = std::upper_bound(breaks.begin(), breaks.end(), begin_);
  for (const double time : times) {
    const auto is_due = [&](double at_break) { return at_break <= time || same(at_break, time); };
    for (; next_break != breaks.end() && is_due(*next_break) && !stopped(); ++next_break) {
      result.message = integrator.advance(at, *next_break / time_, expired);
      if (!stopped()) integrator.strike(at);
    }
    if (!stopped()) result.message = integrator.advance(at, time / time_, expired);
    if (stopped()) break;
    result.frames.push_back(frame(integrator, model, at));
  }
  result.left_plane = planar && left_plane;
  result.steps = integrator.steps();
  result.smallest_step = integrator.smallest_step() * time_;
  result.error = integrator.error();
  result.depth = integrator.depth() * length_;
  if (too_deep() && !deadline.passed()) {
    result.message = "a rigid obstacle is struck too hard for the depth that contact may have";
  }
  result.status = result.message.empty() ? SolveStatus::converged
                  : deadline.passed()    ? SolveStatus::time_limit
                                         : SolveStatus::failed;
  return result;
}

}  // namespace dlo::energy_model
