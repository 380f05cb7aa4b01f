#include "option/command_line.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "option/share.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {
namespace {

using compare::Json;

/// Returns the name by which a row is bound: "--output" for "-o,--output".
std::string name_of(const Json& row) {
  const std::string names = row.at("name");
  return names.substr(names.find(',') + 1, names.find('{') - names.find(',') - 1);
}

const Json* find_row(const Json& table, const std::string& name) {
  if (!table.contains("options")) return nullptr;
  const Json& rows = table.at("options");
  const auto row =
      std::ranges::find_if(rows, [&](const Json& one) { return name_of(one) == name; });
  return row == rows.end() ? nullptr : &*row;
}

/// Returns a part of the table of options as JSON.
Json json_of(const toml::node& node) {
  Json result;
  if (const toml::table* const table = node.as_table()) {
    for (const auto& [key, value] : *table) result[std::string(key.str())] = json_of(value);
  } else if (const toml::array* const array = node.as_array()) {
    for (const toml::node& value : *array) result.push_back(json_of(value));
  } else {
    node.visit([&result](const auto& value) {
      if constexpr (toml::is_string<decltype(value)> || toml::is_number<decltype(value)> ||
                    toml::is_boolean<decltype(value)>) {
        result = value.get();
      }
    });
  }
  return result;
}

/// Checks a number's range. @return the range in words
std::string add_range(CLI::Option& option, const Json& range, bool is_integer) {
  const double low = range.front();
  const double high =
      range.size() > 1 ? range.back().get<double>() : std::numeric_limits<double>::max();
  if (is_integer) {
    const auto first = static_cast<std::int64_t>(low);
    const auto last = static_cast<std::int64_t>(high);
    option.check(CLI::Range(first, last).description(""));
    return fmt::format("{} to {}", first, last);
  }
  option.check(number_between(low, high));
  return range.size() > 1 ? fmt::format("{:g} to {:g}", low, high) : fmt::format(">= {:g}", low);
}

std::string refuse_empty(std::string& text) {
  return text.empty() ? "the value is empty (allowed: a value, or leave it out)" : "";
}

constexpr std::size_t name_width = 28;
constexpr std::size_t command_width = 14;

/// Returns "  name      description" with the description wrapped.
std::string entry(const std::string& name, const std::string& description, std::size_t width) {
  std::string line = fmt::format("  {:<{}}", name, width - 2);
  if (name.size() + 3 > width) line = fmt::format("  {}\n{:{}}", name, "", width);
  return line + compare::wrap(description, width) + "\n";
}

/// Whether the option is a flag that may have a value, one of several, after "=".
bool takes_listed_value_after_equals(const CLI::Option& option) {
  return option.get_expected_min() == 0 && option.get_type_name().starts_with('{');
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    std::string text = app->get_description();
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    if (text.back() != '.') text += '.';
    return compare::wrap(text, 0) + "\n";
  }

  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = "\nUsage: " + name;
    if (!commands_of(*app).empty()) return usage + " COMMAND [OPTIONS]\n";
    for (const CLI::Option* argument : arguments_of(*app)) {
      usage += " " + make_option_usage(argument);
    }
    return usage + " [OPTIONS]\n";
  }

  std::string make_option(const CLI::Option* option, bool is_argument) const override {
    std::string name = fmt::format("{}", fmt::join(names_of(*option), ", "));
    const std::string value = option->get_type_name();
    if (!is_argument && takes_listed_value_after_equals(*option)) {
      name += "[=" + value + "]";
    } else if (!is_argument && option->get_type_size() > 0 && option->get_expected_min() > 0) {
      name += " " + value;
    }
    return entry(name, option->get_description(), name_width);
  }

  /// Omits the empty line with which CLI11 ends every group but the last.
  [[nodiscard]] std::string make_group(std::string group, bool is_argument,
                                       std::vector<const CLI::Option*> options) const override {
    std::string text = is_argument ? "\nArguments:\n" : group + ":\n";
    if (!is_argument && group == "Options") text.insert(0, "\n");
    for (const CLI::Option* option : options) text += make_option(option, is_argument);
    return text;
  }

  std::string make_subcommands(const CLI::App* app, CLI::AppFormatMode /*mode*/) const override {
    std::string text;
    std::string group;
    for (const CLI::App* command : commands_of(*app)) {
      if (command->get_group() != group) {
        group = command->get_group();
        text += "\n" + group + "\n";
      }
      text += entry(command->get_name(), command->get_description(), command_width);
    }
    return text;
  }
};

