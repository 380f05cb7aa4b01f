#include "paper/moving.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dlo/compare/paper_joint.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/force_model/simulation.hpp"
#include "paper/printed_tables.hpp"

namespace dlo::compare {
namespace {

constexpr double time_step = 28.0 / nominal_moving_steps;
/// Interval between compared frames. If the gripper starts or stops abruptly, the force on a rod is
/// unbounded, so no frame is at the beginning or the end of the movement.
constexpr int frame_stride = 50;
constexpr int first_seen_frame = static_cast<int>(movement_begins * 1000) + frame_stride / 2;

/// Returns the gripper's pose. At the beginning and the end of the movement its rates are those
/// just after.
/// @param time  [s]
MovingPose moving_pose(const MovingExperiment& experiment, const MovingAssumptions& choices,
                       double time) {
  constexpr double movement_duration = movement_ends - movement_begins;
  const double share = std::clamp((time - movement_begins) / movement_duration, 0.0, 1.0);
  const double rate = time >= movement_begins && time < movement_ends ? 1 / movement_duration : 0;
  MovingPose result;
  result.angle = experiment.horizontal ? 0 : -std::numbers::pi / 2;
  switch (experiment.movement) {
    case Movement::rotation:
      result.angle += share * choices.angle;
      result.angle_rate = rate * choices.angle;
      break;
    case Movement::uniform:
      result.position.x() = share * choices.distance;
      result.velocity.x() = rate * choices.distance;
      break;
    case Movement::accelerated:
      result.position.x() = share * share * choices.distance;
      result.velocity.x() = 2 * share * rate * choices.distance;
      result.acceleration.x() = 2 * rate * rate * choices.distance;
      break;
  }
  return result;
}

energy_model::GripPose clamp_pose(const MovingExperiment& experiment,
                                  const MovingAssumptions& choices, double time) {
  const MovingPose first = moving_pose(experiment, choices, 0);
  const MovingPose now = moving_pose(experiment, choices, time);
  const Eigen::Vector3d along = now.direction();
  const Eigen::Vector3d across(-along.y(), along.x(), 0);
  const double lead = table_1().segment() / 2;  // distance of the clamp from the third point [m]
  energy_model::GripPose pose;
  pose.position = now.position + lead * along;
  pose.velocity = now.velocity + lead * now.angle_rate * across;
  pose.acceleration = now.acceleration - lead * now.angle_rate * now.angle_rate * along;
  pose.turn = Eigen::AngleAxisd(now.angle - first.angle, Eigen::Vector3d::UnitZ());
  pose.angular_velocity = now.angle_rate * Eigen::Vector3d::UnitZ();
  return pose;
}

energy_model::MovingRod reference_rod(const MovingExperiment& experiment,
                                      const MovingAssumptions& choices) {
  const Table1& table = table_1();
  energy_model::MovingRod rod;
  rod.problem.length = table.length;
  rod.problem.bending_stiffness = reference_bending_stiffness();
  rod.problem.weight_per_length = {0, -moving_weight() / table.length, 0};
  const double at = (gripped_point + 0.5) * table.segment();
  const energy_model::GripPose start = clamp_pose(experiment, choices, 0);
  rod.problem.grips = {{.at = at,
                        .position = start.position,
                        .direction = moving_pose(experiment, choices, 0).direction()}};
  rod.inertia.mass_per_length = table.mass / table.length;
  rod.motions = {[=](double time) { return clamp_pose(experiment, choices, time); }};
  rod.breaks = {movement_begins, movement_ends};
  // First mode of the longer part, a cantilever: zeta = tau omega / 2.
  constexpr double first_root = 1.8751040687119612;
  const double omega = std::pow(first_root / (table.length - at), 2) *
                       std::sqrt(rod.problem.bending_stiffness / rod.inertia.mass_per_length);
  rod.material_damping = 2 * reference_damping_ratio / omega;
  return rod;
}

constexpr double steps_per_frame = static_cast<double>(nominal_moving_steps) / moving_frames;

Eigen::Matrix3Xd targets(const MovingPose& pose) {
  return force_model::grip_targets(pose.position, pose.direction(), table_1().segment(), 0);
}

force_model::Rod moving_rod(const MovingPose& start, const MovingAssumptions& choices) {
  const Table1& table = table_1();
  force_model::Rod rod;
  rod.rest_lengths = Eigen::VectorXd::Constant(table.points - 1, table.segment());
  rod.c_c = table.c_c;
  rod.bending = {force_model::BendingLaw::paper, table.c_b};
  rod.loads.setZero(3, table.points);
  rod.loads.row(1).setConstant(-table.point_weight);
  force_model::Grip grip;
  grip.first_point = gripped_point;
  grip.hold = force_model::GripHold::spring;
  grip.stiffness = choices.grip_force / (0.05 * table.segment());
  grip.targets = targets(start);
  grip.reference = start.position;
  rod.grips = {grip};
  return rod;
}

Eigen::Matrix3Xd start_points(const MovingPose& start, const MovingAssumptions& choices) {
  const Table1& table = table_1();
  Eigen::Matrix3Xd points(3, table.points);
  for (Eigen::Index i = 0; i < table.points; ++i) {
    const double segments = static_cast<double>(i - gripped_point) - choices.start_offset;
    points.col(i) = start.position + segments * table.segment() * start.direction();
  }
  return points;
}

/// Adds the gripper's forces on the rod to the run's averages. @return sum of the spring forces [N]
Eigen::Vector3d add_force(const force_model::Simulation& simulation, MovingRun& run) {
  const force_model::Grip& grip = simulation.rod().grips.front();
  Eigen::Vector3d net = Eigen::Vector3d::Zero();
  run.final_force = 0;
  for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
    const Eigen::Vector3d force = force_model::spring_force(
        grip.stiffness, grip.targets.col(k), simulation.points().col(grip.first_point + k));
    net += force;
    run.final_force += force.norm();
  }
  run.final_net_force = net.norm();
  run.average_force += run.final_force;
  run.average_net_force += run.final_net_force;
  return net;
}

}  // namespace

