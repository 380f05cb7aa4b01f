#include "option/help.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::cli {
namespace {

constexpr std::size_t name_width = 28;
constexpr std::size_t command_width = 14;

/// Reads CLI11's type name, which is TYPE, followed by :VALIDATOR for each validator. The
/// validators in use are {a,b,c} and "TYPE in [low - high]".
void read_type(const std::string& type, OptionText& text) {
  std::istringstream parts(type);
  std::getline(parts, text.value, ':');
  for (std::string part; std::getline(parts, part, ':');) {
    const std::size_t range = part.find(" in [");
    if (part.starts_with('{')) {
      text.choices = CLI::detail::split(part.substr(1, part.size() - 2), ',');
    } else if (range != std::string::npos) {
      const std::string limits = part.substr(range + 5, part.size() - range - 6);
      const std::size_t dash = limits.find(" - ");
      // The largest double means that every finite number is allowed.
      const std::string largest = fmt::format("{:g}", std::numeric_limits<double>::max());
      const std::string low = limits.substr(0, dash);
      const std::string high = limits.substr(dash + 3);
      if (high != largest) {
        text.range = fmt::format("{} to {}", low, high);
      } else if (low != "-" + largest) {
        text.range = ">= " + low;
      }
    }
  }
}

/// Returns "  name      description" with the description wrapped.
std::string entry(const std::string& name, const std::string& description, std::size_t width) {
  std::string line = fmt::format("  {:<{}}", name, width - 2);
  if (name.size() + 3 > width) line = fmt::format("  {}\n{:{}}", name, "", width);
  return line + wrap(description, width) + "\n";
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    std::string text = app->get_description();
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    if (text.back() != '.') text += '.';
    return wrap(text, 0) + "\n";
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
    const OptionText text = option_text(*option);
    std::string name;
    if (is_argument) {
      name = text.names.front();
    } else {
      name = fmt::format("{}", fmt::join(text.names, ", "));
      const std::string value = text.value_text();
      if (!value.empty()) name += text.optional_value ? "[=" + value + "]" : " " + value;
    }
    return entry(name, text.full_description(), name_width);
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
    for (std::string& name : option_text(*known).names) names.push_back(std::move(name));
  }
  const std::string written = word.substr(0, word.find('='));
  for (const CLI::Option* known : options_of(command)) {
    const OptionText text = option_text(*known);
    // Such a flag takes its value only after "=".
    const bool is_its_value =
        text.optional_value &&
        std::find(text.choices.begin(), text.choices.end(), word) != text.choices.end();
    if (!is_its_value) continue;
    return fmt::format("{}: one argument too many: {}, did you mean {}={}? (see dlo {} --help)",
                       command.get_name(), word, text.names.back(), word, command.get_name());
  }
  if (!written.starts_with('-')) {
    return fmt::format("{}: one argument too many: {} (see dlo {} --help)", command.get_name(),
                       word, command.get_name());
  }
  return fmt::format("{}: unknown option {}{} (dlo {} --help lists them)", command.get_name(),
                     written, compare::did_you_mean(written, names), command.get_name());
}

}  // namespace

std::string OptionText::value_text() const {
  return choices.empty() ? value : fmt::format("{{{}}}", fmt::join(choices, ","));
}

std::string OptionText::full_description() const {
  std::string notes;
  const auto add = [&](const std::string& note) { notes += (notes.empty() ? "" : "; ") + note; };
  if (!range.empty()) add(range);
  if (!default_value.empty()) add("default: " + default_value);
  return notes.empty() ? description : fmt::format("{} [{}]", description, notes);
}

OptionText option_text(const CLI::Option& option) {
  OptionText text;
  if (option.get_positional()) {
    text.names = {option.get_name(true)};
  } else {
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  }
  read_type(option.get_type_name(), text);
  text.optional_value = option.get_expected_min() == 0 && !text.choices.empty();
  if (option.get_type_size() == 0 || (option.get_expected_min() == 0 && text.choices.empty())) {
    text.value.clear();
  }
  text.default_value = option.get_default_str();
  text.description = option.get_description();
  return text;
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
      fmt::format("unknown command {}{} (allowed: {}; dlo alone says what each is for)", written,
                  compare::did_you_mean(written, names), fmt::join(names, ", ")));
}

void require_known_option(const CLI::App& app, const std::string& written) {
  std::vector<std::string> names;
  for (const CLI::Option* known : options_of(app)) {
    for (std::string& name : option_text(*known).names) names.push_back(std::move(name));
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
