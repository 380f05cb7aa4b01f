#pragma once

#include "dlo/compare/fitted_material.hpp"
#include "fit/material_profiles.hpp"

namespace dlo::compare {

/// Analyses residuals that noise does not explain: adds alternatives that would remove them, and a
/// warning if they cast doubt on the fit.
/// @param best         material of the fit
/// @param[in,out] fit  fit of the material alone, complete except for its alternatives
/// @return whether the interval of E includes that of any intrinsically curved wire in misaligned
/// clamps
bool look_for_alternatives(MaterialProfiles& material, const MaterialPoint& best, MaterialFit& fit);

}  // namespace dlo::compare