PointParameters point_parameters(double c_F, double c_h) {
  PointParameters result;
  result.mass = time_step * time_step / c_F;
  result.damping_rate = (1 - c_h) / time_step;
  result.drag = result.mass * result.damping_rate;
  return result;
}

double reference_bending_stiffness() {
  constexpr double design_angle = 2.5 * std::numbers::pi / 180;  // Table 1
  return equivalent_bending_stiffness(table_1().c_b, table_1().segment(), design_angle);
}

MovingReference moving_reference(const MovingExperiment& experiment,
                                 const MovingAssumptions& choices) {
  MovingReference result;
  const energy_model::MovingRod rod = reference_rod(experiment, choices);
  const energy_model::Equilibrium rest = energy_model::solve_energy(rod.problem);
  if (!energy_model::succeeded(rest.status)) {
    result.message = rest.message;
    return result;
  }
  std::vector<double> times;
  for (int frame = first_seen_frame; frame < moving_frames; frame += frame_stride) {
    result.frames.push_back(frame);
    times.push_back(frame / 1000.0);
  }
  const energy_model::Dynamics moved =
      energy_model::simulate(rod, rest.sample, times, {.terms = 8, .tolerance = 1e-5});
  result.converged = energy_model::succeeded(moved.status);
  result.message = moved.message;
  result.energy_error = moved.energy_error;
  const std::vector<double> at =
      energy_model::equal_arc_lengths(table_1().length, table_1().points);
  for (const energy_model::MovingFrame& frame : moved.frames) {
    result.points.push_back(frame.sample(at).points);
    result.forces.push_back(frame.grips.front().force);
  }
  return result;
}

