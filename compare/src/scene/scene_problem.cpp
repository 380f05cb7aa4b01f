#include "scene/scene_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dlo::compare {

std::vector<energy_model::LineLoad> line_loads(const DistributedLoad& load) {
  const std::vector<Eigen::Vector3d>& forces = load.force_per_length;
  if (forces.size() == 1) return {{load.from, load.to, forces[0], forces[0]}};
  std::vector<energy_model::LineLoad> pieces;
  const double width = (load.to - load.from) / static_cast<double>(forces.size() - 1);
  double begin = load.from;
  for (std::size_t i = 1; i < forces.size(); ++i) {
    const double end =
        i + 1 == forces.size() ? load.to : load.from + static_cast<double>(i) * width;
    pieces.push_back({begin, end, forces[i - 1], forces[i]});
    begin = end;
  }
  return pieces;
}

energy_model::Problem scene_problem(const Scene& scene) {
  energy_model::Problem problem;
  problem.length = scene.length;
  problem.bending_stiffness = scene.bending_stiffness();
  problem.bending_stiffness_2 = scene.bending_stiffness_2();
  problem.torsional_stiffness = scene.twisting_stiffness();
  if (scene.stretch == Stretch::counted) problem.axial_stiffness = scene.axial_stiffness();
  problem.weight_per_length = scene.mass_per_length() * scene.gravity;
  for (const Section& section : scene.sections) {
    // The ratio is computed first, so that GJ is unchanged if EI is.
    const double stiffness_ratio =
        section.mean_bending_stiffness() / scene.mean_bending_stiffness();
    problem.sections.push_back({.begin = section.from,
                                .end = section.to,
                                .bending_stiffness = section.bending_stiffness,
                                .torsional_stiffness = section.torsional_stiffness.value_or(
                                    stiffness_ratio * problem.torsional_stiffness),
                                .weight_per_length = section.mass_per_length * scene.gravity,
                                .bending_stiffness_2 = section.bending_stiffness_2,
                                .natural_curvature = section.natural_curvature,
                                .natural_twist = section.natural_twist});
  }
  if (scene.naturally_bent()) problem.natural_strains = {scene.natural_strain};
  for (const Eigen::Vector2d& strain : scene.natural_variation) {
    problem.natural_strains.emplace_back(strain.x(), strain.y(), 0);
  }
  for (const Gripper& grip : scene.grippers) {
    energy_model::Grip result{grip.at, grip.position, grip.direction, std::nullopt};
    if (grip.frame) result.frame = {grip.frame->d1, grip.frame->roll};
    problem.grips.push_back(std::move(result));
  }
  for (const PointLoad& load : scene.loads) {
    problem.loads.push_back({load.at, load.force, load.torque, load.follows});
  }
  for (const DistributedLoad& load : scene.distributed_loads) {
    for (const energy_model::LineLoad& piece : line_loads(load)) {
      problem.line_loads.push_back(piece);
    }
  }
  if (scene.drag && scene.drag->largest() > 0) problem.drag = scene.drag;
  for (const std::size_t i : obstacles_in_reach(scene)) {
    const Obstacle& obstacle = scene.obstacles[i];
    problem.obstacles.push_back({obstacle.body, obstacle.stiffness});
  }
  return problem;
}

void scale_length(Scene& scene, double factor) {
  scene.length *= factor;
  for (Gripper& gripper : scene.grippers) gripper.at *= factor;
  for (PointLoad& load : scene.loads) load.at *= factor;
  for (DistributedLoad& load : scene.distributed_loads) {
    load.from *= factor;
    load.to *= factor;
  }
  for (Section& section : scene.sections) {
    section.from *= factor;
    section.to *= factor;
  }
}

double rectangle_torsion_constant(double width, double thickness) {
  using std::numbers::pi;
  const double a = std::max(width, thickness);
  const double b = std::min(width, thickness);
  // tanh x = 1 - 2 / (exp(2x) + 1). The ones sum to 31/32 zeta(5); the remaining terms decrease
  // with exp(-n pi a / b) and are below 1e-17 of the sum beyond n = 11.
  double sum = 31.0 / 32 * std::riemann_zeta(5.0);
  for (int n = 1; n <= 11; n += 2) sum -= 2 / (std::exp(n * pi * a / b) + 1) / std::pow(n, 5);
  return a * b * b * b / 3 * (1 - 192 * b / (std::pow(pi, 5) * a) * sum);
}

}  // namespace dlo::compare
