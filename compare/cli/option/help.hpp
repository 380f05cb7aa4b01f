#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/text.hpp"

namespace dlo::cli {

/// The texts of an option or argument, for the help and for checks of outputs.
struct OptionText {
  std::vector<std::string> names;  ///< "--points", or "SCENE" of an argument
  std::string value;               ///< "FILE", "INT"; empty for a flag
  std::vector<std::string> choices;
  std::string range;  ///< "4 to 1000000"
  std::string default_value;
  std::string description;
  bool optional_value = false;  ///< a flag that takes a value behind "="

  /// "FILE", "{text,json,csv}" or nothing.
  [[nodiscard]] std::string value_text() const;
  /// Description, range and default.
  [[nodiscard]] std::string full_description() const;
};

[[nodiscard]] OptionText option_text(const CLI::Option& option);

/// Commands, arguments and options in the order in which they were added; hidden ones left out.
[[nodiscard]] std::vector<const CLI::App*> commands_of(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> arguments_of(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> options_of(const CLI::App& app);

using compare::wrap;

/// Help in 80 columns.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter();

/// @throws compare::InputError with the nearest command
void require_known_command(const CLI::App& app, const std::string& written);

/// Of a word that begins with "-" and stands before any command.
/// @throws compare::InputError with the nearest option
void require_known_option(const CLI::App& app, const std::string& written);

/// What is wrong with a command line, with the nearest option.
[[nodiscard]] std::string parse_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace dlo::cli