MovingError moving_error(const MovingExperiment& experiment, const MovingAssumptions& choices,
                         const MovingReference& reference) {
  MovingError error;
  double shapes = 0;
  double forces = 0;
  std::size_t compared = 0;
  const auto observe = [&](int frame, const Eigen::Matrix3Xd& points,
                           const Eigen::Vector3d& force) {
    if (compared == reference.points.size() || frame != reference.frames[compared]) return;
    const Eigen::Matrix3Xd deviation = (points - reference.points[compared]) / table_1().length;
    shapes += deviation.squaredNorm() / static_cast<double>(points.cols());
    error.shape_max = std::max(error.shape_max, deviation.colwise().norm().maxCoeff());
    const double difference = (force - reference.forces[compared]).norm();
    forces += difference * difference;
    error.force_max = std::max(error.force_max, difference);
    ++compared;
  };
  const MovingRun run = run_moving_experiment(experiment, choices, observe);
  if (run.status != MovingStatus::finished || compared == 0 || !reference.converged) {
    const double none = std::numeric_limits<double>::infinity();
    return {none, none, none, none};
  }
  error.shape_rms = std::sqrt(shapes / static_cast<double>(compared));
  error.force_rms = std::sqrt(forces / static_cast<double>(compared));
  return error;
}

Eigen::Vector3d MovingPose::direction() const { return {std::cos(angle), std::sin(angle), 0}; }

double moving_weight() { return static_cast<double>(table_1().points) * table_1().point_weight; }

force_model::StepOptions moving_step_options(MovingVariant variant,
                                             const MovingAssumptions& choices) {
  using force_model::Stepper;
  force_model::StepOptions options;
  options.policy = policy(variant == MovingVariant::basic       ? Stepper::basic
                          : variant == MovingVariant::limited   ? Stepper::limited
                          : variant == MovingVariant::relative  ? Stepper::relative
                          : variant == MovingVariant::automatic ? Stepper::automatic
                                                                : Stepper::dynamic);
  if (variant == MovingVariant::dynamic_absolute) {
    options.policy.limit = force_model::StepLimit::absolute;
  }
  options.c_F = table_1().c_F * choices.length_unit;
  options.l_s = table_1().l_s * choices.length_unit;
  options.c_h = choices.c_h;
  options.c_s_change = choices.c_s_change;
  return options;
}

MovingRun run_moving_experiment(const MovingExperiment& experiment,
                                const MovingAssumptions& choices, const MovingObserver& observe) {
  constexpr long most_steps = nominal_moving_steps * 5 / 4;  // the largest printed number is 128770
  const MovingPose start = moving_pose(experiment, choices, 0);
  force_model::Simulation simulation(moving_rod(start, choices), start_points(start, choices),
                                     moving_step_options(experiment.variant, choices));
  MovingRun run;
  run.status = MovingStatus::finished;
  int done = 0;
  for (; done < moving_frames && run.status == MovingStatus::finished; ++done) {
    const MovingPose now = moving_pose(experiment, choices, done / 1000.0);
    simulation.move_grip(0, targets(now), now.position);
    const force_model::StepResult last =
        simulation.advance(steps_per_frame, most_steps - simulation.steps());
    if (last.status == force_model::StepStatus::diverged) run.status = MovingStatus::diverged;
    if (simulation.steps() >= most_steps) run.status = MovingStatus::too_many_steps;
    const Eigen::Vector3d force = add_force(simulation, run);
    if (observe) observe(done, simulation.points(), force);
  }
  run.average_force /= done;
  run.average_net_force /= done;
  run.c_F = simulation.options().c_F;
  run.c_h = simulation.options().policy.momentum ? simulation.options().c_h : 0;
  run.steps = simulation.steps();
  run.damped_steps = simulation.damped_steps();
  run.limited_steps = simulation.limited_steps();
  return run;
}

}  // namespace dlo::compare
