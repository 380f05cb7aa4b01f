#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

constexpr std::size_t most_lines = 6;  // number of different curve styles

bool is_numeric(const SweptField& field) {
  return std::ranges::all_of(
      field.values, [](const std::string& value) { return as_number<double>(value).has_value(); });
}

double number_of(const std::string& text) { return as_number<double>(text).value_or(NAN); }

/// Returns the fields of a line of CSV. A comma in quotes does not separate fields.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\n') {
      fields.back() += c;
    }
  }
  return fields;
}

/// Returns the values of a column of the table.
std::vector<double> column_of(const std::string& header, const std::vector<std::string>& rows,
                              const std::string& name) {
  const std::vector<std::string> names = fields_of(header);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    throw InputError(fmt::format("--plot: the sweep has no column {}", name));
  }
  const auto column = static_cast<std::size_t>(found - names.begin());
  std::vector<double> values;
  values.reserve(rows.size());
  for (const std::string& row : rows) values.push_back(number_of(fields_of(row).at(column)));
  return values;
}

/// Draws one line for each value of the second field. The rows of such a value are `count` rows
/// apart.
Panel lines_panel(const std::vector<SweptField>& fields, const std::string& result,
                  const std::vector<double>& values) {
  Panel panel{.x = {.label = fields[0].column, .logarithmic = fields[0].logarithmic},
              .y = {.label = result}};
  const std::size_t count = fields.size() > 1 ? fields[1].values.size() : 1;
  for (std::size_t i = 0; i < count; ++i) {
    PlottedCurve line{.look = curve_style(i)};
    if (count > 1) line.title = fields[1].column + " = " + fields[1].values[i];
    for (std::size_t k = 0; k * count + i < values.size(); ++k) {
      line.x.push_back(number_of(fields[0].values[k]));
      line.y.push_back(values[k * count + i]);
    }
    panel.curves.push_back(std::move(line));
  }
  return panel;
}

/// Order of a field's values on an axis, increasing, and the edges of cells half way between them.
struct CellAxis {
  explicit CellAxis(const SweptField& field) : order(field.values.size()) {
    std::vector<double> at;
    for (const std::string& value : field.values) {
      at.push_back(field.logarithmic ? std::log(number_of(value)) : number_of(value));
    }
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return at[a] < at[b]; });
    std::sort(at.begin(), at.end());
    const double alone = at.front() == 0 || field.logarithmic ? 1 : 0.1 * std::abs(at.front());
    const std::size_t last = at.size() - 1;
    const double before = last > 0 ? at[1] - at[0] : alone;
    const double after = last > 0 ? at[last] - at[last - 1] : alone;
    edges.push_back(at[0] - before / 2);
    for (std::size_t i = 0; i < last; ++i) edges.push_back((at[i] + at[i + 1]) / 2);
    edges.push_back(at[last] + after / 2);
    for (double& edge : edges) edge = field.logarithmic ? std::exp(edge) : edge;
  }

  std::vector<std::size_t> order;  ///< indices of the values in increasing order
  std::vector<double> edges;
};

PlotAxis axis_of(const SweptField& field, const std::vector<double>& edges) {
  return {.label = field.column,
          .from = edges.front(),
          .to = edges.back(),
          .logarithmic = field.logarithmic};
}

Panel map_panel(const std::vector<SweptField>& fields, const std::vector<double>& values) {
  const CellAxis x(fields[0]);
  const CellAxis y(fields[1]);
  Cells cells{.x = x.edges, .y = y.edges};
  for (const std::size_t row : y.order) {
    for (const std::size_t column : x.order) {
      const std::size_t at = column * y.order.size() + row;
      cells.values.push_back(at < values.size() ? values[at] : NAN);
    }
  }
  return {.x = axis_of(fields[0], x.edges),
          .y = axis_of(fields[1], y.edges),
          .cells = std::move(cells)};
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
  const bool lines =
      fields.size() < 2 || fields[1].values.size() <= most_lines || !is_numeric(fields[1]);
  PictureRow columns;
  for (const std::string& result : results) {
    const std::vector<double> values = column_of(header, rows, result);
    columns.push_back(
        {{.title = result + " against " + fields.front().column +
                   (fields.size() > 1 ? " and " + fields[1].column : ""),
          .panels = {lines ? lines_panel(fields, result, values) : map_panel(fields, values)}}});
  }
  return {{columns}};
}

}  // namespace dlo::compare
