#include "dynamics/moving_span.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/spin.hpp"
#include "frames/span_shape.hpp"
#include "problem/rod_law.hpp"
#include "search/known_shape.hpp"
#include "vibration/span_modes.hpp"

namespace dlo::energy_model {
namespace {

/// Largest component out of its plane of a planar span's motion, in the span's own units.
constexpr double motion_plane_rounding = 1e-10;

/// Factor by which rigid obstacles are stiffened for another run if the rod enters them too deeply,
/// which halves the depth of an impact; and maximum number of runs.
constexpr double obstacle_stiffening = 8;
constexpr int most_repeats = 20;

/// Whether the drive moves a planar span out of its plane.
bool leaves_plane(const SpanDrive& drive) {
  const auto out = [](const Eigen::Vector3d& along) {
    return std::abs(along.z()) > motion_plane_rounding * std::max(1.0, along.norm());
  };
  const auto tilts = [](const Eigen::Vector3d& about) {
    return about.head<2>().norm() > motion_plane_rounding * std::max(1.0, about.norm());
  };
  const auto moves_out = [&](const ObstaclePose& place) {
    return out(place.velocity) || tilts(place.spin);
  };
  return tilts(drive.spin) || tilts(drive.end_spin) || out(drive.grips.front().value) ||
         out(drive.grips.front().acceleration) ||
         std::ranges::any_of(drive.grips, out, &VectorMotion::rate) ||
         std::ranges::any_of(drive.obstacles, moves_out);
}

/// Returns the drive at the same positions with zero velocities and accelerations.
SpanDrive at_rest(SpanDrive drive) {
  drive.spin = drive.spin_rate = drive.end_spin = Eigen::Vector3d::Zero();
  for (VectorMotion& grip : drive.grips) grip = {grip.value};
  for (AcrossDirector& across : drive.across_end) across.direction = {across.direction.value};
  for (ObstaclePose& place : drive.obstacles) {
    place.velocity = place.spin = Eigen::Vector3d::Zero();
  }
  return drive;
}

/// Evaluates a start shape at the nodes. Angles of frames are accumulated from the start in small
/// steps.
StartShape start_shape_at(const TangentField& field, const Eigen::VectorXd& nodes) {
  constexpr Eigen::Index steps = 16;  // between neighbouring nodes
  Eigen::VectorXd s(steps * nodes.size() + 1);
  s[0] = 0;
  for (Eigen::Index q = 0; q < nodes.size(); ++q) {
    s.segment(steps * q + 1, steps) =
        Eigen::VectorXd::LinSpaced(steps + 1, s[steps * q], nodes[q]).tail(steps);
  }
  const StartShape all = field(s);
  const Eigen::VectorXi at = steps * Eigen::VectorXi::LinSpaced(nodes.size(), 1, nodes.size());
  StartShape result(all.tangents(Eigen::all, at));
  if (all.roll.size() > 0) result.roll = all.roll(at);
  return result;
}

class MovingSpan {
 public:
  /// @param rod    Problem::grips are at their positions at the begin, and each has a motion
  /// @param begin  time of the begin [s]
  MovingSpan(const MovingRod& rod, PlacedSpan placed, double begin)
      : rod_(rod),
        placed_(std::move(placed)),
        grips_(placed_.hold_grips),
        begin_(begin),
        length_(rod.problem.length),
        force_(bending_unit(rod.problem) / (length_ * length_)),
        mass_(total_mass(rod.problem, rod.inertia)) {
    time_ = std::sqrt(mass_ * length_ / force_);
    grips_.insert(grips_.begin(), placed_.anchor_grip);
    for (const GripMotion& motion : rod_.motions) {
      first_turns_.push_back(motion(begin).turn.normalized());
    }
  }

  [[nodiscard]] SpanRun run(const SpanMotion& motion, const DynamicsOptions& options,
                            const Deadline& deadline) const {
    ContactLaw contact;
    contact.depth = options.contact_depth;
    // Stiffness for an impact at the speed that the rod gains over its length or that its slowest
    // vibration has, of the whole rod at once: int k d^2 (1 + v / u) dd absorbs v^2 / 2.
    const double speed = 1 + std::sqrt(2 * placed_.span.total_load());
    contact.stiffness =
        1.5 * speed * speed / (std::pow(contact.depth, 3) * (1 + speed / contact.rebound));
    SpanRun result;
    long steps = 0;
    for (int repeat = 0; repeat < most_repeats; ++repeat) {
      result = run_with(contact, motion, options, deadline);
      steps += result.steps;
      result.steps = steps;
      if (result.status == SolveStatus::converged || result.left_plane) break;
      if (!(result.depth > contact.depth * length_) || deadline.passed()) break;
      contact.stiffness *= obstacle_stiffening;
    }
    return result;
  }

