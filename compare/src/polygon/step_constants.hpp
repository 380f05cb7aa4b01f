#pragma once

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::compare {

/// Table 1's c_F as a share of the largest stable step, L/(2 c_c); no formula in the paper gives
/// it.
inline constexpr double table_1_step_share = 0.86;
/// The same in words.
inline constexpr const char* table_1_step_formula = "c_F = 0.86 L/(2 c_c)";
/// Table 1's l_s as a share of L.
inline constexpr double table_1_limit_share = 0.6;
/// c_h of the stepper `dynamic`, which the paper leaves open.
inline constexpr double dynamic_share = 0.9;

/// Time step of the stepper `verlet` as a share of the largest stable one, 2/omega_max, of the rod
/// where it starts: bent joints and compressed segments are stiffer than straight ones.
inline constexpr double verlet_step_share = 0.5;

/// The stepper a scene asks for; what it does not give is in Table 1's proportions. That of
/// `verlet` takes verlet_step_share and damps the slowest mode, as mode_bounds estimates it,
/// critically; `implicit` takes no masses. @throws InputError if it lacks a constant that its
/// stepper needs
[[nodiscard]] force_model::StepOptions step_options(const ForceModelSettings& settings,
                                                    const Discretisation& discretisation);

/// Gives the rod of a discretisation its points' masses, if the stepper asks for them.
/// @throws InputError as discretise()
void set_masses(const Scene& scene, const ForceModelSettings& settings,
                Discretisation& discretisation);

}  // namespace dlo::compare
