#include "fit/shape_misfit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dlo/compare/shape_check.hpp"

namespace dlo::compare {
namespace {

/// Largest number of searches per scene with several grippers; each may take as long as all solves
/// that follow an equilibrium.
constexpr int most_searches = 4;
/// Number of equilibria kept as starts, per scene; a scan over the modulus has some thirty.
constexpr std::size_t most_kept = 64;

/// Returns how deep a shape enters the rigid obstacles of a scene [m].
double depth_in_obstacles(const Scene& scene, const energy_model::Equilibrium& equilibrium) {
  constexpr int samples = 401;
  const Eigen::Matrix3Xd points =
      equilibrium.sample(equal_arc_lengths(scene.length, samples)).points;
  double depth = 0;
  for (const Obstacle& obstacle : scene.obstacles) {
    if (std::isfinite(obstacle.stiffness)) continue;
    depth = std::max(depth, -obstacle.body.clearances(points).minCoeff());
  }
  return depth;
}

/// Returns a scene without names, positions in files, and force model, for comparison.
Scene only_the_rod(Scene scene) {
  scene.name.clear();
  scene.file.clear();
  scene.material.name.clear();
  scene.material.source.clear();
  scene.force_model = {};
  for (Gripper& gripper : scene.grippers) gripper.where.clear();
  return scene;
}

}  // namespace

ShapeMisfit::ShapeMisfit(const std::vector<Scene>& scenes, MeasuredShapes& measured)
    : scenes_(scenes), measured_(measured), searches_(scenes.size(), 0) {
  for (const Scene& scene : scenes) {
    const auto like_this = [rod = only_the_rod(scene)](const Scene& other) {
      return only_the_rod(other) == rod;
    };
    const auto first = std::find_if(scenes.begin(), scenes.end(), like_this);
    first_like_.push_back(static_cast<std::size_t>(first - scenes.begin()));
    follows_.push_back(scene.grippers.size() > 1);
  }
}

std::shared_ptr<ShapeMisfit::Solved> ShapeMisfit::solve(std::size_t i,
                                                        const MaterialPoint& material,
                                                        const energy_model::Equilibrium* start) {
  const Scene scene = of_material(scenes_[i], material);
  auto result = std::make_shared<Solved>();
  result->material = material;
  result->scene = i;
  result->equilibrium = measured_.solve(i, scene, start);
  if (result->equilibrium.status == energy_model::SolveStatus::not_verified) {
    result->penetration = depth_in_obstacles(scene, result->equilibrium);
  }
  return result;
}

const ShapeMisfit::Solved* ShapeMisfit::nearest(std::size_t i,
                                                const MaterialPoint& material) const {
  const Solved* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const std::shared_ptr<const Solved>& entry : kept_) {
    const double distance = std::abs(entry->material.log_modulus - material.log_modulus) +
                            std::abs(entry->material.log_density - material.log_density);
    if (entry->scene != i || !(distance < least)) continue;
    least = distance;
    best = entry.get();
  }
  return best;
}

std::shared_ptr<const ShapeMisfit::Solved> ShapeMisfit::solved(std::size_t i,
                                                               const MaterialPoint& material) {
  const bool follows = follows_[i];
  if (!follows) {
    // Another shape of the same scene needs the same equilibria.
    const auto shared = std::find_if(shared_.begin(), shared_.end(), [&](const auto& entry) {
      return entry->scene == first_like_[i] && entry->material == material;
    });
    if (shared != shared_.end()) return *shared;
  }
  const Solved* start = follows ? nearest(i, material) : nullptr;
  if (start != nullptr && start->material == material) {
    for (const std::shared_ptr<const Solved>& entry : kept_) {
      if (entry.get() == start) return entry;
    }
  }
  const auto has_shape = [](const Solved& shape) {
    return energy_model::succeeded(shape.equilibrium.status) ||
           (shape.equilibrium.status == energy_model::SolveStatus::not_verified &&
            shape.penetration > 0);
  };
  std::shared_ptr<Solved> result;
  if (start != nullptr) result = solve(i, material, &start->equilibrium);
  if (!result || !has_shape(*result)) {
    if (follows && searches_[i]++ >= most_searches) return nullptr;
    result = solve(i, material, nullptr);
  }
  if (!has_shape(*result)) return nullptr;
  if (follows) {
    kept_.push_back(result);
    if (kept_.size() > most_kept * scenes_.size()) kept_.pop_front();
  } else {
    result->scene = first_like_[i];
    shared_.push_back(result);
    if (shared_.size() > most_kept * scenes_.size()) shared_.pop_front();
  }
  return result;
}

