#include "option/command_line.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
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

/// Returns the names of an option, such as "-o" and "--output", or that of an argument.
std::vector<std::string> names_of(const CLI::Option& option) {
  if (option.get_positional()) return {option.get_name(true)};
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// Returns the commands in the order in which they were added.
std::vector<const CLI::App*> commands_of(const CLI::App& app) { return app.get_subcommands({}); }

/// Returns the arguments in the order in which they were added.
std::vector<const CLI::Option*> arguments_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

/// Returns a check that replaces the text of a number by its digits.
/// @param read  may throw compare::InputError;  @param allowed  numbers for which `holds`, in words
CLI::Validator number_check(std::function<double(const std::string&)> read,
                            std::function<bool(double)> holds, std::string allowed) {
  return {[read = std::move(read), holds = std::move(holds),
           allowed = std::move(allowed)](std::string& text) {
            std::string problem = "out of range";
            try {
              const double value = read(text);
              if (holds(value)) {
                text = fmt::format("{:.17g}", value);
                return std::string();
              }
            } catch (const compare::UnitError& error) {
              return fmt::format("{}: {}", text, error.what());
            } catch (const compare::InputError& error) {
              problem = error.what();
            }
            return fmt::format("{}: {} (allowed: {})", text, problem, allowed);
          },
          ""};
}

/// Reads a quantity with a unit of its dimension. @param plain  whether a number in SI units will
/// do
double read_quantity(const std::string& text, compare::Dimension dimension, bool plain) {
  try {
    if (plain) return compare::parse_quantity(text, compare::Dimension::number);
  } catch (const compare::InputError&) {
    return compare::parse_quantity(text, dimension);
  }
  return compare::parse_quantity(text, dimension);
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
  option.transform(number_check(
      [](const std::string& text) {
        return read_quantity(text, compare::Dimension::number, false);
      },
      [low, high](double value) { return value >= low && value <= high; },
      fmt::format("{:g} to {:g}", low, high)));
  return range.size() > 1 ? fmt::format("{:g} to {:g}", low, high) : fmt::format(">= {:g}", low);
}

/// Reads a share of the rod's length, or one up to `most`.
void add_share(CLI::Option& option, const Json& most) {
  if (most.is_string()) {
    option.transform(number_check(
        parse_fraction, [](double share) { return share > 0 && share < 1; },
        "a share of the length such as 0.1% or 0.001, > 0, < 1"));
    return;
  }
  const double high = most;
  option.transform(number_check(
      parse_fraction, [high](double share) { return share >= 0 && share <= high; },
      fmt::format("a share such as 1% or 0.01, 0 to {:g}", high)));
}

/// Reads a quantity > 0, or from 0 to below a limit.
void add_quantity(CLI::Option& option, const Json& row) {
  const auto dimension = compare::dimension_named(row.at("quantity").get<std::string>()).value();
  const double below = row.value("below", std::numeric_limits<double>::infinity());
  const bool limited = std::isfinite(below);
  option.type_name("VALUE");
  option.transform(number_check(
      [dimension, plain = row.value("plain", false)](const std::string& text) {
        return read_quantity(text, dimension, plain);
      },
      [below, limited](double value) {
        return (limited ? value >= 0 : value > 0) && value < below;
      },
      limited ? fmt::format("0 <= value < {}", below) : "> 0"));
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

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* known : options_of(app)) {
    for (std::string& name : names_of(*known)) names.push_back(std::move(name));
  }
  return names;
}

