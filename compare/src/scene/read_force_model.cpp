#include "scene/read_force_model.hpp"

namespace dlo::compare {

ForceModelSettings read_force_model(StrictTable& table) {
  ForceModelSettings settings;
  settings.points = table.optional_integer("points", 4, 1'000'000).value_or(settings.points);
  if (const auto name = table.optional_choice("law", law_names())) settings.law = law_from(*name);
  if (const auto name = table.optional_choice("bookkeeping", bookkeeping_names())) {
    settings.bookkeeping = bookkeeping_from(*name);
  }
  if (const auto name = table.optional_choice("stepper", stepper_names())) {
    settings.stepper = stepper_from(*name);
  }
  if (const auto name = table.optional_choice("bending_rule", bending_rule_names())) {
    settings.bending_rule = bending_rule_from(*name);
  }
  settings.design_curvature =
      table.optional_number("design_curvature", Dimension::curvature, Range::positive());
  settings.point_weight =
      table.optional_number("point_weight", Dimension::force, Range::not_negative());
  settings.c_b = table.optional_number("c_b", Dimension::force, Range::positive());
  settings.c_c = table.optional_number("c_c", Dimension::force, Range::positive());
  settings.c_F = table.optional_number("c_F", Dimension::number, Range::positive());
  settings.c_h =
      table.optional_number("c_h", Dimension::number, {0, 0.999999999, false, "0 <= c_h < 1"});
  settings.l_s = table.optional_number("l_s", Dimension::length, Range::positive());
  table.finish();
  return settings;
}

}  // namespace dlo::compare
