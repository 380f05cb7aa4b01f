#include "dlo/compare/force_model_settings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/input_file.hpp"
#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/error.hpp"
#include "scene/read_force_model.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

void check(const ForceModelSettings& settings, const std::string& where) {
  const auto refuse = [&](const char* key, const char* allowed) {
    throw InputError(
        fmt::format("{}: {} would have no effect (allowed: with {})", where, key, allowed));
  };
  const bool automatic = settings.stepper == Stepper::automatic;
  const bool dynamic = settings.stepper == Stepper::dynamic;
  const bool masses_or_newton =
      settings.stepper == Stepper::verlet || settings.stepper == Stepper::implicit;
  if (settings.c_F && automatic) refuse("c_F", "a stepper other than auto, which chooses its own");
  if (settings.c_F && masses_or_newton)
    refuse("c_F", "stepper basic, limited, relative or dynamic");
  if (settings.c_h && !dynamic) refuse("c_h", "stepper dynamic");
  if (settings.l_s && settings.stepper == Stepper::basic) {
    refuse("l_s", "a stepper other than basic");
  }
  if (settings.l_s && masses_or_newton) refuse("l_s", "stepper limited, relative, dynamic or auto");
  if (settings.c_b && settings.law == BendingLaw::hooke) refuse("c_b", "law paper");
  if (settings.joint_law && settings.law == BendingLaw::paper) refuse("joint_law", "law hooke");
  if (settings.point_weight && settings.bookkeeping != Bookkeeping::paper) {
    refuse("point_weight", "bookkeeping paper");
  }
}

ForceModelSettings parse_parameters(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  table.only({"derived", "force_model"});
  StrictTable settings_table = table.table("force_model");
  const ForceModelSettings settings = read_force_model(settings_table);
  check(settings, settings_table.where());
  (void)table.optional_table("derived");
  table.finish();
  return settings;
}

ForceModelSettings load_parameters(const std::string& path) {
  return parse_parameters(read_file(path), path);
}

double paper_bending_stiffness(BendingRule rule, double bending_stiffness, double curvature,
                               double segment_length) {
  const double alpha = curvature * segment_length;
  if (!(bending_stiffness > 0) || !(alpha > 0 && alpha < std::numbers::pi)) {
    throw std::invalid_argument(
        fmt::format("paper_bending_stiffness: EI = {}, L k = {}, must be > 0 and in (0, pi)",
                    bending_stiffness, alpha));
  }
  const double half = std::sin(alpha / 2);
  const double formula_21 =
      bending_stiffness * curvature * curvature / (2 * half * half * half);  // (21)
  switch (rule) {
    case BendingRule::formula_21:
      return formula_21;
    case BendingRule::moment_matched:
      break;
  }
  return formula_21 / alpha;
}

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
