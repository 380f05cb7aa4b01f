#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "base/number.hpp"
#include "decode/csv_rows.hpp"
#include "decode/xml.hpp"
#include "dlo/compare/error.hpp"
#include "toml/quantity.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

constexpr std::array<std::string_view, 5> marker_columns = {"time", "s", "x", "y", "z"};
constexpr const char* marker_columns_allowed = "(allowed: a header of time,s,x,y,z in any order)";
constexpr std::size_t most_positions = 1'000'000;

/// Returns the position of each of marker_columns among a file's columns.
std::array<std::size_t, 5> marker_columns_of(const std::vector<std::string_view>& header,
                                             const std::string& where) {
  std::array<std::size_t, 5> columns{};
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto found = std::ranges::find(header, marker_columns[k]);
    if (header.size() != columns.size() || found == header.end()) {
      throw InputError(fmt::format("{}: not the columns of a recorded motion {}", where,
                                   marker_columns_allowed));
    }
    columns[k] = static_cast<std::size_t>(found - header.begin());
  }
  return columns;
}

}  // namespace

MarkerMotion parse_markers(std::string_view text, const std::string& file) {
  refuse_archives(text, file);
  std::optional<std::array<std::size_t, 5>> columns;
  MarkerMotion result{.file = file, .positions = {}};
  for_each_csv_row(text, file, {}, [&](const CsvRow& row) {
    if (!columns) {
      columns = marker_columns_of(row.fields, row.where);
      return;
    }
    std::array<double, 5> values{};
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::optional<double> value = row.fields.size() == columns->size()
                                              ? as_number<double>(row.fields[(*columns)[k]])
                                              : std::nullopt;
      if (!value || !std::isfinite(*value)) {
        throw InputError(fmt::format("{}: {} is no number (allowed: five finite ones a row)",
                                     row.where, marker_columns[k]));
      }
      const std::string problem =
          magnitude_problem(*value, k == 0 ? Dimension::time : Dimension::length);
      if (!problem.empty()) {
        throw InputError(
            fmt::format("{}: {} = {:g}: {}", row.where, marker_columns[k], *value, problem));
      }
      values[k] = *value;
    }
    if (result.positions.size() == most_positions) {
      throw InputError(fmt::format("{}: more than {} rows", row.where, most_positions));
    }
    result.positions.push_back({values[0], values[1], {values[2], values[3], values[4]}});
  });
  if (result.positions.empty()) {
    throw InputError(fmt::format("{}: no rows {}", file, marker_columns_allowed));
  }
  const auto order = [](const MarkerPosition& at) { return std::tie(at.time, at.arc_length); };
  std::ranges::sort(result.positions, {}, order);
  const auto twice = std::ranges::adjacent_find(result.positions, {}, order);
  if (twice != result.positions.end()) {
    throw InputError(fmt::format("{}: the marker at s = {:g} m is twice at time = {:g} s", file,
                                 twice->arc_length, twice->time));
  }
  return result;
}

bool has_marker_columns(std::string_view text, const std::string& file) {
  std::optional<bool> found;
  for_each_csv_row(text, file, {}, [&](const CsvRow& row) {
    if (!found) found = std::ranges::find(row.fields, marker_columns.front()) != row.fields.end();
  });
  return found.value_or(false);
}

}  // namespace dlo::compare
