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

/// Returns a table of options.toml: a command, "common" or "groups".
[[nodiscard]] const compare::Json& option_table(const std::string& name);

/// Splits a text of the table into words, and replaces the name of each group of options by the
/// names of its options.
[[nodiscard]] std::vector<std::string> expand_option_groups(const std::string& text);

/// Refuses options that end with "=", because CLI11 would take the next word as their value.
/// @throws compare::InputError
void require_values(const std::vector<std::string>& words);

/// Type of the values of an option that is bound to a variable of type Value.
template <typename Value>
struct ElementOf {
  using type = Value;
};
template <typename Value>
struct ElementOf<std::optional<Value>> {
  using type = Value;
};
template <typename Value>
struct ElementOf<std::vector<Value>> {
  using type = Value;
};

/// A command, whose options are rows of the table; add() binds them to variables.
class Command {
 public:
  using Names = std::vector<std::string>;

  Command(CLI::App& app, const std::string& name);

  /// Binds an option or argument to a variable, whose value is the default. Does nothing and
  /// returns null if the command has no such row.
  /// @param choices  allowed texts unless the row has its own; an enumeration has its names
  template <typename Value>
  CLI::Option* add(const std::string& name, Value& value, Names choices = {}) {
    using Element = typename ElementOf<Value>::type;
    const compare::Json* const row = find(name);
    if (row == nullptr) return nullptr;
    const std::string names = row->at("name");
    std::string meanings;
    CLI::Option* option = nullptr;
    if constexpr (std::is_enum_v<Element>) {
      choices = compare::names<Element>();
      meanings = compare::meanings<Element>();
      if constexpr (requires { value.push_back(Element{}); }) {
        option = app_.add_option_function<Names>(names, [&value](const Names& given) {
          value.clear();
          for (const std::string& text : given) value.push_back(compare::from_name<Element>(text));
        });
      } else {
        option = app_.add_option_function<std::string>(names, [&value](const std::string& given) {
          value = compare::from_name<Element>(given);
        });
      }
      if constexpr (std::is_enum_v<Value>) option->default_str(compare::to_string(value));
    } else if constexpr (std::is_same_v<Value, bool>) {
      option = app_.add_flag(names, value);
    } else if (names.find('{') != std::string::npos) {
      if constexpr (std::is_same_v<Value, std::string>) option = app_.add_flag(names, value);
    } else {
      option = app_.add_option(names, value);
    }
    if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) {
      if (value != Value{}) option->capture_default_str();
    }
    return describe(option, *row, std::is_integral_v<Value>, row->value("choices", choices),
                    meanings);
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
  /// Returns the allowed values of an option; empty if they are not listed.
  [[nodiscard]] Names choices(const std::string& name) const {
    return find(name)->value("choices", Names{});
  }
  [[nodiscard]] CLI::App& app() { return app_; }

  /// Sets the function that the command runs, after all options have been added, and which options
  /// need or exclude others. @throws std::logic_error if a row is not bound
  void runs(const std::function<void()>& run);

 private:
  template <typename Value, typename... Rest>
  void bind_named(const char* name, Value& value, Rest&... rest) {
    add(name, value);
    if constexpr (sizeof...(Rest) > 0) bind(rest...);
  }
  /// Returns a row of the command, or of those that it uses; null if there is none.
  [[nodiscard]] const compare::Json* find(const std::string& name) const;
  static CLI::Option* describe(CLI::Option* option, const compare::Json& row, bool is_integer,
                               const Names& choices, const std::string& meanings);

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
  command->app().preparse_callback([command, options, run, bind](std::size_t /*words*/) {
    bind(*command, *options);
    command->runs([options, run] { run(*options); });
  });
}

/// Returns the options, without hidden ones, in the order in which they were added.
[[nodiscard]] std::vector<const CLI::Option*> options_of(const CLI::App& app);

/// Returns a formatter for help texts with 80 columns.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_formatter();

/// Checks the first word of a command line: a command, or an option that precedes any command.
/// @throws compare::InputError with the nearest word
void require_known_word(const CLI::App& app, const std::string& written);

/// Returns a message for an invalid command line, with the nearest option.
[[nodiscard]] std::string parse_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace dlo::cli
