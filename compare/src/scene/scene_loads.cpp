#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/problem.hpp"
#include "scene/scene_problem.hpp"

// Loads on a scene's rod other than its weight.
namespace dlo::compare {
namespace {

bool has_couple(const PointLoad& load) { return !load.torque.isZero(0); }

}  // namespace

Eigen::Vector3d DistributedLoad::force_between(double begin, double end) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const energy_model::LineLoad& piece : line_loads(*this))
    sum += piece.force_between(begin, end);
  return sum;
}

double DistributedLoad::size() const {
  double sum = 0;
  for (const energy_model::LineLoad& piece : line_loads(*this)) {
    sum += (piece.at_begin.norm() + piece.at_end.norm()) / 2 * (piece.end - piece.begin);
  }
  return sum;
}

Eigen::Vector3d Scene::distributed_between(double begin, double end) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const DistributedLoad& load : distributed_loads) sum += load.force_between(begin, end);
  return sum;
}

double Scene::total_load_magnitude() const {
  double sum = 0;
  for (const PointLoad& load : loads) sum += load.force.norm() + load.torque.norm() / length;
  for (const DistributedLoad& load : distributed_loads) sum += load.size();
  return sum;
}

bool Scene::has_couples() const { return std::ranges::any_of(loads, has_couple); }

void Scene::require_potential(const char* model_name) const {
  if (drag && drag->largest() > 0) {
    throw InputError(fmt::format(
        "{}: medium.velocity: drag has no potential and is not supported by {} (allowed: dlo solve "
        "--model exact or force)",
        file, model_name));
  }
  const auto follower = std::ranges::find_if(loads, &PointLoad::follows);
  if (follower != loads.end()) {
    throw InputError(fmt::format(
        "{}: load.follows: the load at {:g} m rotates with the rod, has no potential and is not "
        "supported by {} (allowed: dlo solve --model exact)",
        file, follower->at, model_name));
  }
  if (!has_couples() || energy_model::has_potential(scene_problem(*this))) return;
  throw InputError(fmt::format(
      "{}: load.torque: out of a plane a couple that keeps its axis has no potential and is not "
      "supported by {} (allowed: dlo solve --model exact)",
      file, model_name));
}

void Scene::require_no_couples(const char* model_name) const {
  require_potential(model_name);
  const auto couple = std::ranges::find_if(loads, has_couple);
  if (couple == loads.end()) return;
  throw InputError(fmt::format(
      "{}: load.torque: the couple at {:g} m is not supported by {} (allowed: dlo solve "
      "--model energy or exact)",
      file, couple->at, model_name));
}

}  // namespace dlo::compare
