#include "polygon/step_constants.hpp"

namespace dlo::compare {

force_model::StepOptions step_options(const ForceModelSettings& settings,
                                      const Discretisation& discretisation) {
  force_model::StepOptions options;
  options.policy = force_model::policy(settings.stepper);
  if (settings.stepper == Stepper::automatic) return options;
  const Parameters& parameters = discretisation.parameters;
  options.c_F =
      settings.c_F.value_or(table_1_step_share * parameters.segment_length / (2 * parameters.c_c));
  options.l_s = settings.l_s.value_or(table_1_limit_share * parameters.segment_length);
  options.c_h = settings.c_h.value_or(dynamic_share);
  return options;
}

}  // namespace dlo::compare