/// Returns a message for words that CLI11 did not expect: an unknown option such as --modle, or an
/// additional argument.
std::string unexpected(const CLI::App& command, const std::vector<std::string>& words) {
  const auto option = std::find_if(words.begin(), words.end(),
                                   [](const std::string& word) { return word.starts_with('-'); });
  const std::string& word = option != words.end() ? *option : words.front();
  std::vector<std::string> names;
  for (const CLI::Option* known : options_of(command)) {
    for (std::string& name : names_of(*known)) names.push_back(std::move(name));
  }
  const std::string written = word.substr(0, word.find('='));
  for (const CLI::Option* known : options_of(command)) {
    const std::string choices = known->get_type_name();
    const bool is_its_value =
        takes_listed_value_after_equals(*known) &&
        fmt::format(",{},", choices.substr(1, choices.size() - 2)).find("," + word + ",") !=
            std::string::npos;
    if (!is_its_value) continue;
    return fmt::format("{}: one argument too many: {}, did you mean {}={}? (see dlo {} --help)",
                       command.get_name(), word, names_of(*known).back(), word, command.get_name());
  }
  if (!written.starts_with('-')) {
    return fmt::format("{}: one argument too many: {} (see dlo {} --help)", command.get_name(),
                       word, command.get_name());
  }
  return fmt::format("{}: unknown option {}{} (dlo {} --help lists them)", command.get_name(),
                     written, compare::did_you_mean(written, names), command.get_name());
}

}  // namespace

const Json& option_table() {
  static const Json table = json_of(toml::parse(compare::builtin::options_toml));
  return table;
}

std::vector<std::string> expanded(const std::string& text) {
  std::vector<std::string> words;
  const Json& groups = option_table().at("groups");
  std::istringstream parts(text);
  for (std::string word; parts >> word;) {
    const std::vector<std::string> more =
        groups.contains(word) ? expanded(groups.at(word)) : std::vector{word};
    words.insert(words.end(), more.begin(), more.end());
  }
  return words;
}

