#pragma once

#include "dlo/compare/fitted_material.hpp"
#include "fit/material_profiles.hpp"

namespace dlo::compare {

/// Residuals that no noise leaves: what would remove them, and whether they put the fit in doubt.
/// @param best         material of the fit
/// @param[in,out] fit  of it alone, with all but its alternatives
/// @return whether the interval of E includes that of any intrinsically curved wire in misaligned
/// clamps
bool look_for_alternatives(MaterialProfiles& material, const MaterialPoint& best, MaterialFit& fit);

}  // namespace dlo::compare
