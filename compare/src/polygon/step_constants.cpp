#include "polygon/step_constants.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dlo/force_model/step_size.hpp"
#include "polygon/point_masses.hpp"

namespace dlo::compare {
namespace {

/// dt and c of the stepper `verlet`, see step_options.
void choose_time_step(const Discretisation& discretisation, force_model::StepOptions& options) {
  const force_model::Rod& rod = discretisation.rod;
  const force_model::ModeBounds modes =
      force_model::mode_bounds(rod, discretisation.starts.front());
  // Only of points that move: one inside a gripper may weigh nothing.
  double lightest = std::numeric_limits<double>::infinity();
  for (const double mass : rod.masses) {
    if (mass > 0) lightest = std::min(lightest, mass);
  }
  if (!std::isfinite(lightest)) return;  // Simulation says what is missing
  options.time_step = verlet_step_share * 2 / std::sqrt(modes.fastest / lightest);
  options.damping_rate = 2 * std::sqrt(modes.slowest / rod.masses.maxCoeff());
}

}  // namespace

force_model::StepOptions step_options(const ForceModelSettings& settings,
                                      const Discretisation& discretisation) {
  force_model::StepOptions options;
  options.policy = force_model::policy(settings.stepper);
  if (settings.stepper == Stepper::verlet) choose_time_step(discretisation, options);
  if (options.policy.automatic ||
      options.policy.integration != force_model::Integration::along_force) {
    return options;
  }
  const Parameters& parameters = discretisation.parameters;
  options.c_F =
      settings.c_F.value_or(table_1_step_share * parameters.segment_length / (2 * parameters.c_c));
  options.l_s = settings.l_s.value_or(table_1_limit_share * parameters.segment_length);
  options.c_h = settings.c_h.value_or(dynamic_share);
  return options;
}

void set_masses(const Scene& scene, const ForceModelSettings& settings,
                Discretisation& discretisation) {
  if (settings.stepper != Stepper::verlet) return;
  const PointMasses masses = point_masses(scene, settings);
  force_model::Rod& rod = discretisation.rod;
  rod.masses.resize(rod.points());
  for (std::size_t i = 0; i < masses.rod.size(); ++i) {
    rod.masses[static_cast<Eigen::Index>(i)] = masses.rod[i] + masses.hanging[i];
  }
}

}  // namespace dlo::compare
