#include "option/effect.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/error.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

using Names = std::vector<std::string>;

const std::string law_setting = "law";

const Names force_options = {
    "--parameters",       "--points", "--law", "--bookkeeping", "--stepper", "--bending-rule",
    "--design-curvature", "--c-b",    "--c-c", "--c-F",         "--c-h",     "--l-s"};
const Names step_limits = {"--max-steps", "--rest-tolerance"};
const Names step_constants = {"--stepper", "--c-F", "--c-h", "--l-s"};
const Names table_formats = {"csv", "toml"};

Names joined(Names names, const Names& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

OptionCondition if_given(const char* option) { return {option, {any_value}}; }
OptionCondition if_absent(const char* option) { return {option, {}}; }

const Names of_force = joined(force_options, step_limits);
constexpr const char* fits_force = "a fit of the force model: no --shape, --motion, --segments";
const std::vector<IneffectiveOptions> ineffective = {
    {"", {"--design-curvature", "--bending-rule"}, {{law_setting, {"hooke"}}}, "--law paper"},

    {"calibrate", {"--register", "--arc-lengths"}, {if_absent("--shape")}, "--shape FILE"},
    {"calibrate",
     {"--unit"},
     {if_absent("--shape"), if_absent("--segments")},
     "--shape FILE, --segments FILE"},
    {"calibrate",
     {"--unit"},
     {if_absent("--shape"), {"--segments", {whole_number}}},
     "--shape FILE, --segments FILE"},
    {"calibrate", {"--segments"}, {if_given("--motion")}, "no --motion"},
    {"calibrate", of_force, {if_given("--shape")}, fits_force},
    {"calibrate", of_force, {if_given("--motion")}, fits_force},
    {"calibrate", of_force, {if_given("--segments")}, fits_force},
    {"calibrate",
     {"--bending-rule", "--c-F", "--c-h", "--l-s"},
     {},
     "other options of the force model; calibrate finds these"},
    {"calibrate", {"--format"}, {{"--format", {"csv"}}, if_given("--motion")}, "text, json, toml"},
    {"calibrate",
     {"--format"},
     {{"--format", table_formats}, if_given("--segments"), if_absent("--shape")},
     "text, json"},

    {"check", {"--format"}, {{"--format", {"markdown"}}, if_given("--motion")}, "text, json, csv"},

    {"compare",
     {"--target-error"},
     {if_absent("--explain"), {"--format", {"text", "csv"}}},
     "--explain, --format json"},

    {"solve", {"--format"}, {{"--format", {"csv", "vtk"}}, if_given("--all")}, "text, json"},
    {"solve", {"--format"}, {{"--format", {"csv", "vtk"}}, if_given("--explain")}, "text, json"},
    {"solve",
     {"--target-error"},
     {{"--model", {"chain", "force"}},
      if_absent("--explain"),
      {"--format", {"text", "csv", "vtk"}}},
     "--explain, --format json, --model energy, exact"},
    {"solve",
     force_options,
     {{"--model", {"energy", "exact"}},
      if_absent("--explain"),
      {"--format", {"text", "csv", "vtk"}}},
     "--explain, --format json, --model chain, force",
     NoEffect::stated},
    {"solve",
     step_limits,
     {{"--model", {"energy", "exact", "chain"}}},
     "--model force",
     NoEffect::stated},
    {"solve",
     {"--terms"},
     {{"--model", {"exact", "chain", "force"}}},
     "--model energy",
     NoEffect::stated},
    {"solve", step_constants, {{"--model", {"chain"}}}, "--model force", NoEffect::stated},

    {"regress", joined(step_constants, step_limits), {{"--model", {"chain"}}}, "--model force"},

    {"sweep",
     step_limits,
     {{"--model", {"energy", "exact", "chain", "compare-chain"}}},
     "--model force, compare"},
    {"sweep",
     {"--terms"},
     {{"--model", {"exact", "chain", "force"}}},
     "--model energy, compare, compare-chain"},

    {"track", joined(of_force, {"--step-rate"}), {if_given("--no-force")}, "no --no-force"},
    {"track", {"--shapes"}, {{"--format", {"text", "csv"}}}, "--format json"},
    {"track",
     {"--every"},
     {{"--format", {"text"}}, if_absent("--paraview")},
     "--format json, csv, --paraview FILE"},

    {"modes", {"--samples"}, {{"--format", {"text", "csv"}}}, "--format json"},

    {"stability",
     {"--case", "--stepper", "--max-steps", "--max-steps-auto", "--steps-at-rest"},
     {if_given("--map")},
     "no --map"},
    {"stability",
     {"SCENE", "--columns", "--rows", "--map-steps"},
     {if_absent("--map")},
     "--map cF-cc, cF-ch"},

    {"bench", {"--time-limit"}, {if_absent("--with")}, "--with NAME=COMMAND"},

    {"suite",
     {"--points", "--time-limit", "--state", "--baseline", "--markdown", "--junit", "--report",
      "--output"},
     {if_absent("--with")},
     "--with NAME=COMMAND"},
    {"suite", {"--relative", "--absolute"}, {if_absent("--baseline")}, "--baseline FILE"},
};

/// Returns the value of an option or its default; for --format also the output file's extension.
std::string value_of(const CLI::App& command, const std::string& name) {
  const CLI::Option* const option = command.get_option_no_throw(name);
  if (option == nullptr) return "";
  if (option->count() > 0) return option->results().back();
  // A default that depends on the scene is followed by a comma and the alternative.
  const std::string value = option->get_default_str();
  return value.substr(0, value.find(','));
}

bool is_given(const CLI::App& command, const std::string& name) {
  const CLI::Option* const option = command.get_option_no_throw(name);
  return option != nullptr && (option->count() > 0 || name == "--format");
}

/// Returns the condition in words, such as "with --model chain" or "without --shape"; empty if it
/// does not hold.
std::string words_of(const OptionCondition& condition, const CLI::App& command,
                     const compare::ForceModelSettings* settings) {
  const auto contains = [&](const std::string& value) {
    return std::find(condition.values.begin(), condition.values.end(), value) !=
           condition.values.end();
  };
  const bool is_law = condition.option == law_setting;
  if (!is_law && condition.values.empty()) {
    return is_given(command, condition.option) ? "" : "without " + condition.option;
  }
  const std::string value =
      is_law ? compare::to_string(settings->law) : value_of(command, condition.option);
  if (contains(any_value)) {
    return is_given(command, condition.option) ? "with " + condition.option : "";
  }
  const bool is_number =
      !value.empty() && value.find_first_not_of("0123456789") == std::string::npos;
  if (!contains(value) && !(is_number && contains(whole_number))) return "";
  return fmt::format("with {} {}", condition.option, value);
}

/// Returns the reason why the options of a row have no effect; empty if they have one.
std::string why_no_effect(const IneffectiveOptions& row, const CLI::App& command,
                          const compare::ForceModelSettings* settings) {
  std::string why;
  for (const OptionCondition& condition : row.conditions) {
    const std::string words = words_of(condition, command, settings);
    if (words.empty()) return "";
    if (row.options.front() == condition.option) continue;
    why += (why.empty() ? "" : ", ") + words;
  }
  return row.conditions.empty() ? "in dlo " + command.get_name() : why;
}

bool is_of_scene(const IneffectiveOptions& row) {
  return std::any_of(
      row.conditions.begin(), row.conditions.end(),
      [](const OptionCondition& condition) { return condition.option == law_setting; });
}

}  // namespace

std::span<const IneffectiveOptions> ineffective_options() { return ineffective; }

void check_effects(const CLI::App& command, const compare::ForceModelSettings* settings) {
  for (const IneffectiveOptions& row : ineffective) {
    if (!row.command.empty() && row.command != command.get_name()) continue;
    // A notice is given only after the scene has been read, so that an error remains the only line.
    const bool at_scene = is_of_scene(row) || row.response == NoEffect::stated;
    if (at_scene != (settings != nullptr)) continue;
    Names named;
    for (const std::string& option : row.options) {
      if (is_given(command, option)) named.push_back(option);
    }
    const std::string why = named.empty() ? "" : why_no_effect(row, command, settings);
    if (why.empty()) continue;
    const bool is_format = named.front() == "--format";
    const std::string what =
        is_format ? fmt::format("--format {}: not available", value_of(command, "--format"))
                  : fmt::format("{}: no effect", fmt::join(named, ", "));
    const std::string message = fmt::format("{} {} (allowed: {})", what, why, row.allowed);
    if (row.response == NoEffect::refused) throw compare::InputError(message);
    say_line(message);
  }
}

}  // namespace dlo::cli
