#include "solve/stretch_effect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solve.hpp"
#include "polygon/polygon_response.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Returns an upper bound of the force in any cross-section [N]: half the sum of all forces, since
/// the forces on both sides of a section balance.
double most_force(const Scene& scene, const energy_model::Equilibrium& rod) {
  double all = scene.weight_per_length().norm() * scene.length + scene.total_of_loads();
  for (const energy_model::Reaction& grip : rod.grips) all += grip.force.norm();
  for (const Eigen::Vector3d& force : rod.obstacles) all += force.norm();
  return all / 2;
}

/// Returns the smallest slack between two neighbouring grips, as a share of the rod between them; 1
/// with a single grip.
double least_slack(const Scene& scene) {
  const std::vector<const Gripper*> along = grippers_along(scene);
  double least = 1;
  for (std::size_t i = 0; i + 1 < along.size(); ++i) {
    const double rod = along[i + 1]->at - along[i]->at;
    if (!(rod > 0)) continue;
    least = std::min(least, 1 - (along[i + 1]->position - along[i]->position).norm() / rod);
  }
  return least;
}

bool touches_any(const energy_model::Equilibrium& rod) {
  return std::any_of(rod.obstacles.begin(), rod.obstacles.end(),
                     [](const Eigen::Vector3d& force) { return force.norm() > 0; });
}

double largest_size(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Estimates the effect by the lowest shape of a rod that is longer by the mean strain, with the
/// same weight and EI.
/// @param own  solution of the rod, with tensions at equally spaced arc lengths
void look_at_longer_rod(const Scene& scene, const Solution& own, double EA,
                        const SolveOptions& options, StretchEffect& effect) {
  double mean = 0;
  for (std::size_t i = 1; i < own.tension.size(); ++i) {
    mean += (own.tension[i - 1] + own.tension[i]) / (2 * EA);
  }
  mean /= static_cast<double>(own.tension.size() - 1);
  Scene longer = scene;
  scale_length(longer, 1 + mean);
  longer.scale_density(1 / (1 + mean));
  for (DistributedLoad& load : longer.distributed_loads) {
    for (Eigen::Vector3d& force : load.force_per_length) force /= 1 + mean;
  }
  SolveOptions anew = options;
  anew.start = nullptr;
  try {
    const Solution other =
        solution_of(longer, Model::energy, solve_reference(longer, Model::energy, anew),
                    equal_arc_lengths(longer.length, rod_points), obstacles_in_reach(longer));
    effect.moved_m = rms(own.shape.arc_length, other.shape.points - own.shape.points);
    const double before = largest_size(own.tension);
    effect.tension = largest_size(other.tension) / before - 1;
  } catch (const ConvergenceError&) {
    // The effect remains unknown.
  } catch (const InputError&) {
    // The effect remains unknown.
  }
}

/// Smallest slack for which the effect is estimated [-].
constexpr double taut = 1e-9;

bool matters(const StretchEffect& effect, const Scene& scene, const SolveOptions& options) {
  if (std::isnan(effect.moved_m)) {
    // The tension of a line that sags only by its slack decreases by this share.
    return effect.strain / (2 * least_slack(scene)) > options.target;
  }
  return effect.moved_m > options.target * scene.length ||
         std::abs(effect.tension) > options.target;
}

/// Returns the shape with stretch, std::nullopt if the exact model rejects the scene with stretch,
/// as next to obstacles.
std::optional<energy_model::Equilibrium> exact_with_stretch(const Scene& scene,
                                                            const SolveOptions& options) {
  try {
    return solve_reference(scene, Model::exact, options);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

StretchEffect stretch_effect(const Scene& scene, Model model, const energy_model::Equilibrium& rod,
                             const SolveOptions& options) {
  StretchEffect effect;
  const std::optional<double> EA = scene.known_axial_stiffness();
  if (!EA || !rod.sample) return effect;
  const double slack = least_slack(scene);
  if (!(slack > taut)) return effect;
  if (!(most_force(scene, rod) / *EA * (1 + 1 / slack) > options.target)) return effect;
  const Solution own = solution_of(scene, model, rod, equal_arc_lengths(scene.length, rod_points),
                                   obstacles_in_reach(scene));
  if (own.tension.empty()) return effect;
  effect.strain = largest_size(own.tension) / *EA;
  if (!(effect.strain * (1 + 1 / slack) > options.target)) return effect;
  if (!touches_any(rod) && why_no_polygon(scene).empty()) {
    if (const std::optional<Discretisation> fine = hooke_polygon(scene, rod_points)) {
      const StretchResponse response = PolygonResponse(scene, *fine, rod).stretch(*EA);
      if (std::isfinite(response.moved_m)) {
        effect.moved_m = response.moved_m;
        effect.tension = response.tension;
        return effect;
      }
    }
  }
  look_at_longer_rod(scene, own, *EA, options, effect);
  // A larger displacement means that the search found another equilibrium.
  constexpr double another = 10;
  if (effect.moved_m > another * effect.strain * (1 + 1 / slack) * scene.length) {
    effect.moved_m = effect.tension = std::numeric_limits<double>::quiet_NaN();
  }
  return effect;
}

StretchedRod told_of_stretch(const Scene& scene, Model model, const energy_model::Equilibrium& rod,
                             const SolveOptions& options) {
  StretchedRod told{.scene = scene, .rod = rod};
  told.scene.stretch = Stretch::none;
  told.effect = stretch_effect(told.scene, model, rod, options);
  const bool decides = scene.stretch == Stretch::automatic;
  told.neglects_stretch =
      matters(told.effect, scene, options) || (decides && !(least_slack(scene) > taut));
  if (decides) {
    told.decision =
        told.neglects_stretch ? StretchDecision::not_modelled : StretchDecision::below_target;
  }
  return told;
}

StretchedRod decide_stretch(const Scene& scene, Model model, const SolveOptions& options) {
  if (scene.stretch == Stretch::counted) {
    return {.scene = scene, .rod = solve_reference(scene, model, options)};
  }
  Scene stretched = scene;
  stretched.stretch = Stretch::counted;
  const bool may_count = scene.stretch == Stretch::automatic && model == Model::exact;
  if (may_count && !(least_slack(scene) > taut)) {
    // Without stretch the rod may not reach its grips, so it is not solved first.
    return {.scene = stretched,
            .rod = solve_reference(stretched, model, options),
            .decision = StretchDecision::counted};
  }
  Scene rigid = scene;
  rigid.stretch = Stretch::none;
  StretchedRod told =
      told_of_stretch(scene, model, solve_reference(rigid, model, options), options);
  if (!may_count || !told.neglects_stretch) return told;
  if (std::optional<energy_model::Equilibrium> rod = exact_with_stretch(stretched, options)) {
    told.scene = stretched;
    told.rod = *std::move(rod);
    told.neglects_stretch = false;
    told.decision = StretchDecision::counted;
  }
  return told;
}

}  // namespace dlo::compare
