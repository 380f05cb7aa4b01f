#include "picture/sweep_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

constexpr std::size_t most_lines = 6;  // as many as curves have looks

bool is_numeric(const SweptField& field) {
  return std::all_of(field.values.begin(), field.values.end(),
                     [](const std::string& value) { return as_number<double>(value).has_value(); });
}

/// Columns of the header, counted from 1 as gnuplot does; names have no commas.
int column_of(const std::string& header, const std::string& name) {
  int column = 1;
  for (std::size_t at = 0; at < header.size(); ++column) {
    const std::size_t end = std::min(header.find_first_of(",\n", at), header.size());
    if (header.substr(at, end - at) == name) return column;
    at = end + 1;
  }
  throw InputError(fmt::format("--plot: the sweep has no column {}", name));
}

/// Data of one value of the second field, whose rows are every `count`-th.
std::string line_of(const std::string& file, std::size_t index, std::size_t count, int x, int y) {
  return fmt::format("'{}' skip 1 every {}::{} using {}:{}", file, count, index, x, y);
}

Panel lines_panel(const std::vector<SweptField>& fields, const std::string& file, int y) {
  Panel panel;
  panel.script = fields.front().logarithmic ? "set logscale x\nset format x '%g'\n" : "";
  panel.script += "plot ";
  const std::size_t lines = fields.size() > 1 ? fields[1].values.size() : 1;
  // Behind the number of the row.
  constexpr int x = 2;
  for (std::size_t i = 0; i < lines; ++i) {
    fmt::format_to(std::back_inserter(panel.script), "{}{} {} {}", i == 0 ? "" : ", \\\n  ",
                   line_of(file, i, lines, x, y),
                   lines > 1
                       ? "title " + gnuplot_string(fields[1].column + " = " + fields[1].values[i])
                       : std::string("notitle"),
                   curve_style(i, "linespoints"));
  }
  panel.key_rows = lines > 1 ? static_cast<int>(lines) : 0;
  panel.script += "\n";
  return panel;
}

/// Least and largest number of a column; fields before it have no commas in a map.
std::array<double, 2> range_of(const std::vector<std::string>& rows, int column) {
  std::array<double, 2> range = {HUGE_VAL, -HUGE_VAL};
  for (const std::string& row : rows) {
    std::size_t at = 0;
    for (int i = 1; i < column && at != std::string::npos; ++i) at = row.find(',', at) + 1;
    const auto value = as_number<double>(row.substr(at, row.find(',', at) - at));
    if (!value) continue;
    range[0] = std::min(range[0], *value);
    range[1] = std::max(range[1], *value);
  }
  return range;
}

Panel map_panel(const std::vector<SweptField>& fields, const std::string& file, int z,
                const std::vector<std::string>& rows) {
  Panel panel;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!fields[i].logarithmic) continue;
    fmt::format_to(std::back_inserter(panel.script), "set logscale {0}\nset format {0} '%g'\n",
                   i == 0 ? 'x' : 'y');
  }
  const std::array<double, 2> range = range_of(rows, z);
  if (range[0] < range[1]) {
    fmt::format_to(std::back_inserter(panel.script),
                   "set cbrange [{0:.10g}:{1:.10g}]\n"
                   "set cbtics ('{0:.3g}' {0:.10g}, '{2:.3g}' {2:.10g}, '{1:.3g}' {1:.10g})\n",
                   range[0], range[1], (range[0] + range[1]) / 2);
  }
  // Light to dark: told without colours too.
  fmt::format_to(std::back_inserter(panel.script),
                 "set palette defined (0 '#F2F0E6', 0.5 '#5B9BC8', 1 '#0B2D5B')\n"
                 "set colorbox user horizontal origin graph 0.06,-0.28 size graph 0.88,0.04\n"
                 "set offsets graph 0.04, graph 0.04, graph 0.04, graph 0.04\n"
                 "plot '{}' skip 1 using 2:3:{} notitle with points pointtype 5 pointsize 2 "
                 "linecolor palette\n",
                 file, z);
  panel.key_rows = 2;  // the colours' scale
  return panel;
}

}  // namespace

void require_drawable(const std::vector<SweptField>& fields) {
  if (fields.empty() || fields.size() > 2) {
    throw InputError(
        fmt::format("--plot: {} fields are varied (allowed: one or two)", fields.size()));
  }
  if (!is_numeric(fields.front())) {
    throw InputError(
        fmt::format("--plot: {} = {} is no number (allowed: a first field with numbers as values)",
                    fields.front().column, fields.front().values.front()));
  }
}

Picture sweep_picture(const std::vector<SweptField>& fields, const std::string& header,
                      const std::vector<std::string>& rows,
                      const std::vector<std::string>& results) {
  require_drawable(fields);
  std::string csv = header;
  for (const std::string& row : rows) csv += row;
  const bool lines =
      fields.size() < 2 || fields[1].values.size() <= most_lines || !is_numeric(fields[1]);
  PictureRow columns;
  for (const std::string& result : results) {
    const int column = column_of(header, result);
    Panel panel = lines ? lines_panel(fields, "sweep.csv", column)
                        : map_panel(fields, "sweep.csv", column, rows);
    panel.x_label = fields.front().column;
    panel.y_label = lines ? result : fields[1].column;
    columns.push_back({{.name = result,
                        .title = result + " against " + fields.front().column +
                                 (fields.size() > 1 ? " and " + fields[1].column : ""),
                        .csv_file = "sweep.csv",
                        .csv = columns.empty() ? csv : "",
                        .panels = {panel}}});
  }
  return {{columns}};
}

}  // namespace dlo::compare
