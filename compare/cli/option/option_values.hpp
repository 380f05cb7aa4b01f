#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace dlo::cli {

/// While an object of this class exists, options that are added to the command are in a group of
/// the help.
class OptionGroup {
 public:
  OptionGroup(CLI::App& command, const std::string& name)
      : defaults_(*command.option_defaults()), before_(defaults_.get_group()) {
    defaults_.group(name);
  }
  // CLI11 refuses names with newlines; this one was already the name of a group.
  ~OptionGroup() { defaults_.group(before_); }  // NOLINT(bugprone-exception-escape)
  OptionGroup(const OptionGroup&) = delete;
  OptionGroup& operator=(const OptionGroup&) = delete;

 private:
  CLI::OptionDefaults& defaults_;
  std::string before_;
};

/// Returns a check for numbers in [low, high]. NaN and infinity are refused.
[[nodiscard]] CLI::Validator number_between(double low, double high);

/// Adds an option whose default is part of the help.
template <typename Value>
CLI::Option* add_checked(CLI::App& command, const std::string& name, Value& value,
                         const CLI::Validator& check, const std::string& words) {
  return command.add_option(name, value, words)->check(check)->capture_default_str();
}

/// Adds an option that names files.
template <typename Value>
CLI::Option* add_file(CLI::App& command, const std::string& name, Value& value,
                      const std::string& words) {
  return command.add_option(name, value, words)->type_name("FILE");
}

/// Makes all commands refuse empty values of options and arguments, which result from unset
/// variables in scripts. Must be called after all options have been added.
void refuse_empty_values(CLI::App& app);

/// Refuses options that end with "=", because CLI11 would take the next word as their value.
/// @throws compare::InputError
void require_values(const std::vector<std::string>& words);

/// Adds --with NAME=COMMAND, which may be repeated; compare::parse_foreign_programs() reads them.
void add_program_options(CLI::App& command, std::vector<std::string>& programs);

}  // namespace dlo::cli
