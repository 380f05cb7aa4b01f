#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "dlo/compare/force_model_settings.hpp"

namespace dlo::cli {

/// A condition on the value of an option.
struct OptionCondition {
  std::string option;  ///< long name of the option; "law": the law of the scene's force model
  /// Values for which the condition holds; empty: the option is not given; `any_value`: it is
  /// given.
  std::vector<std::string> values;
};
inline constexpr const char* any_value = "*";
/// Placeholder for every value that consists of digits alone.
inline constexpr const char* whole_number = "N";

enum class NoEffect { refused, stated };

/// Options of a command that have no effect if all conditions hold.
struct IneffectiveOptions {
  /// Long names. "--format" stands for its value, a format that the command cannot write then.
  std::vector<std::string> options;
  std::vector<OptionCondition> conditions;
  std::string allowed;
  NoEffect response = NoEffect::refused;
};

/// Returns the options of a table of options.toml that have no effect under some condition.
[[nodiscard]] std::vector<IneffectiveOptions> ineffective_options(const std::string& table);

/// Refuses or reports given options of a command that have no effect, before anything is computed.
/// @param settings  force model of the loaded scene: rows with a condition on "law" and rows that
///                  are stated are checked; null: all other rows are
/// @throws compare::InputError with the options, the conditions and what is allowed
void check_effects(const CLI::App& command, const compare::ForceModelSettings* settings = nullptr);

}  // namespace dlo::cli
