#include "option/effect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/error.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

using Names = std::vector<std::string>;

const std::string law_setting = "law";

/// Names for several options in the table.
constexpr std::pair<std::string_view, std::string_view> option_groups[] = {
    {"FORCE",
     "--parameters --points --law --bookkeeping --stepper --bending-rule --design-curvature --c-b "
     "--c-c --c-F --c-h --l-s"},
    {"LIMITS", "--max-steps --rest-tolerance"},
    {"CONSTANTS", "--stepper --c-F --c-h --l-s"}};

constexpr const char* fits_force = "a fit of the force model: no --shape, --motion, --segments";
constexpr const char* writes_plan = "--explain, --format json";

/// IneffectiveOptions as words that are separated by blanks.
struct Row {
  std::string_view command, options;
  /// "--x": it is given; "!--x": it is not; "--x=a,b": it has one of these values.
  std::string_view conditions;
  std::string allowed;
  NoEffect response = NoEffect::refused;
};

const Row table[] = {
    {"", "--design-curvature --bending-rule", "law=hooke", "--law paper"},
    {"calibrate", "--register --arc-lengths", "!--shape", "--shape FILE"},
    {"calibrate", "--unit", "!--shape !--segments", "--shape FILE, --segments FILE"},
    {"calibrate", "--unit", "!--shape --segments=N", "--shape FILE, --segments FILE"},
    {"calibrate", "--segments", "--motion", "no --motion"},
    {"calibrate", "FORCE LIMITS", "--shape", fits_force},
    {"calibrate", "FORCE LIMITS", "--motion", fits_force},
    {"calibrate", "FORCE LIMITS", "--segments", fits_force},
    {"calibrate", "--bending-rule --c-F --c-h --l-s", "",
     "other options of the force model; calibrate finds these"},
    {"calibrate", "--format", "--format=csv --motion", "text, json, toml"},
    {"calibrate", "--format", "--format=csv,toml --segments !--shape", "text, json"},
    {"check", "--format", "--format=markdown --motion", "text, json, csv"},
    {"compare", "--target-error", "!--explain --format=text,csv", writes_plan},
    {"solve", "--format", "--format=csv,vtk --all", "text, json"},
    {"solve", "--format", "--format=csv,vtk --explain", "text, json"},
    {"solve", "--target-error", "--model=chain,force !--explain --format=text,csv,vtk",
     std::string(writes_plan) + ", --model energy, exact"},
    {"solve", "FORCE", "--model=energy,exact !--explain --format=text,csv,vtk",
     std::string(writes_plan) + ", --model chain, force", NoEffect::stated},
    {"solve", "LIMITS", "--model=energy,exact,chain", "--model force", NoEffect::stated},
    {"solve", "--terms", "--model=exact,chain,force", "--model energy", NoEffect::stated},
    {"solve", "CONSTANTS", "--model=chain", "--model force", NoEffect::stated},
    {"regress", "CONSTANTS LIMITS", "--model=chain", "--model force"},
    {"sweep", "LIMITS", "--model=energy,exact,chain,compare-chain", "--model force, compare"},
    {"sweep", "--terms", "--model=exact,chain,force", "--model energy, compare, compare-chain"},
    {"track", "FORCE LIMITS --step-rate", "--no-force", "no --no-force"},
    {"track", "--shapes", "--format=text,csv", "--format json"},
    {"track", "--every", "--format=text !--paraview", "--format json, csv, --paraview FILE"},
    {"modes", "--samples", "--format=text,csv", "--format json"},
    {"stability", "--case --stepper --max-steps --max-steps-auto --steps-at-rest", "--map",
     "no --map"},
    {"stability", "SCENE --columns --rows --map-steps", "!--map", "--map cF-cc, cF-ch"},
    {"bench", "--time-limit", "!--with", "--with NAME=COMMAND"},
    {"suite", "--points --time-limit --state --baseline --markdown --junit --report --output",
     "!--with", "--with NAME=COMMAND"},
    {"suite", "--relative --absolute", "!--baseline", "--baseline FILE"}};

/// Returns the words of a text, each group replaced by its options.
Names split_words(std::string_view text) {
  Names words;
  for (const std::string& word : CLI::detail::split(std::string(text), ' ')) {
    const auto* const group =
        std::ranges::find(option_groups, word, [](const auto& one) { return one.first; });
    if (group == std::end(option_groups)) {
      if (!word.empty()) words.push_back(word);
      continue;
    }
    const Names options = split_words(group->second);
    words.insert(words.end(), options.begin(), options.end());
  }
  return words;
}

OptionCondition condition_of(const std::string& word) {
  if (word.front() == '!') return {word.substr(1), {}};
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) return {word, {any_value}};
  return {word.substr(0, equals), CLI::detail::split(word.substr(equals + 1), ',')};
}

std::vector<IneffectiveOptions> rows_of_table() {
  std::vector<IneffectiveOptions> rows;
  for (const Row& row : table) {
    IneffectiveOptions& made = rows.emplace_back(IneffectiveOptions{
        std::string(row.command), split_words(row.options), {}, row.allowed, row.response});
    for (const std::string& word : split_words(row.conditions)) {
      made.conditions.push_back(condition_of(word));
    }
  }
  return rows;
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
std::string words_of(const OptionCondition& condition, const CLI::App& command,
                     const compare::ForceModelSettings* settings) {
  const auto contains = [&](const std::string& value) {
    return std::find(condition.values.begin(), condition.values.end(), value) !=
           condition.values.end();
  };
  const bool is_law = condition.option == law_setting;
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
std::string why_no_effect(const IneffectiveOptions& row, const CLI::App& command,
                          const compare::ForceModelSettings* settings) {
  std::string why;
  for (const OptionCondition& condition : row.conditions) {
    const std::string words = words_of(condition, command, settings);
    if (words.empty()) return "";
    if (row.options.front() == condition.option) continue;
    why += (why.empty() ? "" : ", ") + words;
  }
  return row.conditions.empty() ? "in dlo " + command.get_name() : why;
}

bool is_of_scene(const IneffectiveOptions& row) {
  return std::any_of(
      row.conditions.begin(), row.conditions.end(),
      [](const OptionCondition& condition) { return condition.option == law_setting; });
}

}  // namespace

std::span<const IneffectiveOptions> ineffective_options() {
  static const std::vector<IneffectiveOptions> rows = rows_of_table();
  return rows;
}

void check_effects(const CLI::App& command, const compare::ForceModelSettings* settings) {
  for (const IneffectiveOptions& row : ineffective_options()) {
    if (!row.command.empty() && row.command != command.get_name()) continue;
    // A notice is given only after the scene has been read, so that an error remains the only line.
    const bool at_scene = is_of_scene(row) || row.response == NoEffect::stated;
    if (at_scene != (settings != nullptr)) continue;
    Names named;
    for (const std::string& option : row.options) {
      if (is_given(command, option)) named.push_back(option);
    }
    const std::string why = named.empty() ? "" : why_no_effect(row, command, settings);
    if (why.empty()) continue;
    const bool is_format = named.front() == "--format";
    const std::string what =
        is_format ? fmt::format("--format {}: not available", value_of(command, "--format"))
                  : fmt::format("{}: no effect", fmt::join(named, ", "));
    const std::string message = fmt::format("{} {} (allowed: {})", what, why, row.allowed);
    if (row.response == NoEffect::refused) throw compare::InputError(message);
    say_line(message);
  }
}

}  // namespace dlo::cli
