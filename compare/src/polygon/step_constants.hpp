#pragma once

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::compare {

/// The stepper a scene asks for. @throws InputError if it lacks a constant that its stepper needs
[[nodiscard]] force_model::StepOptions step_options(const ForceModelSettings& settings,
                                                    const Discretisation& discretisation);

}  // namespace dlo::compare
