#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/text.hpp"

namespace dlo::cli {

/// Texts of an option or argument, for the help and for checks of outputs.
struct OptionText {
  std::vector<std::string> names;  ///< "--points", or "SCENE" for an argument
  std::string value;               ///< "FILE", "INT"; empty for a flag
  std::vector<std::string> choices;
  std::string range;  ///< "4 to 1000000"
  std::string default_value;
  std::string description;
  bool optional_value = false;  ///< flag that takes a value after "="

  /// Returns "FILE", "{text,json,csv}" or an empty string.
  [[nodiscard]] std::string value_text() const;
  /// Returns description, range and default.
  [[nodiscard]] std::string full_description() const;
};

[[nodiscard]] OptionText option_text(const CLI::Option& option);

/// Return commands, arguments and options in the order in which they were added; options without
/// hidden ones.
[[nodiscard]] std::vector<const CLI::App*> commands_of(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> arguments_of(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> options_of(const CLI::App& app);

using compare::wrap;

/// Returns a formatter for help texts with 80 columns.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter();

/// Checks the first word of a command line. @throws compare::InputError with the nearest command
void require_known_command(const CLI::App& app, const std::string& written);

/// Checks an option that precedes any command.
/// @throws compare::InputError with the nearest option
void require_known_option(const CLI::App& app, const std::string& written);

/// Returns a message for an invalid command line, with the nearest option.
[[nodiscard]] std::string parse_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace dlo::cli
