#include "dlo/force_model/stepper.hpp"

namespace dlo::force_model {

StepPolicy policy(Stepper stepper) {
  switch (stepper) {
    case Stepper::basic:
      return {};
    case Stepper::limited:
      return {.limit = StepLimit::absolute, .damping = true};
    case Stepper::relative:
      return {.limit = StepLimit::relative, .damping = true};
    case Stepper::dynamic:
      return {.limit = StepLimit::relative, .momentum = true, .damping = true};
    case Stepper::verlet:
      return {.integration = Integration::verlet};
    case Stepper::implicit:
      return {.integration = Integration::implicit_euler};
    case Stepper::automatic:
      break;
  }
  return {.limit = StepLimit::relative, .momentum = true, .automatic = true};
}

}  // namespace dlo::force_model
