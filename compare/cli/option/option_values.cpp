#include "option/option_values.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {

CLI::Validator number_between(double low, double high) {
  const std::string range = fmt::format("{:g} - {:g}", low, high);
  const auto check = [low, high](std::string& text) {
    std::string problem = "out of range";
    try {
      const double value = compare::parse_quantity(text, compare::Dimension::number);
      if (value >= low && value <= high) return std::string();
    } catch (const compare::InputError& error) {
      problem = error.what();
    }
    return fmt::format("{}: {} (allowed: {:g} to {:g})", text, problem, low, high);
  };
  return {check, "FLOAT in [" + range + "]"};
}

void refuse_empty_values(CLI::App& app) {
  const auto not_empty = [](std::string& text) {
    return std::string(text.empty() ? "the value is empty (allowed: a value, or leave it out)"
                                    : "");
  };
  for (CLI::App* command : app.get_subcommands({})) {
    for (CLI::Option* option : command->get_options()) {
      // Transformations precede all checks; this one does not change the value.
      if (option->get_type_size() > 0) option->transform(CLI::Validator(not_empty, ""));
    }
  }
}

void require_values(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (word == "--") return;
    if (!word.starts_with("--") || word.find('=') != word.size() - 1) continue;
    throw compare::InputError(
        fmt::format("{}: the value is empty (allowed: a value, or leave it out)",
                    word.substr(0, word.size() - 1)));
  }
}

void add_program_options(CLI::App& command, std::vector<std::string>& programs) {
  command
      .add_option("--with", programs,
                  "somebody else's program beside our models: NAME='COMMAND', with {shape} for the "
                  "file that it writes, {scene} for the file that it reads (as dlo scene writes "
                  "it) and {points} for their number; may be given again")
      ->type_name("NAME=COMMAND")
      ->allow_extra_args(false);
}

}  // namespace dlo::cli