 private:
  [[nodiscard]] GripPose pose(std::size_t grip, double time) const {
    GripPose result = rod_.motions[grip](time);
    result.turn = result.turn.normalized() * first_turns_[grip].conjugate();
    return result;
  }

  /// Returns the rotation from space to the axes of the clamp at the start.
  [[nodiscard]] Eigen::Matrix3d rotation_to_axes(double time) const {
    if (!placed_.span.start_direction) return placed_.frame;
    return placed_.frame * pose(placed_.anchor_grip, time).turn.conjugate().toRotationMatrix();
  }

  /// Returns an obstacle's place: its point x at the begin has moved to p + T (x - p0).
  [[nodiscard]] ObstaclePose place(std::size_t obstacle, double seconds,
                                   const Eigen::Matrix3d& axes) const {
    ObstaclePose result;
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

  [[nodiscard]] SpanDrive drive(double time) const {
    const double seconds = time * time_;
    const Eigen::Matrix3d axes = rotation_to_axes(seconds);
    SpanDrive result;
    result.turn = axes * placed_.frame.transpose();
    std::vector<GripPose> poses;
    for (const std::size_t grip : grips_) {
      poses.push_back(pose(grip, seconds));
      const GripPose& now = poses.back();
      result.grips.push_back({axes * (now.position - placed_.anchor_position) / length_,
                              axes * now.velocity * (time_ / length_),
                              axes * now.acceleration * (time_ * time_ / length_)});
    }
    if (placed_.span.start_direction) {
      result.spin = axes * poses.front().angular_velocity * time_;
      result.spin_rate = axes * poses.front().angular_acceleration * (time_ * time_);
    }
    if (placed_.span.end_direction) {
      const GripPose& end = poses.back();
      const Eigen::Matrix3d turn = axes * end.turn.toRotationMatrix() * placed_.frame.transpose();
      result.end_spin = axes * end.angular_velocity * time_;
      const Eigen::Vector3d spin_rate = axes * end.angular_acceleration * (time_ * time_);
      const auto add_across = [&](const Eigen::Vector3d& held, bool of_d1) {
        result.across_end.push_back(
            {rotating_vector(turn * held, result.end_spin, spin_rate), of_d1});
      };
      const Eigen::Vector3d& along = *placed_.span.end_direction;
      const Eigen::Matrix3d held = frame_along(along, Span::d1(along));
      // d1 of a planar span is normal to its plane.
      if (!placed_.span.planar) add_across(held.col(0), false);
      add_across(held.col(1), false);
      if (placed_.span.twist) add_across(along.cross(placed_.span.twist->end_d1), true);
    }
    for (std::size_t i = 0; i < rod_.problem.obstacles.size(); ++i) {
      result.obstacles.push_back(place(i, seconds, axes));
    }
    return result;
  }

  [[nodiscard]] SpanInertia inertia(const std::vector<PointMass>& masses) const {
    SpanInertia result;
    result.per_length =
        masses_per_length(rod_.problem, rod_.inertia, placed_, elements_of(placed_.span));
    for (double& mass : result.per_length) mass /= mass_;
    for (const PointMass& point : masses) {
      result.points.push_back({placed_.s_of(point.at, length_), point.mass / mass_});
    }
    result.material_damping = rod_.material_damping / time_;
    result.drag = rod_.air_drag * time_ * length_ / mass_;
    result.quadratic_drag = rod_.quadratic_drag * length_ * length_ / mass_;
    return result;
  }

  /// Returns the breaks in the span's units, ascending. Breaks at the same instant cause one
  /// impulse.
  [[nodiscard]] std::vector<double> span_breaks() const {
    std::vector<double> breaks = rod_.breaks;
    for (double& time : breaks) time /= time_;
    std::sort(breaks.begin(), breaks.end());
    breaks.erase(std::unique(breaks.begin(), breaks.end(), SpanIntegrator::same_instant),
                 breaks.end());
    return breaks;
  }

  /// Returns d1 at the begin of the span, for a span where no clamp prescribes it; std::nullopt if
  /// the start has no d1.
  [[nodiscard]] std::optional<Eigen::Vector3d> first_d1(const StartingShape& start) const {
    const Samples at = start(std::vector<double>{placed_.start});
    if (at.d1.cols() == 0) return std::nullopt;
    const Eigen::Vector3d tangent = placed_.frame * at.tangents.col(0);
    return Eigen::AngleAxisd(placed_.reversed ? placed_.ahead : -placed_.ahead, tangent) *
           (placed_.frame * at.d1.col(0));
  }

  /// Returns the rates at which the unknowns of a shape in equilibrium follow the motion of grips
  /// and obstacles: the minimum-norm solution of K x' - J^T mu' + R' = 0, J x' + c' = 0, as rods on
  /// pins can rotate freely.
  [[nodiscard]] Eigen::VectorXd equilibrium_rates(SpanDynamics& model,
                                                  const SpanInstant& at) const {
    constexpr double difference_step = 1e-5;  // time step, whose square is the error
    const Eigen::Index n = model.size();
    const Eigen::Index m = model.constraints();
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(m);
    const auto residual = [&](double time) {
      model.move(at_rest(drive(time)), at.x, still, still);
      Eigen::VectorXd result(n + m);
      result << model.residual(multipliers), model.constraint_residuals().col(0);
      return result;
    };
    const Eigen::VectorXd unheld = residual(at.time).head(n);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + m, n + m);
    matrix.bottomLeftCorner(m, n) = model.jacobian();
    matrix.topRightCorner(n, m) = -matrix.bottomLeftCorner(m, n).transpose();
    if (m > 0) {
      multipliers = -matrix.topRightCorner(n, m).completeOrthogonalDecomposition().solve(unheld);
    }
    matrix.topLeftCorner(n, n) = model.stiffness(multipliers);
    const Eigen::VectorXd change =
        (residual(at.time + difference_step) - residual(at.time - difference_step)) /
        (2 * difference_step);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-9);
    return -solver.compute(matrix).solve(change).head(n);
  }

