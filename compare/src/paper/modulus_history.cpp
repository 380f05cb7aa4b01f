#include "paper/modulus_history.hpp"

#include <fmt/format.h>

#include <cmath>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/force_model/simulation.hpp"
#include "polygon/point_layout.hpp"

namespace dlo::compare {
namespace {

constexpr double history_times[] = {1, 2, 5, 10, 20, 28, 30, 32, 40, 60, 100, last_history_time};

}  // namespace

ModulusHistory modulus_history(const Scene& scene, const Shape& rest) {
  ForceModelSettings settings = scene.force_model;
  settings.stepper = Stepper::basic;
  const Discretisation discretisation = discretise(scene, settings);
  const force_model::StepOptions options = step_options(settings, discretisation);
  force_model::Simulation simulation(discretisation.rod, discretisation.starts.front(), options);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  ModulusHistory history;
  history.c_c = discretisation.parameters.c_c;
  history.c_F = options.c_F;
  for (const double time : history_times) {
    const auto target = static_cast<long>(time * paper_steps_per_second);
    while (simulation.steps() < target) {
      if (simulation.step().status == force_model::StepStatus::diverged) {
        throw ConvergenceError(fmt::format("{}: the force model diverged at step {} (c_F = {:.4g})",
                                           scene.name, simulation.steps(), options.c_F));
      }
    }
    const Shape shape = discretisation.shape(simulation.points());
    ModulusAtTime at;
    at.time_s = time;
    at.steps = simulation.steps();
    at.modulus = fit_effective_modulus(scene, distance_from(shape), energy);
    at.rms_over_length = distance(shape, energy.sample) / scene.length;
    at.rest_distance_over_length = rms(shape.arc_length, shape.points - rest.points) / scene.length;
    history.times.push_back(at);
  }
  return history;
}

double time_at_ratio(const std::vector<ModulusAtTime>& times, double ratio) {
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const double before = times[i].modulus.ratio / ratio;
    const double after = times[i + 1].modulus.ratio / ratio;
    if (before >= 1 && after < 1) {
      const double share = std::log(before) / std::log(before / after);
      return times[i].time_s * std::pow(times[i + 1].time_s / times[i].time_s, share);
    }
  }
  return NAN;
}

}  // namespace dlo::compare
