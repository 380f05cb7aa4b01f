#include "solve/stretch_effect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
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
double largest_force_bound(const Scene& scene, const energy_model::Equilibrium& rod) {
  double all = scene.weight_per_length().norm() * scene.length + scene.total_load_magnitude();
  if (scene.drag) all += scene.drag->largest() * scene.length;
  for (const energy_model::Reaction& grip : rod.grips) all += grip.force.norm();
  for (const Eigen::Vector3d& force : rod.obstacles) all += force.norm();
  return all / 2;
}

/// Returns the smallest slack between two neighbouring grips, as a share of the rod between them; 1
/// with a single grip.
double smallest_slack(const Scene& scene) {
  const std::vector<const Gripper*> along = grippers_by_arc_length(scene);
  double least = 1;
  for (std::size_t i = 0; i + 1 < along.size(); ++i) {
    const double rod = along[i + 1]->at - along[i]->at;
    if (!(rod > 0)) continue;
    least = std::min(least, 1 - (along[i + 1]->position - along[i]->position).norm() / rod);
  }
  return least;
}

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Estimates the effect by the lowest shape of a rod that is longer by the mean strain, with the
/// same weight and EI.
/// @param solution  of the rod, with tensions at equally spaced arc lengths
void estimate_by_longer_rod(const Scene& scene, const Solution& solution, double EA,
                            const SolveOptions& options, StretchEffect& effect) {
  double mean = 0;
  for (std::size_t i = 1; i < solution.tension.size(); ++i) {
    mean += (solution.tension[i - 1] + solution.tension[i]) / (2 * EA);
  }
  mean /= static_cast<double>(solution.tension.size() - 1);
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
    effect.displacement_m =
        rms(solution.shape.arc_length, other.shape.points - solution.shape.points);
    const double before = largest_magnitude(solution.tension);
    effect.tension = largest_magnitude(other.tension) / before - 1;
  } catch (const ResultError&) {
    // The effect remains unknown.
  }
}

/// Smallest slack for which the effect is estimated [-].
constexpr double least_estimated_slack = 1e-9;

bool stretch_matters(const StretchEffect& effect, const Scene& scene, const SolveOptions& options) {
  if (std::isnan(effect.displacement_m)) {
    // The tension of a line that sags only by its slack decreases by this share.
    return effect.strain / (2 * smallest_slack(scene)) > options.target;
  }
  return effect.displacement_m > options.target * scene.length ||
         std::abs(effect.tension) > options.target;
}

/// Estimates what stretch would change of an equilibrium of `energy` or `exact`: by
/// PolygonResponse, or, where that does not apply, as for a rod that touches an obstacle, by the
/// energy model's shape of a rod that is longer by the mean strain. The estimate is omitted if
/// strain (1 + 1 / slack) does not exceed the target, because away from a bifurcation the effect is
/// smaller than this product. It is also omitted if EA or the tension is unknown, or if grips hold
/// the rod taut.
StretchEffect stretch_effect(const Scene& scene, Model model, const energy_model::Equilibrium& rod,
                             const SolveOptions& options) {
  StretchEffect effect;
  const std::optional<double> EA = scene.known_axial_stiffness();
  if (!EA || !rod.sample) return effect;
  const double slack = smallest_slack(scene);
  if (!(slack > least_estimated_slack)) return effect;
  if (!(largest_force_bound(scene, rod) / *EA * (1 + 1 / slack) > options.target)) return effect;
  const Solution solution = solution_of(
      scene, model, rod, equal_arc_lengths(scene.length, rod_points), obstacles_in_reach(scene));
  if (solution.tension.empty()) return effect;
  effect.strain = largest_magnitude(solution.tension) / *EA;
  if (!(effect.strain * (1 + 1 / slack) > options.target)) return effect;
  if (!touches_obstacle(rod) && why_no_polygon(scene).empty()) {
    if (const std::optional<Discretisation> fine = hooke_polygon(scene, rod_points)) {
      const StretchResponse response = PolygonResponse(scene, *fine, rod).stretch(*EA);
      if (std::isfinite(response.displacement_m)) {
        effect.displacement_m = response.displacement_m;
        effect.tension = response.tension;
        return effect;
      }
    }
  }
  estimate_by_longer_rod(scene, solution, *EA, options, effect);
  // A larger displacement means that the search found another equilibrium.
  constexpr double other_equilibrium_factor = 10;
  if (effect.displacement_m >
      other_equilibrium_factor * effect.strain * (1 + 1 / slack) * scene.length) {
    effect.displacement_m = effect.tension = std::numeric_limits<double>::quiet_NaN();
  }
  return effect;
}

}  // namespace

StretchedRod with_stretch_effect(const Scene& scene, Model model,
                                 const energy_model::Equilibrium& rod,
                                 const SolveOptions& options) {
  StretchedRod result{.scene = scene, .rod = rod};
  result.scene.stretch = Stretch::none;
  result.effect = stretch_effect(result.scene, model, rod, options);
  const bool decides = scene.stretch == Stretch::automatic;
  result.neglects_stretch = stretch_matters(result.effect, scene, options) ||
                            (decides && !(smallest_slack(scene) > least_estimated_slack));
  if (decides) {
    result.decision =
        result.neglects_stretch ? StretchDecision::not_modelled : StretchDecision::below_target;
  }
  return result;
}

StretchedRod decide_stretch(const Scene& scene, Model model, const SolveOptions& options) {
  if (scene.stretch == Stretch::counted) {
    return {.scene = scene, .rod = solve_reference(scene, model, options)};
  }
  Scene stretched = scene;
  stretched.stretch = Stretch::counted;
  const bool may_include_stretch = scene.stretch == Stretch::automatic && model == Model::exact;
  if (may_include_stretch && !(smallest_slack(scene) > least_estimated_slack)) {
    // Without stretch the rod may not reach its grips, so it is not solved first.
    return {.scene = stretched,
            .rod = solve_reference(stretched, model, options),
            .decision = StretchDecision::counted};
  }
  Scene rigid = scene;
  rigid.stretch = Stretch::none;
  StretchedRod result =
      with_stretch_effect(scene, model, solve_reference(rigid, model, options), options);
  if (!may_include_stretch || !result.neglects_stretch) return result;
  try {
    result.rod = solve_reference(stretched, model, options);
  } catch (const InputError&) {
    return result;  // the model rejects the scene with stretch, as next to obstacles
  }
  result.scene = stretched;
  result.neglects_stretch = false;
  result.decision = StretchDecision::counted;
  return result;
}

}  // namespace dlo::compare
