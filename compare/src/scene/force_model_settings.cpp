#include "dlo/compare/force_model_settings.hpp"

#include <fmt/format.h>

#include "base/input_file.hpp"
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

}  // namespace dlo::compare
