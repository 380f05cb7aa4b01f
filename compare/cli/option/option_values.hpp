#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dlo::cli {

/// While it lives, options that a command gets are in a group of its help.
class OptionGroup {
 public:
  OptionGroup(CLI::App& command, const std::string& name)
      : defaults_(*command.option_defaults()), before_(defaults_.get_group()) {
    defaults_.group(name);
  }
  // CLI11 refuses names with newlines, and this one was a group's.
  ~OptionGroup() { defaults_.group(before_); }  // NOLINT(bugprone-exception-escape)
  OptionGroup(const OptionGroup&) = delete;
  OptionGroup& operator=(const OptionGroup&) = delete;

 private:
  CLI::OptionDefaults& defaults_;
  std::string before_;
};

/// For an option that takes a number: in [low, high], so neither NaN nor, unless `high` is,
/// infinite.
[[nodiscard]] CLI::Validator number_between(double low, double high);

/// Of all commands, lets no option and no argument take an empty value, which a variable that is
/// not set leaves in a script. Call when all options are there.
void refuse_empty_values(CLI::App& app);

/// The same of an option that ends with "=", behind which CLI11 would take the next word.
/// @throws compare::InputError
void require_values(const std::vector<std::string>& words);

/// --with NAME=COMMAND, which may be given again; compare::parse_foreign_programs() takes them.
void add_program_options(CLI::App& command, std::vector<std::string>& programs);

}  // namespace dlo::cli
