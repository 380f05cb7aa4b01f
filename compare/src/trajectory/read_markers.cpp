#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>

#include "decode/csv_rows.hpp"
#include "decode/xml.hpp"
#include "dlo/compare/error.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

constexpr const char* marker_columns_allowed = "(allowed: a header of time,s,x,y,z in any order)";
constexpr std::size_t most_positions = 1'000'000;

}  // namespace

MarkerMotion parse_markers(std::string_view text, const std::string& file) {
  refuse_archives(text, file);
  std::optional<NumberColumns> columns;
  MarkerMotion result{.file = file, .positions = {}};
  for_each_csv_row(text, file, {}, [&](const CsvRow& row) {
    if (!columns) {
      const std::vector<std::string_view> names{"time", "s", "x", "y", "z"};
      columns.emplace(row, names, marker_columns_allowed);
      columns->require(names.size());
      return;
    }
    const std::vector<double> values = columns->numbers(row);
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

bool has_column(std::string_view text, std::string_view name) {
  bool found = false;
  for_each_csv_row(text, "", {.most_rows = 1}, [&](const CsvRow& row) {
    found = std::ranges::find(row.fields, name) != row.fields.end();
  });
  return found;
}

}  // namespace dlo::compare