CLI::Validator number_between(double low, double high) {
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
  return {check, ""};
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

Command::Command(CLI::App& app, const std::string& name)
    : app_(*app.add_subcommand(name, option_table().at(name).at("words"))),
      table_(option_table().at(name)),
      used_(expanded(table_.value("uses", ""))) {
  app_.group(table_.at("group"));
  app_.footer(table_.at("footer").get<std::string>());
}

CLI::Option* Command::add_function(const std::string& name,
                                   const std::function<void(const std::string&)>& set,
                                   const Names& choices, const std::string& meanings,
                                   const std::string& usual) {
  const Json* const row = find(name);
  if (row == nullptr) return nullptr;
  CLI::Option* const option = app_.add_option_function<std::string>(row->at("name"), set);
  option->default_str(usual);
  return describe(option, *row, false, row->value("choices", choices), meanings);
}

const Json* Command::find(const std::string& name) const {
  const Json* const own = find_row(table_, name);
  if (own != nullptr || std::ranges::find(used_, name) == used_.end()) return own;
  return find_row(option_table().at("common"), name);
}

CLI::Option* Command::describe(CLI::Option* option, const Json& row, bool is_integer,
                               const Names& choices, const std::string& meanings) {
  std::string words = row.value("words", "");
  if (row.contains("draws")) {
    words = fmt::format("draw {} into FILE.svg, FILE.png or FILE.pdf (by gnuplot)",
                        row.at("draws").get<std::string>());
    option->type_name("FILE");
  }
  if (const std::size_t braces = words.find("{}"); braces != std::string::npos) {
    words.replace(braces, 2,
                  meanings.empty() ? fmt::format("{}", fmt::join(choices, ", ")) : meanings);
  }
  if (!choices.empty()) {
    option->check(CLI::IsMember(choices).description(""));
    option->type_name(fmt::format("{{{}}}", fmt::join(choices, ",")));
  }
  if (row.contains("type")) option->type_name(row.at("type").get<std::string>());
  if (row.contains("share")) {
    const Json& most = row.at("share");
    option->transform(most.is_string() ? share_of_length() : share_up_to(most));
  }
  if (row.value("each", false)) option->allow_extra_args(false);
  if (row.contains("delimiter")) option->delimiter(row.at("delimiter").get<std::string>().front());
  if (row.contains("group")) option->group(row.at("group"));
  if (row.contains("default")) option->default_str(row.at("default"));
  option->required(row.value("required", false));
  std::string notes = row.contains("range") ? add_range(*option, row.at("range"), is_integer) : "";
  // Transformations precede all checks; this one does not change the value.
  if (option->get_type_size() > 0) option->transform(CLI::Validator(refuse_empty, ""));
  if (const std::string usual = option->get_default_str(); !usual.empty()) {
    notes += fmt::format("{}default: {}", notes.empty() ? "" : "; ", usual);
  }
  return option->description(notes.empty() ? words : fmt::format("{} [{}]", words, notes));
}

void Command::runs(const std::function<void()>& run) {
  Names names = used_;
  for (const Json& row : table_.value("options", Json::array())) names.push_back(name_of(row));
  for (const std::string& name : names) {
    CLI::Option* const option = app_.get_option_no_throw(name);
    if (option == nullptr) throw std::logic_error(app_.get_name() + ": " + name + " is not bound");
    const Json& row = *find(name);
    for (const std::string& other : row.value("needs", Names{}))
      option->needs(app_.get_option(other));
    for (const std::string& other : row.value("excludes", Names{})) {
      option->excludes(app_.get_option(other));
    }
  }
  app_.callback(run);
}

std::vector<std::string> names_of(const CLI::Option& option) {
  if (option.get_positional()) return {option.get_name(true)};
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) { return app.get_subcommands({}); }

std::vector<const CLI::Option*> arguments_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) {
    return option->nonpositional() && !option->get_group().empty();
  });
}

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

void require_known_command(const CLI::App& app, const std::string& written) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), written) != names.end()) return;
  throw compare::InputError(
      fmt::format("unknown command {}{} (allowed: {}; dlo without arguments describes them)",
                  written, compare::did_you_mean(written, names), fmt::join(names, ", ")));
}

void require_known_option(const CLI::App& app, const std::string& written) {
  std::vector<std::string> names;
  for (const CLI::Option* known : options_of(app)) {
    for (std::string& name : names_of(*known)) names.push_back(std::move(name));
  }
  const std::string name = written.substr(0, written.find('='));
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  throw compare::InputError(fmt::format("unknown option {}{} (allowed without a command: {})", name,
                                        compare::did_you_mean(name, names),
                                        fmt::join(names, ", ")));
}

std::string parse_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> chosen =
      app.get_subcommands([](const CLI::App* command) { return command->count() > 0; });
  if (chosen.empty()) return error.what();
  const CLI::App& command = *chosen.front();
  const std::vector<std::string> unexpected_words = app.remaining(true);
  // An unknown option explains the error better than an argument that is missing as its
  // consequence.
  const bool unknown_option =
      std::any_of(unexpected_words.begin(), unexpected_words.end(),
                  [](const std::string& word) { return word.starts_with('-'); });
  const bool too_many = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if (unknown_option || (too_many && !unexpected_words.empty())) {
    return unexpected(command, unexpected_words);
  }
  return fmt::format("{}: {} (see dlo {} --help)", command.get_name(), error.what(),
                     command.get_name());
}

}  // namespace dlo::cli