/// Returns a message for words that CLI11 did not expect: an unknown option such as --modle, or an
/// additional argument.
std::string unexpected(const CLI::App& command, const std::vector<std::string>& words) {
  const auto option =
      std::ranges::find_if(words, [](const std::string& word) { return word.starts_with('-'); });
  const std::string& word = option != words.end() ? *option : words.front();
  const std::vector<std::string> names = option_names(command);
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

const Json& option_table(const std::string& name) {
  static std::map<std::string, Json, std::less<>> tables;
  const auto known = tables.find(name);
  if (known != tables.end()) return known->second;
  // Only this table is parsed. It ends before the next one, but includes its arrays of tables.
  const std::string_view text = compare::builtin::options_toml;
  const std::size_t begin = text.find(fmt::format("\n[{}]\n", name));
  std::size_t end = begin;
  do {
    end = std::min(text.find("\n[", end + 1), text.size());
  } while (text.substr(end).starts_with(fmt::format("\n[[{}.", name)));
  const toml::table parsed = toml::parse(text.substr(begin, end - begin));
  std::ostringstream json;
  json << toml::json_formatter(*parsed.get(name));
  return tables.emplace(name, Json::parse(json.str())).first->second;
}

std::vector<std::string> expand_option_groups(const std::string& text) {
  std::vector<std::string> words;
  const Json& groups = option_table("groups");
  std::istringstream parts(text);
  for (std::string word; parts >> word;) {
    const std::vector<std::string> more =
        groups.contains(word) ? expand_option_groups(groups.at(word)) : std::vector{word};
    words.insert(words.end(), more.begin(), more.end());
  }
  return words;
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
    : app_(*app.add_subcommand(name, option_table(name).at("words"))),
      table_(option_table(name)),
      used_(expand_option_groups(table_.value("uses", ""))) {
  app_.group(table_.at("group"));
  app_.footer(table_.at("footer").get<std::string>());
}

const Json* Command::find(const std::string& name) const {
  const Json* const entry = find_row(table_, name);
  if (entry != nullptr || std::ranges::find(used_, name) == used_.end()) return entry;
  return find_row(option_table("common"), name);
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
  if (row.contains("share")) add_share(*option, row.at("share"));
  if (row.contains("quantity")) add_quantity(*option, row);
  if (row.value("each", false)) option->allow_extra_args(false);
  if (row.contains("delimiter")) option->delimiter(row.at("delimiter").get<std::string>().front());
  if (row.contains("group")) option->group(row.at("group"));
  if (row.contains("default")) option->default_str(row.at("default"));
  option->required(row.value("required", false));
  std::string notes = row.contains("range") ? add_range(*option, row.at("range"), is_integer) : "";
  // Transformations precede all checks; this one does not change the value.
  if (option->get_type_size() > 0) option->transform(CLI::Validator(refuse_empty, ""));
  if (const std::string default_value = option->get_default_str(); !default_value.empty()) {
    notes += fmt::format("{}default: {}", notes.empty() ? "" : "; ", default_value);
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

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) {
    return option->nonpositional() && !option->get_group().empty();
  });
}

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

void require_known_word(const CLI::App& app, const std::string& written) {
  const std::string name = written.substr(0, written.find('='));
  const bool is_option = name.starts_with('-');
  std::vector<std::string> names;
  if (is_option) {
    names = option_names(app);
  } else {
    for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  }
  if (std::ranges::find(names, name) != names.end()) return;
  throw compare::InputError(fmt::format(
      "unknown {} {}{} (allowed{}: {}{})", is_option ? "option" : "command", name,
      compare::did_you_mean(name, names), is_option ? " without a command" : "",
      fmt::join(names, ", "), is_option ? "" : "; dlo without arguments describes them"));
}

std::string parse_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> chosen =
      app.get_subcommands([](const CLI::App* command) { return command->count() > 0; });
  if (chosen.empty()) return error.what();
  const CLI::App& command = *chosen.front();
  const std::vector<std::string> unexpected_words = app.remaining(true);
  // An unknown option explains the error better than an argument that is missing as its
  // consequence.
  const bool unknown_option = std::ranges::any_of(
      unexpected_words, [](const std::string& word) { return word.starts_with('-'); });
  const bool too_many = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  if (unknown_option || (too_many && !unexpected_words.empty())) {
    return unexpected(command, unexpected_words);
  }
  return fmt::format("{}: {} (see dlo {} --help)", command.get_name(), error.what(),
                     command.get_name());
}

}  // namespace dlo::cli
