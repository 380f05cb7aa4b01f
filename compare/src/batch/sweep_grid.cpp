#include "batch/sweep_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/number.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

constexpr std::int64_t most_rows = 1'000'000'000'000'000;

struct NumberWithUnit {
  double number = 0;
  std::string digits;  ///< the number as it is written in the text
  std::string unit;
};

/// Splits a text into a finite number and its unit, which is all that follows the number. Returns
/// std::nullopt if the text does not begin with a finite number. The scene's reader judges the
/// unit.
std::optional<NumberWithUnit> split_number(std::string_view text) {
  const auto [number, length, error] = leading_number<double>(text);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  NumberWithUnit result;
  result.number = number;
  result.digits = text.substr(0, length);
  result.unit = trimmed(text.substr(length));
  return result;
}

/// Splits a text at separators outside brackets.
std::vector<std::string> split_values(std::string_view text, char separator) {
  std::vector<std::string> parts;
  int depth = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && text[i] == '[') ++depth;
    if (i < text.size() && text[i] == ']') --depth;
    if (i < text.size() && (text[i] != separator || depth > 0)) continue;
    parts.emplace_back(trimmed(text.substr(begin, i - begin)));
    begin = i + 1;
  }
  return parts;
}

[[noreturn]] void refuse_axis(const std::string& text, const std::string& problem) {
  throw InputError(fmt::format(
      "--vary {}: {} (allowed: FIELD=a,b,c or FIELD=lin:a:b:n or FIELD=log:a:b:n)", text, problem));
}

std::int64_t read_count(const std::string& text, const std::string& digits) {
  const std::optional<std::int64_t> count = as_number<std::int64_t>(digits);
  if (!count || *count < 2 || *count > most_rows) {
    refuse_axis(text, fmt::format("\"{}\" is no number of values from 2 to 1e15", digits));
  }
  return *count;
}

void read_range(const std::string& text, const std::vector<std::string>& parts, Axis& axis) {
  if (parts.size() != 4) refuse_axis(text, "a range has three parts after its kind");
  axis.spacing = parts[0] == "lin" ? Spacing::linear : Spacing::logarithmic;
  const std::optional<NumberWithUnit> first = split_number(parts[1]);
  const std::optional<NumberWithUnit> last = split_number(parts[2]);
  if (!first || !last) {
    refuse_axis(text, fmt::format("\"{}\" is no finite number", first ? parts[2] : parts[1]));
  }
  if (first->unit != last->unit) {
    refuse_axis(text, fmt::format("the ends have different units, \"{}\" and \"{}\"", first->unit,
                                  last->unit));
  }
  if (first->number == last->number) refuse_axis(text, "both ends are the same");
  if (axis.spacing == Spacing::logarithmic && !(first->number * last->number > 0)) {
    refuse_axis(text, "the ends of a log range must both be positive, or both negative");
  }
  axis.first = first->number;
  axis.last = last->number;
  axis.unit = first->unit;
  axis.count = read_count(text, parts[3]);
}

void read_list(const std::string& text, const std::vector<std::string>& parts, Axis& axis) {
  std::vector<NumberWithUnit> numbers;
  for (const std::string& part : parts) {
    if (part.empty()) refuse_axis(text, "a value is empty");
    if (const auto number = split_number(part)) numbers.push_back(*number);
  }
  axis.values = parts;
  axis.count = static_cast<std::int64_t>(parts.size());
  const bool one_unit = numbers.size() == parts.size() && !numbers.front().unit.empty() &&
                        std::all_of(numbers.begin(), numbers.end(), [&](const auto& number) {
                          return number.unit == numbers.front().unit;
                        });
  if (!one_unit) return;
  axis.unit = numbers.front().unit;
  for (std::size_t i = 0; i < numbers.size(); ++i) axis.values[i] = numbers[i].digits;
}

bool contains(const std::string& outer, const std::string& inner) {
  return inner == outer || inner.compare(0, outer.size() + 1, outer + ".") == 0;
}

}  // namespace

std::string Axis::number(std::int64_t index) const {
  if (spacing == Spacing::list) return values[static_cast<std::size_t>(index)];
  if (index == 0) return fmt::format("{}", first);
  if (index == count - 1) return fmt::format("{}", last);
  const double share = static_cast<double>(index) / static_cast<double>(count - 1);
  const double inside = spacing == Spacing::linear ? first + share * (last - first)
                                                   : first * std::pow(last / first, share);
  return fmt::format("{:.12g}", inside + 0.0);  // no -0
}

std::string Axis::value(std::int64_t index) const {
  return unit.empty() ? number(index) : fmt::format("{} {}", number(index), unit);
}

std::string Axis::column() const {
  return unit.empty() ? field : fmt::format("{} [{}]", field, unit);
}

Axis parse_axis(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse_axis(text, "has no \"=\"");
  if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < ' '; })) {
    refuse_axis(text, "has a control character");
  }
  Axis axis;
  axis.field = trimmed(std::string_view(text).substr(0, equals));
  if (axis.field.empty()) refuse_axis(text, "has no field");
  const std::string values = text.substr(equals + 1);
  const std::vector<std::string> range = split_values(values, ':');
  if (range.front() == "lin" || range.front() == "log") {
    read_range(text, range, axis);
  } else {
    read_list(text, split_values(values, ','), axis);
  }
  return axis;
}

Grid::Grid(std::vector<Axis> axes) : axes_(std::move(axes)) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      if (i == k || !contains(axes_[i].field, axes_[k].field)) continue;
      throw InputError(
          fmt::format("--vary {}: {} varies it already (allowed: each field once, and none inside "
                      "another)",
                      axes_[k].field, axes_[i].field));
    }
    if (axes_[i].count > most_rows / size_) {
      throw InputError("--vary: too many combinations (allowed: 1e15)");
    }
    size_ *= axes_[i].count;
  }
}

std::vector<std::int64_t> Grid::indices(std::int64_t row) const {
  std::vector<std::int64_t> result(axes_.size());
  for (std::size_t i = axes_.size(); i-- > 0;) {
    result[i] = row % axes_[i].count;
    row /= axes_[i].count;
  }
  return result;
}

}  // namespace dlo::compare
