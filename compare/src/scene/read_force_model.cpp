#include "scene/read_force_model.hpp"

#include "toml/scene_keys.hpp"

namespace dlo::compare {

ForceModelSettings read_force_model(StrictTable& table) {
  table.only(scene_keys("force_model"));
  ForceModelSettings settings;
  settings.points = table.optional_integer("points", 4, 1'000'000).value_or(settings.points);
  settings.law = table.optional_choice<BendingLaw>("law").value_or(settings.law);
  settings.joint_law = table.optional_choice<energy_model::JointLaw>("joint_law");
  settings.bookkeeping =
      table.optional_choice<Bookkeeping>("bookkeeping").value_or(settings.bookkeeping);
  settings.stepper = table.optional_choice<Stepper>("stepper").value_or(settings.stepper);
  settings.bending_rule =
      table.optional_choice<BendingRule>("bending_rule").value_or(settings.bending_rule);
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
