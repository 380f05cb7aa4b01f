#include "dlo/compare/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "polygon/energy_problems.hpp"
#include "scene/scene_problem.hpp"
#include "solve/held_frames.hpp"
#include "solve/stretch_effect.hpp"

namespace dlo::compare {
namespace {

/// Throws an InputError for a rod that a solver rejects, with the scene's file in place of the
/// solver's function.
[[noreturn]] void refuse_rod(const Scene& scene, Model model, const std::invalid_argument& error) {
  const std::string_view message = error.what();
  const std::size_t function = message.find(": ");
  const bool touches = model == Model::exact && !obstacles_in_reach(scene).empty();
  throw InputError(
      fmt::format("{}: rod: model {}: {}{}", scene.file, to_string(model),
                  message.substr(function == std::string_view::npos ? 0 : function + 2),
                  touches ? " (--model energy, chain or force takes every obstacle)" : ""));
}

/// Describes the searches for equilibria, for a message.
std::string searches_text(const std::vector<energy_model::Equilibrium>& searches) {
  if (searches.empty()) return "no initial guess to search from";
  return fmt::format("{} search{}, the first: {} after {} evaluations", searches.size(),
                     searches.size() == 1 ? "" : "es", searches.front().message,
                     searches.front().evaluations);
}

/// Whether a shape is an equilibrium under loads without a potential, whose stability no energy can
/// decide.
bool is_balance_alone(const energy_model::Problem& problem,
                      const energy_model::Equilibrium& shape) {
  return shape.status == energy_model::SolveStatus::not_verified && shape.sample &&
         !energy_model::has_potential(problem);
}

/// Whether a shape may be returned: it is proven, or unproven results are accepted.
bool is_acceptable(energy_model::SolveStatus status, const SolveOptions& options) {
  return energy_model::succeeded(status) ||
         (options.accept_unverified && (status == energy_model::SolveStatus::not_verified ||
                                        status == energy_model::SolveStatus::near_singular));
}

/// Sets the status of an equilibrium with other turns than the grips hold to not_verified: it is an
/// equilibrium of another scene.
void mark_lost_turns(const Scene& scene, energy_model::Equilibrium& equilibrium) {
  if (!energy_model::succeeded(equilibrium.status)) return;
  std::string lost = turns_mismatch_message(linking_of(scene, equilibrium));
  if (lost.empty()) return;
  equilibrium.status = energy_model::SolveStatus::not_verified;
  equilibrium.message = std::move(lost);
}

/// Solves a soft rod that stretches, starting at the energy model's shape without stretch, because
/// the search by multiple shooting is slow for it. Returns std::nullopt for other rods, and if one
/// of the models finds no shape, such as `energy` for a rod that is pulled straight.
std::optional<energy_model::Equilibrium> stretched_shape(const Scene& scene,
                                                         const energy_model::Problem& problem,
                                                         const energy_model::ExactOptions& exact) {
  constexpr double soft_rod_gamma = 1e3;  // Gamma; for stiffer rods multiple shooting is fast
  if (!problem.axial_stiffness || !problem.obstacles.empty() || !(scene.gamma() > soft_rod_gamma)) {
    return std::nullopt;
  }
  energy_model::Problem rigid = problem;
  rigid.axial_stiffness.reset();
  try {
    const energy_model::Equilibrium unstretched =
        energy_model::solve_energy(rigid, {.time_limit = exact.time_limit / 2});
    if (!energy_model::succeeded(unstretched.status)) return std::nullopt;
    energy_model::ExactOptions from = exact;
    from.start = &unstretched;
    from.time_limit = exact.time_limit / 2;
    energy_model::Equilibrium result = energy_model::solve_exact(problem, from);
    if (!energy_model::succeeded(result.status)) return std::nullopt;
    result.message += ", from the energy model's shape without stretch";
    return result;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// Solves a scene by the exact model. If an obstacle is in reach, the energy model detects the
/// contacts, and the exact model confirms or corrects them.
/// @throws std::invalid_argument, ConvergenceError if the energy model does not converge
energy_model::Equilibrium exact_shape(const Scene& scene, const energy_model::Problem& problem,
                                      const SolveOptions& options) {
  const TimeLimit limit(options.time_limit);
  const auto remaining_time = [&] {
    return std::max(limit.left(), std::numeric_limits<double>::min());
  };
  energy_model::ExactOptions exact{.time_limit = options.time_limit};
  if (problem.axial_stiffness && options.start != nullptr) {
    exact.start = options.start;
    return energy_model::solve_exact(problem, exact);
  }
  if (std::optional<energy_model::Equilibrium> stretched = stretched_shape(scene, problem, exact)) {
    return *std::move(stretched);
  }
  // The exact model rejects yielding obstacles with any start.
  const bool yields = std::any_of(
      problem.obstacles.begin(), problem.obstacles.end(),
      [](const energy_model::Obstacle& obstacle) { return std::isfinite(obstacle.stiffness); });
  if (problem.obstacles.empty() || yields) return energy_model::solve_exact(problem, exact);
  const energy_model::Equilibrium detected =
      energy_model::solve_energy(problem, {.time_limit = remaining_time()});
  if (!energy_model::succeeded(detected.status)) {
    throw ConvergenceError(
        fmt::format("{}: the energy model, which detects the contacts that exact confirms, did not "
                    "converge: {}",
                    scene.file, detected.message));
  }
  exact.start = &detected;
  exact.time_limit = remaining_time();
  energy_model::Equilibrium confirmed = energy_model::solve_exact(problem, exact);
  confirmed.message += ", with the contacts that the energy model detected";
  return confirmed;
}

bool enters_obstacle(const Scene& scene, const energy_model::Equilibrium& shape) {
  constexpr int samples = 401;
  const Eigen::Matrix3Xd points = shape.sample(equal_arc_lengths(scene.length, samples)).points;
  return std::ranges::any_of(scene.obstacles, [&](const Obstacle& obstacle) {
    return std::ranges::any_of(points.colwise(), [&](const Eigen::Vector3d& point) {
      return obstacle.body.clearance(point) < 0;
    });
  });
}

/// Rejects a rod that stretches and has an obstacle in reach, since no continuous model has both.
/// @param stretched  a shape of the rod, which may reach obstacles by its stretch; null: not yet
/// solved
/// @throws InputError
void refuse_stretch_beside_obstacles(const Scene& scene,
                                     const energy_model::Equilibrium* stretched) {
  if (scene.stretch != Stretch::counted || scene.obstacles.empty()) return;
  const bool reaches = stretched == nullptr
                           ? !obstacles_in_reach(scene).empty()
                           : stretched->sample && enters_obstacle(scene, *stretched);
  if (!reaches) return;
  throw InputError(fmt::format(
      "{}: rod.stretch = true: an obstacle is in reach, and model exact has no contact of a rod "
      "that stretches (allowed: stretch = false, no obstacle in reach, or --model chain or force, "
      "whose segments stretch)",
      scene.file));
}

/// Rejects a scene that the energy model does not have: loads without a potential, or a rod that
/// stretches, with a message about the scene's key. @throws InputError
void require_energy_model(const Scene& scene) {
  scene.require_potential("the energy model");
  if (scene.stretch != Stretch::counted) return;
  throw InputError(fmt::format(
      "{}: rod.stretch = true: model energy does not stretch (allowed: --model exact, or chain and "
      "force, whose segments do; or stretch = false or \"auto\")",
      scene.file));
}

}  // namespace

Model reference_model(const Scene& scene) {
  return scene.stretch == Stretch::counted ? Model::exact : Model::energy;
}

energy_model::Equilibrium solve_reference(const Scene& scene, const SolveOptions& options) {
  return solve_reference(scene, reference_model(scene), options);
}

energy_model::Equilibrium solve_reference(const Scene& scene, Model model,
                                          const SolveOptions& options) {
  if (model == Model::exact && scene.stretch == Stretch::automatic) {
    return decide_stretch(scene, model, options).rod;
  }
  if (model == Model::energy) require_energy_model(scene);
  if (model == Model::exact) refuse_stretch_beside_obstacles(scene, nullptr);
  const energy_model::Problem problem = energy_problem(scene);
  energy_model::Equilibrium result;
  try {
    result = model == Model::exact
                 ? exact_shape(scene, problem, options)
                 : energy_model::solve_energy(problem, {.terms = options.terms,
                                                        .max_evaluations = options.max_evaluations,
                                                        .time_limit = options.time_limit,
                                                        .start = options.start});
  } catch (const std::invalid_argument& error) {
    refuse_rod(scene, model, error);
  }
  if (model == Model::exact) refuse_stretch_beside_obstacles(scene, &result);
  mark_lost_turns(scene, result);
  if (!is_acceptable(result.status, options) && !is_balance_alone(problem, result)) {
    throw ConvergenceError(fmt::format(
        "{}: the {} model did not converge: {} ({} evaluations{}{})", scene.file, to_string(model),
        result.message, result.evaluations,
        result.status == energy_model::SolveStatus::time_limit
            ? fmt::format("; --time-limit {:g} allows no more", options.time_limit)
            : "",
        problem.obstacles.empty() ? ""
        : model == Model::exact   ? "; --model energy may do"
                                  : "; --model chain or an obstacle with a stiffness may do"));
  }
  return result;
}

energy_model::EnergySearch search_states(const Scene& scene, const SolveOptions& options) {
  require_energy_model(scene);
  energy_model::EnergySearch search;
  std::vector<energy_model::Equilibrium>& states = search.equilibria;
  try {
    search = energy_model::search_energy(energy_problem(scene),
                                         {.terms = options.terms,
                                          .max_evaluations = options.max_evaluations,
                                          .time_limit = options.time_limit});
  } catch (const std::invalid_argument& error) {
    refuse_rod(scene, Model::energy, error);
  }
  for (energy_model::Equilibrium& state : states) mark_lost_turns(scene, state);
  const std::string search_summary = searches_text(states);
  std::erase_if(states, [&](const energy_model::Equilibrium& state) {
    return !is_acceptable(state.status, options) &&
           state.status != energy_model::SolveStatus::saddle;
  });
  if (states.empty()) {
    throw ConvergenceError(
        fmt::format("{}: the energy model found no equilibrium ({})", scene.file, search_summary));
  }
  return search;
}

energy_model::Equilibrium reference_near(const Scene& scene, const Shape& shape,
                                         const SolveOptions& options) {
  require_energy_model(scene);
  try {
    energy_model::Equilibrium near =
        energy_model::energy_near(energy_problem(scene), shape.arc_length, shape.points,
                                  {.terms = options.terms,
                                   .max_evaluations = options.max_evaluations,
                                   .time_limit = options.time_limit});
    mark_lost_turns(scene, near);
    return near;
  } catch (const std::invalid_argument& error) {
    refuse_rod(scene, Model::energy, error);
  }
}

std::vector<energy_model::Equilibrium> reference_states(const Scene& scene,
                                                        const SolveOptions& options) {
  if (reference_model(scene) == Model::exact) return {solve_reference(scene, options)};
  return search_states(scene, options).equilibria;
}

std::vector<energy_model::ContactPart> contacts_of(const Scene& scene,
                                                   const energy_model::Equilibrium& equilibrium) {
  const std::vector<std::size_t> in_reach = obstacles_in_reach(scene);
  std::vector<energy_model::ContactPart> contacts = equilibrium.contacts;
  for (energy_model::ContactPart& contact : contacts) contact.obstacle = in_reach[contact.obstacle];
  return contacts;
}

}  // namespace dlo::compare