  /// Returns velocities at the points of SpanDynamics in the span's units: begins and ends of
  /// elements and the nodes between.
  [[nodiscard]] Eigen::MatrixX3d point_velocities(const StartingVelocities& velocities,
                                                  const SpanDynamics& model) const {
    const std::vector<Element> elements = elements_of(placed_.span);
    const Eigen::Index nodes = model.nodes().size() / std::ssize(elements);
    std::vector<double> arc_lengths;
    const auto add = [&](double s) {
      const double arc = placed_.start + (placed_.reversed ? -s : s) * length_;
      arc_lengths.push_back(std::clamp(arc, 0.0, length_));
    };
    for (std::size_t e = 0; e < elements.size(); ++e) {
      add(elements[e].begin);
      const Eigen::Index first = static_cast<Eigen::Index>(e) * nodes;
      for (Eigen::Index q = 0; q < nodes; ++q) add(model.nodes()[first + q]);
      add(elements[e].end());
    }
    return (time_ / length_) * (rotation_to_axes(begin_) * velocities(arc_lengths)).transpose();
  }

  [[nodiscard]] SpanFrame frame(SpanIntegrator& integrator, SpanDynamics& model,
                                const SpanInstant& at) const {
    SpanFrame result;
    const Eigen::VectorXd multipliers = integrator.consistent_accelerations(at);
    const std::vector<Reaction> reactions = model.reactions(multipliers);
    const double seconds = at.time * time_;
    const Eigen::Matrix3d to_space = rotation_to_axes(seconds).transpose();
    const double unit = force_ * length_;
    add(model.energies(), unit, result.energy);
    add(at.done, unit, result.energy);
    for (std::size_t k = 0; k < grips_.size(); ++k) {
      result.grips.emplace_back(grips_[k], Reaction{to_space * reactions[k].force * force_,
                                                    to_space * reactions[k].torque * unit});
    }
    for (const auto& [obstacle, force] : model.obstacle_forces()) {
      result.obstacles.emplace_back(obstacle, to_space * force * force_);
    }
    const double end =
        placed_.reversed ? placed_.start : placed_.start + placed_.span.length * length_;
    result.shape = {model.shape(at.x),
                    placed_.reversed,
                    placed_.start,
                    end,
                    to_space,
                    pose(placed_.anchor_grip, seconds).position,
                    {}};
    if (placed_.span.has_material_directors()) {
      result.shape.ahead = [ahead = placed_.ahead](double) { return ahead; };
    }
    return result;
  }

  void copy_statistics(const SpanIntegrator& integrator, SpanRun& run) const {
    run.steps = integrator.steps();
    run.smallest_step = integrator.smallest_step() * time_;
    run.error = integrator.error();
    run.depth = integrator.depth() * length_;
  }