double ShapeMisfit::operator()(const MaterialPoint& material) {
  if (const auto known = values_.find(material); known != values_.end()) return known->second;
  double sum = 0;
  const std::size_t unverified_before = unverified_.size();
  for (std::size_t i = 0; i < scenes_.size() && std::isfinite(sum); ++i) {
    const std::shared_ptr<const Solved> shape = solved(i, material);
    if (!shape) {
      sum = std::numeric_limits<double>::infinity();
      break;
    }
    sum += measured_.squares(i, shape->equilibrium);
    if (shape->penetration > 0) {
      unverified_.emplace_back(
          Unverified{material, i, shape->penetration, shape->equilibrium.message}, 0);
    }
  }
  for (std::size_t k = unverified_before; k < unverified_.size(); ++k) unverified_[k].second = sum;
  values_[material] = sum;
  return sum;
}

std::shared_ptr<const ShapeMisfit::Solved> ShapeMisfit::nearer(
    std::size_t i, const MaterialPoint& material, const std::shared_ptr<const Solved>& now) {
  std::vector<std::shared_ptr<Solved>> others;
  if (scenes_[i].grippers.size() > 1 && searches_[i]++ < most_searches) {
    others.push_back(solve(i, material, nullptr));
  }
  if (now) {
    others.push_back(std::make_shared<Solved>(*now));
    Solved& near = *others.back();
    near.scene = i;
    near.equilibrium = measured_.solve_near(i, of_material(scenes_[i], material), now->equilibrium);
  }
  double least =
      now ? measured_.squares(i, now->equilibrium) : std::numeric_limits<double>::infinity();
  std::shared_ptr<const Solved> result;
  for (const std::shared_ptr<Solved>& other : others) {
    if (!energy_model::succeeded(other->equilibrium.status)) continue;
    const double squares = measured_.squares(i, other->equilibrium);
    if (!(squares < 0.99 * least - std::pow(1e-6 * scenes_[i].length, 2))) continue;
    least = squares;
    result = other;
  }
  return result;
}

bool ShapeMisfit::search_at(const MaterialPoint& material) {
  bool better = false;
  std::vector<std::shared_ptr<const Solved>> next;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const std::shared_ptr<const Solved> now = solved(i, material);
    const std::shared_ptr<const Solved> other = nearer(i, material, now);
    if (other) {
      better = follows_[i] = true;
      next.push_back(other);
    } else if (now && follows_[i]) {
      next.push_back(now);
    }
  }
  if (!better) return false;
  kept_.assign(next.begin(), next.end());
  values_.clear();
  unverified_.clear();
  return true;
}

FittedRods::Rods ShapeMisfit::rods(const MaterialPoint& material) {
  FittedRods::Rods result;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const std::shared_ptr<const Solved> shape = solved(i, material);
    result.push_back(shape ? std::optional(shape->equilibrium) : std::nullopt);
  }
  return result;
}

const ShapeMisfit::Unverified* ShapeMisfit::unverified_below(double level) const {
  for (const auto& [unverified, sum] : unverified_) {
    // Moving every point of the shape by the depth changes the root of the sum by no more than
    // this.
    const double off = std::sqrt(static_cast<double>(measured_.points())) * unverified.penetration;
    if (std::sqrt(sum) - off <= std::sqrt(level)) return &unverified;
  }
  return nullptr;
}

}  // namespace dlo::compare
