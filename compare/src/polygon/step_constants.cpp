#include "polygon/step_constants.hpp"

namespace dlo::compare {

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
