#include "dlo/compare/discretise.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dlo/compare/error.hpp"
#include "dlo/energy_model/planar.hpp"

namespace dlo::compare {
namespace {

/// The curvature that a straight rod's load would bend into the clamp: what a moment-matched c_b
/// should be right at when nobody says otherwise. No less than a tenth of what the load could do
/// across the rod, since a rod along its load bends into other shapes than the straight one.
double clamp_curvature(const Scene& scene) {
  const Gripper& grip = scene.grippers.front();
  const bool at_start = grip.at == 0;
  const Eigen::Vector3d direction = at_start ? *grip.direction : Eigen::Vector3d(-*grip.direction);
  Eigen::Vector3d moment =
      direction.cross(scene.weight_per_length()) * scene.length * scene.length / 2;
  for (const PointLoad& load : scene.loads) {
    moment += direction.cross(load.force) * std::abs(load.at - grip.at);
  }
  double most = scene.weight_per_length().norm() * scene.length * scene.length / 2;
  for (const PointLoad& load : scene.loads) most += load.force.norm() * std::abs(load.at - grip.at);
  return std::max(moment.norm(), most / 10) / scene.bending_stiffness();
}

double segment_length(const Scene& scene, const ForceModelSettings& settings) {
  const double segments = settings.points - 1;
  return settings.bookkeeping == Bookkeeping::paper ? scene.length / segments
                                                    : scene.length / (segments - 0.5);
}

void derive_bending(const Scene& scene, const ForceModelSettings& settings,
                    Discretisation& result) {
  if (settings.law == Law::hooke) {
    result.rod.bending = {force_model::BendingLaw::hooke, scene.bending_stiffness()};
    return;
  }
  Parameters& parameters = result.parameters;
  if (settings.c_b) {
    parameters.c_b = *settings.c_b;
  } else {
    parameters.design_curvature = settings.design_curvature.value_or(clamp_curvature(scene));
    const double alpha = parameters.design_curvature * parameters.segment_length;
    if (!(alpha > 0 && alpha < std::numbers::pi)) {
      throw InputError(
          fmt::format("{}: force_model.design_curvature = {:g} 1/m: with {} points a joint would "
                      "turn by {:g} rad "
                      "(allowed: > 0 and < pi; give design_curvature, c_b or other points)",
                      scene.file, parameters.design_curvature, settings.points, alpha));
    }
    parameters.c_b =
        paper_bending_stiffness(settings.bending_rule, scene.bending_stiffness(),
                                parameters.design_curvature, parameters.segment_length);
  }
  result.rod.bending = {force_model::BendingLaw::paper, parameters.c_b};
}

/// Weights and loads on the points. Loads between two points go to both by the lever rule.
void distribute_forces(const Scene& scene, const ForceModelSettings& settings,
                       Eigen::Index held_begin, Discretisation& result) {
  const Eigen::Index N = settings.points;
  const double L = result.parameters.segment_length;
  result.rod.loads.setZero(3, N);
  const Eigen::Index free_end = held_begin == 0 ? N - 1 : 0;
  for (Eigen::Index i = 0; i < N; ++i) {
    const bool inside_gripper = i == (held_begin == 0 ? 0 : N - 1);
    double share = 0;
    if (settings.bookkeeping == Bookkeeping::paper) {
      share = scene.length / static_cast<double>(N);
    } else if (!inside_gripper) {
      share = i == free_end ? L / 2 : L;
    }
    result.rod.loads.col(i) = share * scene.weight_per_length();
    if (settings.bookkeeping == Bookkeeping::paper && settings.point_weight) {
      result.rod.loads.col(i) = *settings.point_weight * scene.gravity.normalized();
    }
  }
  result.weights = result.rod.loads;
  result.parameters.point_weight = result.rod.loads.col(N / 2).norm();
  for (const PointLoad& load : scene.loads) {
    const double position = (load.at - result.arc_length.front()) / L;
    const auto left =
        std::clamp(static_cast<Eigen::Index>(std::floor(position)), Eigen::Index{0}, N - 2);
    const double right_share = std::clamp(position - static_cast<double>(left), 0.0, 1.0);
    result.rod.loads.col(left) += (1 - right_share) * load.force;
    result.rod.loads.col(left + 1) += right_share * load.force;
  }
}

const Gripper& single_end_clamp(const Scene& scene) {
  const auto refuse = [&](const Gripper& gripper, const std::string& what) {
    throw InputError(fmt::format(
        "{}: {} (allowed for the models force and chain: one clamp at = 0 or at = {} m)",
        gripper.where.empty() ? scene.file : gripper.where, what, scene.length));
  };
  const Gripper& first = scene.grippers.front();
  if (scene.grippers.size() > 1) {
    refuse(scene.grippers[1], fmt::format("gripper: {} are given", scene.grippers.size()));
  }
  if (!first.direction) refuse(first, "gripper.hold = \"pin\"");
  if (first.at != 0 && first.at != scene.length) {
    refuse(first, fmt::format("gripper.at = {} m", first.at));
  }
  return first;
}

}  // namespace

double paper_bending_stiffness(BendingRule rule, double bending_stiffness, double curvature,
                               double segment_length) {
  const double alpha = curvature * segment_length;
  if (!(bending_stiffness > 0) || !(alpha > 0 && alpha < std::numbers::pi)) {
    throw std::invalid_argument(
        fmt::format("paper_bending_stiffness: EI = {}, L k = {}, must be > 0 and in (0, pi)",
                    bending_stiffness, alpha));
  }
  const double half = std::sin(alpha / 2);
  const double formula_21 =
      bending_stiffness * curvature * curvature / (2 * half * half * half);  // (21)
  return rule == BendingRule::formula_21 ? formula_21 : formula_21 / alpha;
}

Discretisation discretise(const Scene& scene, const ForceModelSettings& settings) {
  const Gripper& grip = single_end_clamp(scene);
  const Eigen::Index N = settings.points;
  Discretisation result;
  const double L = segment_length(scene, settings);
  result.length = scene.length;
  result.parameters.segment_length = L;
  result.parameters.c_c = settings.c_c.value_or(scene.axial_stiffness());
  result.rod.rest_lengths = Eigen::VectorXd::Constant(N - 1, L);
  result.rod.c_c = result.parameters.c_c;
  derive_bending(scene, settings, result);

  const bool at_start = grip.at == 0;
  const Eigen::Index held_begin = at_start ? 0 : N - 2;
  const double inside = settings.bookkeeping == Bookkeeping::paper ? 0 : L / 2;
  const double first = at_start ? -inside : 0;
  for (Eigen::Index i = 0; i < N; ++i) {
    result.arc_length.push_back(first + L * static_cast<double>(i));
  }
  // The free end is the rod's end to the last digit, not to rounding.
  (at_start ? result.arc_length.back() : result.arc_length.front()) = at_start ? scene.length : 0;
  result.straight.resize(3, N);
  for (Eigen::Index i = 0; i < N; ++i) {
    result.straight.col(i) =
        grip.position +
        (result.arc_length[static_cast<std::size_t>(i)] - grip.at) * *grip.direction;
  }
  distribute_forces(scene, settings, held_begin, result);

  force_model::Grip hold;
  hold.first_point = held_begin;
  hold.targets =
      force_model::grip_targets(grip.position, *grip.direction, L, at_start ? inside : L - inside);
  hold.reference = grip.position;
  result.rod.grips = {hold};
  for (const Obstacle& obstacle : scene.obstacles) {
    // A rigid wall as stiff as the rod's own segments: stiffer ones would only slow the steps down.
    const double stiffness =
        std::isfinite(obstacle.stiffness) ? obstacle.stiffness * L : result.parameters.c_c / L;
    result.rod.walls.push_back({obstacle.point, obstacle.normal, stiffness});
  }
  return result;
}

Shape Discretisation::shape(const Eigen::Matrix3Xd& points) const {
  const bool at_start = rod.grips.front().first_point == 0;
  const Eigen::Index inside = at_start ? 0 : points.cols() - 1;
  Shape result;
  result.arc_length = arc_length;
  result.points = points;
  result.arc_length[static_cast<std::size_t>(inside)] = at_start ? 0 : length;
  result.points.col(inside) = rod.grips.front().reference;
  return result;
}

ChainScene chain_scene(const Scene& scene, const Discretisation& discretisation,
                       const ForceModelSettings& settings) {
  const Gripper& grip = single_end_clamp(scene);
  if (!scene.obstacles.empty()) {
    throw InputError(
        fmt::format("{}: obstacle: the chain model knows no obstacles (allowed: models "
                    "force and energy)",
                    scene.file));
  }
  const bool reversed = grip.at != 0;
  const Eigen::Index N = settings.points;
  std::vector<Eigen::Vector3d> forces = {scene.weight_per_length() * scene.length};
  for (const PointLoad& load : scene.loads) forces.push_back(load.force);
  const std::optional<energy_model::Plane> plane = energy_model::find_plane(
      grip.position, reversed ? Eigen::Vector3d(-*grip.direction) : *grip.direction, forces);
  if (!plane) {
    throw InputError(
        fmt::format("{}: gripper.direction, gravity and loads do not lie in one plane "
                    "(allowed for the chain model: planar scenes)",
                    scene.file));
  }
  ChainScene result;
  result.origin = plane->origin;
  result.x = plane->x;
  result.y = plane->y;
  energy_model::ChainProblem& problem = result.problem;
  problem.segment_lengths = discretisation.rod.rest_lengths;
  problem.law =
      settings.law == Law::paper ? energy_model::JointLaw::paper : energy_model::JointLaw::hooke;
  problem.stiffness = discretisation.rod.bending.stiffness;
  problem.node_forces.resize(2, N);
  for (Eigen::Index i = 0; i < N; ++i) {
    // The chain starts in the gripper, at whichever end of the rod that is.
    const Eigen::Index from = reversed ? N - 1 - i : i;
    problem.node_forces.col(i) = plane->coordinates(discretisation.rod.loads.col(from));
  }
  const Eigen::Vector3d first = discretisation.straight.col(reversed ? N - 1 : 0);
  problem.start = plane->coordinates(first - plane->origin);
  return result;
}

Eigen::Matrix3Xd ChainScene::to_space(const Eigen::Matrix2Xd& points) const {
  return (x * points.row(0) + y * points.row(1)).colwise() + origin;
}

energy_model::Problem energy_problem(const Scene& scene) {
  energy_model::Problem problem;
  problem.length = scene.length;
  problem.bending_stiffness = scene.bending_stiffness();
  problem.weight_per_length = scene.weight_per_length();
  for (const Gripper& grip : scene.grippers) {
    problem.grips.push_back({grip.at, grip.position, grip.direction});
  }
  for (const PointLoad& load : scene.loads) problem.loads.push_back({load.at, load.force});
  for (const Obstacle& obstacle : scene.obstacles) {
    problem.walls.push_back({obstacle.point, obstacle.normal, obstacle.stiffness});
  }
  return problem;
}

force_model::StepOptions step_options(const ForceModelSettings& settings,
                                      const Discretisation& discretisation) {
  constexpr force_model::Stepper steppers[] = {
      force_model::Stepper::basic, force_model::Stepper::limited, force_model::Stepper::relative,
      force_model::Stepper::dynamic, force_model::Stepper::automatic};
  force_model::StepOptions options;
  options.policy = force_model::policy(steppers[static_cast<std::size_t>(settings.stepper)]);
  if (settings.stepper == StepperName::automatic) return options;
  // The paper's constants in Table 1's proportions: c_F = 0.86 L/(2 c_c), l_s = 0.6 L.
  const Parameters& parameters = discretisation.parameters;
  options.c_F = settings.c_F.value_or(0.86 * parameters.segment_length / (2 * parameters.c_c));
  options.l_s = settings.l_s.value_or(0.6 * parameters.segment_length);
  options.c_h = settings.c_h.value_or(0.9);
  return options;
}

}  // namespace dlo::compare
