#include "option/effect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/error.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

using Names = std::vector<std::string>;

const std::string law_option = "law";

OptionCondition condition_of(const std::string& word) {
  if (word.front() == '!') return {word.substr(1), {}};
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) return {word, {any_value}};
  return {word.substr(0, equals), CLI::detail::split(word.substr(equals + 1), ',')};
}

/// Returns the value of an option or its default; for --format also the output file's extension.
std::string value_of(const CLI::App& command, const std::string& name) {
  const CLI::Option* const option = command.get_option_no_throw(name);
  if (option == nullptr) return "";
  if (option->count() > 0) return option->results().back();
  // A default that depends on the scene is followed by a comma and the alternative.
  const std::string value = option->get_default_str();
  return value.substr(0, value.find(','));
}

bool is_given(const CLI::App& command, const std::string& name) {
  const CLI::Option* const option = command.get_option_no_throw(name);
  return option != nullptr && (option->count() > 0 || name == "--format");
}

/// Returns the condition in words, such as "with --model chain" or "without --shape"; empty if it
/// does not hold.
std::string condition_text(const OptionCondition& condition, const CLI::App& command,
                           const compare::ForceModelSettings* settings) {
  const auto contains = [&](const std::string& value) {
    return std::ranges::find(condition.values, value) != condition.values.end();
  };
  const bool is_law = condition.option == law_option;
  if (!is_law && condition.values.empty()) {
    return is_given(command, condition.option) ? "" : "without " + condition.option;
  }
  const std::string value =
      is_law ? compare::to_string(settings->law) : value_of(command, condition.option);
  if (contains(any_value)) {
    return is_given(command, condition.option) ? "with " + condition.option : "";
  }
  const bool is_number =
      !value.empty() && value.find_first_not_of("0123456789") == std::string::npos;
  if (!contains(value) && !(is_number && contains(whole_number))) return "";
  return fmt::format("with {} {}", condition.option, value);
}

/// Returns the reason why the options of a row have no effect; empty if they have one.
std::string no_effect_reason(const IneffectiveOptions& row, const CLI::App& command,
                             const compare::ForceModelSettings* settings) {
  std::string why;
  for (const OptionCondition& condition : row.conditions) {
    const std::string words = condition_text(condition, command, settings);
    if (words.empty()) return "";
    if (row.options.front() == condition.option) continue;
    why += (why.empty() ? "" : ", ") + words;
  }
  return row.conditions.empty() ? "in dlo " + command.get_name() : why;
}

bool depends_on_law(const IneffectiveOptions& row) {
  return std::ranges::find(row.conditions, law_option, &OptionCondition::option) !=
         row.conditions.end();
}

}  // namespace

std::vector<IneffectiveOptions> ineffective_options(const std::string& table) {
  std::vector<IneffectiveOptions> rows;
  for (const compare::Json& row :
       option_table(table).value("ineffective", compare::Json::array())) {
    IneffectiveOptions& made = rows.emplace_back(
        IneffectiveOptions{expand_option_groups(row.at("options")),
                           {},
                           row.at("allowed"),
                           row.value("stated", false) ? NoEffect::stated : NoEffect::refused});
    for (const std::string& word : expand_option_groups(row.value("when", ""))) {
      made.conditions.push_back(condition_of(word));
    }
  }
  return rows;
}

void check_effects(const CLI::App& command, const compare::ForceModelSettings* settings) {
  std::vector<IneffectiveOptions> rows = ineffective_options(command.get_name());
  for (IneffectiveOptions& row : ineffective_options("common")) rows.push_back(std::move(row));
  for (const IneffectiveOptions& row : rows) {
    // A notice is given only after the scene has been read, so that an error remains the only line.
    const bool at_scene = depends_on_law(row) || row.response == NoEffect::stated;
    if (at_scene != (settings != nullptr)) continue;
    Names named;
    for (const std::string& option : row.options) {
      if (is_given(command, option)) named.push_back(option);
    }
    const std::string why = named.empty() ? "" : no_effect_reason(row, command, settings);
    if (why.empty()) continue;
    const bool is_format = named.front() == "--format";
    const std::string what =
        is_format ? fmt::format("--format {}: not available", value_of(command, "--format"))
                  : fmt::format("{}: no effect", fmt::join(named, ", "));
    const std::string message = fmt::format("{} {} (allowed: {})", what, why, row.allowed);
    if (row.response == NoEffect::refused) throw compare::InputError(message);
    print_message_line(message);
  }
}

}  // namespace dlo::cli
