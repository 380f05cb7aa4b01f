#include "dlo/compare/force_model_settings.hpp"

#include <fmt/format.h>

#include "base/input_file.hpp"
#include "base/words.hpp"
#include "dlo/compare/error.hpp"
#include "scene/read_force_model.hpp"
#include "scene/strict_table.hpp"

namespace dlo::compare {

const std::vector<std::string>& law_names() {
  static const std::vector<std::string> names = {"paper", "hooke"};
  return names;
}

const std::vector<std::string>& bookkeeping_names() {
  static const std::vector<std::string> names = {"paper", "consistent"};
  return names;
}

const std::vector<std::string>& stepper_names() {
  static const std::vector<std::string> names = {"basic", "limited", "relative", "dynamic", "auto"};
  return names;
}

const std::vector<std::string>& bending_rule_names() {
  static const std::vector<std::string> names = {"formula_21", "moment_matched"};
  return names;
}

Law law_from(const std::string& name) { return choice_from<Law>(name, law_names()); }

Bookkeeping bookkeeping_from(const std::string& name) {
  return choice_from<Bookkeeping>(name, bookkeeping_names());
}

StepperName stepper_from(const std::string& name) {
  return choice_from<StepperName>(name, stepper_names());
}

BendingRule bending_rule_from(const std::string& name) {
  return choice_from<BendingRule>(name, bending_rule_names());
}

const char* to_string(Law law) { return law_names()[static_cast<std::size_t>(law)].c_str(); }

const char* to_string(Bookkeeping bookkeeping) {
  return bookkeeping_names()[static_cast<std::size_t>(bookkeeping)].c_str();
}

const char* to_string(StepperName stepper) {
  return stepper_names()[static_cast<std::size_t>(stepper)].c_str();
}

const char* to_string(BendingRule rule) {
  return bending_rule_names()[static_cast<std::size_t>(rule)].c_str();
}

void check(const ForceModelSettings& settings, const std::string& where) {
  const auto refuse = [&](const char* key, const char* allowed) {
    throw InputError(
        fmt::format("{}: {} would have no effect (allowed: with {})", where, key, allowed));
  };
  const bool automatic = settings.stepper == StepperName::automatic;
  const bool dynamic = settings.stepper == StepperName::dynamic;
  if (settings.c_F && automatic) refuse("c_F", "a stepper other than auto, which chooses its own");
  if (settings.c_h && !dynamic) refuse("c_h", "stepper dynamic");
  if (settings.l_s && settings.stepper == StepperName::basic) {
    refuse("l_s", "a stepper other than basic");
  }
  if (settings.c_b && settings.law == Law::hooke) refuse("c_b", "law paper");
  if (settings.point_weight && settings.bookkeeping != Bookkeeping::paper) {
    refuse("point_weight", "bookkeeping paper");
  }
}

ForceModelSettings parse_parameters(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
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
