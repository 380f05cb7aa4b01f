#pragma once

#include "dlo/compare/force_model_settings.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Calls `visit` with each key of [force_model] and its member.
template <typename Settings, typename Visit>
void each_member(Settings& settings, const Visit& visit) {
  visit("points", settings.points);
  visit("law", settings.law);
  visit("joint_law", settings.joint_law);
  visit("bookkeeping", settings.bookkeeping);
  visit("stepper", settings.stepper);
  visit("bending_rule", settings.bending_rule);
  visit("design_curvature", settings.design_curvature);
  visit("point_weight", settings.point_weight);
  visit("c_b", settings.c_b);
  visit("c_c", settings.c_c);
  visit("c_F", settings.c_F);
  visit("c_h", settings.c_h);
  visit("l_s", settings.l_s);
}

/// Reads the table [force_model].
/// @throws InputError that names file, line, key, value and what is allowed; check() rejects
/// settings that contradict each other
[[nodiscard]] ForceModelSettings read_force_model(StrictTable& table);

}  // namespace dlo::compare
