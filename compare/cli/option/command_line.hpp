#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "record/field.hpp"

namespace dlo::compare::builtin {
extern const std::string_view options_toml;  ///< generated from options.toml
}

namespace dlo::cli {

/// Returns the commands and their options, as options.toml describes them.
[[nodiscard]] const compare::Json& option_table();

/// Returns the words of a text of the table; each name of several options is replaced by them.
[[nodiscard]] std::vector<std::string> expanded(const std::string& text);

/// Returns a check for numbers in [low, high]. NaN and infinity are refused.
[[nodiscard]] CLI::Validator number_between(double low, double high);

/// Refuses options that end with "=", because CLI11 would take the next word as their value.
/// @throws compare::InputError
void require_values(const std::vector<std::string>& words);

/// A command, whose options are rows of the table; add() binds them to variables.
class Command {
 public:
  Command(CLI::App& app, const std::string& name);

  /// Binds an option or argument to a variable, whose value is the default. Does nothing and
  /// returns null if the command has no such row.
  template <typename Value>
  CLI::Option* add(const std::string& name, Value& value) {
    if constexpr (std::is_enum_v<Value>) {
      const auto set = [&value](Value chosen) { value = chosen; };
      return add_choice<Value>(name, set, compare::to_string(value));
    } else {
      const compare::Json* const row = find(name);
      if (row == nullptr) return nullptr;
      const std::string names = row->at("name");
      CLI::Option* option = nullptr;
      if constexpr (std::is_same_v<Value, bool>) {
        option = app_.add_flag(names, value);
      } else if (names.find('{') != std::string::npos) {
        if constexpr (std::is_same_v<Value, std::string>) option = app_.add_flag(names, value);
      } else {
        option = app_.add_option(names, value);
      }
      if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) {
        if (value != Value{}) option->capture_default_str();
      }
      return describe(option, *row, std::is_integral_v<Value>, row->value("choices", Names{}));
    }
  }
  template <typename Value>
  requires std::is_enum_v<Value> CLI::Option* add(const std::string& name,
                                                  std::optional<Value>& value) {
    return add_choice<Value>(name, [&value](Value chosen) { value = chosen; });
  }
  /// Binds options in the order of the help: a name and a variable for each, or an object with the
  /// function add_to() for several.
  template <typename First, typename... Rest>
  void bind(First& first, Rest&... rest) {
    if constexpr (requires { first.add_to(*this); }) {
      first.add_to(*this);
      if constexpr (sizeof...(Rest) > 0) bind(rest...);
    } else {
      bind_named(first, rest...);
    }
  }
  /// Adds an option that calls a function with its value, one of an enumeration.
  template <typename Value>
  CLI::Option* add_choice(const std::string& name, const std::function<void(Value)>& set,
                          const std::string& usual = {}) {
    const auto set_name = [set](const std::string& text) { set(compare::from_name<Value>(text)); };
    return add_function(name, set_name, compare::names<Value>(), compare::meanings<Value>(), usual);
  }
  /// Adds an option that calls a function with its text.
  CLI::Option* add_function(const std::string& name,
                            const std::function<void(const std::string&)>& set,
                            const std::vector<std::string>& choices = {},
                            const std::string& meanings = {}, const std::string& usual = {});

  /// Returns the allowed values of an option; empty if they are not listed.
  [[nodiscard]] std::vector<std::string> choices(const std::string& name) const {
    return find(name)->value("choices", Names{});
  }
  [[nodiscard]] CLI::App& app() { return app_; }

  /// Sets a function that adds the options when the command is chosen.
  void prepares(const std::function<void()>& prepare) {
    app_.preparse_callback([prepare](std::size_t /*words*/) { prepare(); });
  }
  /// Sets the function that the command runs, after all options have been added.
  void runs(const std::function<void()>& run);

 private:
  using Names = std::vector<std::string>;

  template <typename Value, typename... Rest>
  void bind_named(const char* name, Value& value, Rest&... rest) {
    add(name, value);
    if constexpr (sizeof...(Rest) > 0) bind(rest...);
  }
  /// Returns a row of the command, or of those that it uses; null if there is none.
  [[nodiscard]] const compare::Json* find(const std::string& name) const;
  static CLI::Option* describe(CLI::Option* option, const compare::Json& row, bool is_integer,
                               const std::vector<std::string>& choices,
                               const std::string& meanings = {});

  CLI::App& app_;
  const compare::Json& table_;
  const Names used_;  ///< names of the rows of [common] that the command uses
};

/// Adds a command to the application, which runs it when it is chosen. Its options are not added
/// before that, since most commands of a call are not chosen.
/// @param run  gets the options;  @param bind  binds the rows of the command to them
template <typename Options, typename Bind>
void add_command(CLI::App& app, const std::string& name, void (*run)(const Options&),
                 const Bind& bind) {
  const auto options = std::make_shared<Options>();
  const auto command = std::make_shared<Command>(app, name);
  command->prepares([command, options, run, bind] {
    bind(*command, *options);
    command->runs([options, run] { run(*options); });
  });
}

/// Returns the names of an option, such as "-o" and "--output", or that of an argument.
[[nodiscard]] std::vector<std::string> names_of(const CLI::Option& option);

/// Return commands, arguments and options in the order in which they were added; options without
/// hidden ones.
[[nodiscard]] std::vector<const CLI::App*> commands_of(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> arguments_of(const CLI::App& app);
[[nodiscard]] std::vector<const CLI::Option*> options_of(const CLI::App& app);

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
