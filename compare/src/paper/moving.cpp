#include "paper/moving.hpp"

#include <algorithm>
#include <cmath>

#include "dlo/force_model/simulation.hpp"
#include "paper/printed_tables.hpp"

namespace dlo::compare {
namespace {

constexpr double steps_per_frame = static_cast<double>(nominal_moving_steps) / moving_frames;

Eigen::Matrix3Xd targets(const MovingPose& pose) {
  return force_model::grip_targets(pose.position, pose.direction(), table_1().segment(), 0);
}

force_model::Rod moving_rod(const MovingPose& start, const MovingChoices& choices) {
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

Eigen::Matrix3Xd start_points(const MovingPose& start, const MovingChoices& choices) {
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

Eigen::Vector3d MovingPose::direction() const { return {std::cos(angle), std::sin(angle), 0}; }

double moving_weight() { return static_cast<double>(table_1().points) * table_1().point_weight; }

MovingPose moving_pose(const MovingExperiment& experiment, const MovingChoices& choices,
                       double time) {
  constexpr double takes = movement_ends - movement_begins;
  const double share = std::clamp((time - movement_begins) / takes, 0.0, 1.0);
  const double rate = time >= movement_begins && time < movement_ends ? 1 / takes : 0;
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

force_model::StepOptions moving_step_options(MovingVariant variant, const MovingChoices& choices) {
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

MovingRun run_moving_experiment(const MovingExperiment& experiment, const MovingChoices& choices,
                                const MovingObserver& observe) {
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
