#include "dlo/compare/force_model_settings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/input_file.hpp"
#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/error.hpp"
#include "scene/members.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

void check(const ForceModelSettings& settings, const std::string& where) {
  const Stepper stepper = settings.stepper;
  const bool uses_masses = stepper == Stepper::verlet || stepper == Stepper::implicit;
  const bool automatic = stepper == Stepper::automatic;
  const struct {
    bool without_effect;
    const char* key;
    const char* allowed;
  } rules[] = {
      {settings.c_F && automatic, "c_F", "a stepper other than auto, which chooses its own"},
      {settings.c_F && uses_masses, "c_F", "stepper basic, limited, relative or dynamic"},
      {settings.c_h && stepper != Stepper::dynamic, "c_h", "stepper dynamic"},
      {settings.l_s && stepper == Stepper::basic, "l_s", "a stepper other than basic"},
      {settings.l_s && uses_masses, "l_s", "stepper limited, relative, dynamic or auto"},
      {settings.c_b && settings.law == BendingLaw::hooke, "c_b", "law paper"},
      {settings.joint_law && settings.law == BendingLaw::paper, "joint_law", "law hooke"},
      {settings.point_weight && settings.bookkeeping != Bookkeeping::paper, "point_weight",
       "bookkeeping paper"}};
  for (const auto& rule : rules) {
    if (!rule.without_effect) continue;
    throw InputError(fmt::format("{}: {} would have no effect (allowed: with {})", where, rule.key,
                                 rule.allowed));
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
    throw std::invalid_argument(fmt::format(
        "paper_bending_stiffness: EI = {} (allowed: > 0), L k = {} (allowed: in (0, pi))",
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
  table.use_rows_of("force_model");
  ForceModelSettings settings;
  read_members(table, settings);
  table.finish();
  return settings;
}

}  // namespace dlo::compare