  /// Prepares the initial state: satisfies the constraints, and sets initial velocities if they are
  /// given or the rod is in motion. @return the reason of a failure; empty on success
  [[nodiscard]] std::string prepare_initial_state(SpanIntegrator& integrator, SpanDynamics& model,
                                                  const DynamicsOptions& options,
                                                  SpanInstant& at) const {
    at.v = Eigen::VectorXd::Zero(model.size());
    std::string message = integrator.project(at);
    if (message.empty() && model.has_twist()) message = integrator.equilibrate_roll(at);
    if (!message.empty()) return message;
    if (options.velocities) {
      integrator.set_velocities(point_velocities(options.velocities, model), at);
      return message;
    }
    if (!options.in_motion) return message;
    at.v = equilibrium_rates(model, at);
    return integrator.project(at);
  }

  [[nodiscard]] static SolveStatus status_of(const std::string& problem, const Deadline& deadline) {
    if (problem.empty()) return SolveStatus::converged;
    return deadline.passed() ? SolveStatus::time_limit : SolveStatus::failed;
  }

  /// Simulates with one contact law; ends when the rod enters a rigid obstacle too deeply.
  [[nodiscard]] SpanRun run_with(const ContactLaw& contact, const SpanMotion& motion,
                                 const DynamicsOptions& options, const Deadline& deadline) const {
    SpanRun result;
    Equilibrium resting;
    resting.sample = motion.start;
    const TangentField field = field_of(resting, placed_, length_);
    const Eigen::Vector3d first = field(Eigen::VectorXd::Zero(1)).tangents.col(0);
    Span span = placed_.span;
    if (span.has_material_directors() && !span.planar && !span.start_direction) {
      span.principal_d1 = first_d1(motion.start);
    }
    SpanDynamics model(span, options.terms, first, inertia(motion.masses), contact);
    const StartShape begin = start_shape_at(field, model.nodes());
    const bool starts_out_of_plane =
        begin.tangents.row(2).cwiseAbs().maxCoeff() > motion_plane_rounding ||
        (options.velocities &&
         point_velocities(options.velocities, model).col(2).cwiseAbs().maxCoeff() >
             motion_plane_rounding);
    if (placed_.span.planar && starts_out_of_plane) {
      result.left_plane = true;
      return result;
    }
    bool left_plane = false;
    SpanIntegrator integrator(
        model,
        [&](double time) {
          SpanDrive driven = drive(time);
          left_plane = left_plane || (placed_.span.planar && leaves_plane(driven));
          return driven;
        },
        {options.tolerance, options.step / time_,
         rod_.material_damping > 0 || model.may_touch() || model.has_twist()});
    SpanInstant at;
    at.time = begin_ / time_;
    at.x = model.fit(begin);
    result.message = prepare_initial_state(integrator, model, options, at);
    const auto stopped = [&] { return !result.message.empty() || left_plane; };
    if (!stopped()) {
      result.frames.push_back(frame(integrator, model, at));
      if (model.depth() > contact.depth) result.message = "the rod begins within a rigid obstacle";
    }
    const auto is_too_deep = [&] { return integrator.depth() > contact.depth; };
    const auto expired = [&] { return deadline.passed() || left_plane || is_too_deep(); };
    const std::vector<double> breaks = span_breaks();
    auto next_break = std::upper_bound(breaks.begin(), breaks.end(), at.time);
    for (const double seconds : motion.times) {
      const double time = seconds / time_;
      const auto is_due = [&](double at_break) {
        return at_break <= time || SpanIntegrator::same_instant(at_break, time);
      };
      for (; next_break != breaks.end() && is_due(*next_break) && !stopped(); ++next_break) {
        result.message = integrator.advance(at, *next_break, expired);
        if (!stopped()) integrator.apply_impulse(at);
      }
      if (!stopped()) result.message = integrator.advance(at, time, expired);
      if (stopped()) break;
      result.frames.push_back(frame(integrator, model, at));
    }
    result.left_plane = left_plane;
    copy_statistics(integrator, result);
    if (is_too_deep() && !deadline.passed()) {
      result.message = "a rigid obstacle is struck too hard for the depth that contact may have";
    }
    result.status = status_of(result.message, deadline);
    return result;
  }

  const MovingRod& rod_;
  PlacedSpan placed_;
  std::vector<std::size_t> grips_;  // grips of the span, the anchor first
  double begin_;
  double length_, force_, time_, mass_;  // units
  std::vector<Eigen::Quaterniond> first_turns_;
};

}  // namespace

SpanRun run_span(const MovingRod& rod, const PlacedSpan& placed, const SpanMotion& motion,
                 const DynamicsOptions& options, const Deadline& deadline) {
  return MovingSpan(rod, placed, motion.begin).run(motion, options, deadline);
}

}  // namespace dlo::energy_model
