#include "paper/moving_reference.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dlo/compare/paper_joint.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"

namespace dlo::compare {
namespace {

constexpr double time_step = 28.0 / nominal_moving_steps;
/// Interval between compared frames. If the gripper starts or stops abruptly, the force on a rod is
/// unbounded, so no frame is at the beginning or the end of the movement.
constexpr int frame_stride = 50;
constexpr int first_seen_frame = static_cast<int>(movement_begins * 1000) + frame_stride / 2;

/// Distance of the clamp from the third point, half a segment along the rod [m].
double clamp_lead() { return table_1().segment() / 2; }

energy_model::GripPose clamp_pose(const MovingExperiment& experiment, const MovingChoices& choices,
                                  double time) {
  const MovingPose first = moving_pose(experiment, choices, 0);
  const MovingPose now = moving_pose(experiment, choices, time);
  const Eigen::Vector3d along = now.direction();
  const Eigen::Vector3d across(-along.y(), along.x(), 0);
  const double lead = clamp_lead();
  energy_model::GripPose pose;
  pose.position = now.position + lead * along;
  pose.velocity = now.velocity + lead * now.angle_rate * across;
  pose.acceleration = now.acceleration - lead * now.angle_rate * now.angle_rate * along;
  pose.turn = Eigen::AngleAxisd(now.angle - first.angle, Eigen::Vector3d::UnitZ());
  pose.angular_velocity = now.angle_rate * Eigen::Vector3d::UnitZ();
  return pose;
}

energy_model::MovingRod reference_rod(const MovingExperiment& experiment,
                                      const MovingChoices& choices) {
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

}  // namespace

PointReading point_reading(double c_F, double c_h) {
  PointReading result;
  result.mass = time_step * time_step / c_F;
  result.damping_rate = (1 - c_h) / time_step;
  result.drag = result.mass * result.damping_rate;
  return result;
}

double reference_bending_stiffness() {
  constexpr double design_angle = 2.5 * std::numbers::pi / 180;  // Table 1
  return equivalent_bending_stiffness(table_1().c_b, table_1().segment(), design_angle);
}

MovingReference moving_reference(const MovingExperiment& experiment, const MovingChoices& choices) {
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

MovingError moving_error(const MovingExperiment& experiment, const MovingChoices& choices,
                         const MovingReference& reference) {
  MovingError error;
  double shapes = 0;
  double forces = 0;
  std::size_t seen = 0;
  const auto observe = [&](int frame, const Eigen::Matrix3Xd& points,
                           const Eigen::Vector3d& force) {
    if (seen == reference.points.size() || frame != reference.frames[seen]) return;
    const Eigen::Matrix3Xd apart = (points - reference.points[seen]) / table_1().length;
    shapes += apart.squaredNorm() / static_cast<double>(points.cols());
    error.shape_max = std::max(error.shape_max, apart.colwise().norm().maxCoeff());
    const double difference = (force - reference.forces[seen]).norm();
    forces += difference * difference;
    error.force_max = std::max(error.force_max, difference);
    ++seen;
  };
  const MovingRun run = run_moving_experiment(experiment, choices, observe);
  if (run.status != MovingStatus::finished || seen == 0 || !reference.converged) {
    const double none = std::numeric_limits<double>::infinity();
    return {none, none, none, none};
  }
  error.shape_rms = std::sqrt(shapes / static_cast<double>(seen));
  error.force_rms = std::sqrt(forces / static_cast<double>(seen));
  return error;
}

}  // namespace dlo::compare
