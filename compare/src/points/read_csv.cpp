#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "decode/csv_rows.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "points/readers.hpp"

namespace dlo::compare {
namespace {

constexpr const char* column_names[] = {"x", "y", "z", "s", "d1_x", "d1_y", "d1_z"};
constexpr std::size_t named_columns = std::size(column_names);
constexpr std::size_t first_of_d1 = 4;
constexpr const char* columns_allowed =
    "(allowed: x,y or x,y,z or x,y,z,s, or a header with these names in any order, besides d1_x, "
    "d1_y, d1_z, and node, id, index or point, beside which further columns are not read)";

/// Positions of the named columns among all columns.
struct Columns {
  std::size_t count = 0;
  std::array<std::optional<std::size_t>, named_columns> of;
  std::string note = {};  ///< which columns are not read, for the user
};

/// Names of columns that number the rows. These columns are not read: points are in the order of
/// their rows.
constexpr const char* label_names[] = {"node", "id", "index", "point"};

/// Largest number of columns [-]; no table of nodes has nearly as many.
constexpr std::size_t most_columns = 64;

/// Whether the fourth column is the arc length of the points in the first three: from row to row it
/// grows, or falls, by 0.99 to 1.5 times their distance, in the points' unit or in metres of points
/// in cm or mm.
bool has_arc_length(const std::vector<std::array<double, 4>>& rows) {
  constexpr double shortest = 0.99;
  constexpr double longest = 1.5;
  constexpr double units[] = {1, 1e-2, 1e-3};
  return std::any_of(std::begin(units), std::end(units), [&](double unit) {
    const bool growing = rows[1][3] > rows[0][3];
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const std::array<double, 4>& a = rows[i - 1];
      const std::array<double, 4>& b = rows[i];
      const double chord = unit * std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
      const double step = growing ? b[3] - a[3] : a[3] - b[3];
      if (!(step >= shortest * chord && step <= longest * chord)) return false;
    }
    return true;
  });
}

/// Whether rows without a header begin with numbers of nodes, which are distinct integers. Four
/// columns may also be x, y, z and s; their first column is then only taken as numbers of nodes if
/// it counts from 0 or 1 and the fourth is no arc length.
bool begin_with_nodes(const std::vector<CsvRow>& rows) {
  if (rows.size() < 2 || rows.front().fields.size() < 4) return false;
  std::vector<long> nodes;
  std::vector<std::array<double, 4>> starts;
  for (const CsvRow& row : rows) {
    const std::optional<long> node = as_number<long>(row.fields.front());
    if (!node || row.fields.size() < 4) return false;
    nodes.push_back(*node);
    starts.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      starts.back()[k] = shape_number(row.fields[k]).value_or(NAN);
    }
  }
  const bool is_counted =
      (nodes.front() == 0 || nodes.front() == 1) &&
      std::ranges::adjacent_find(nodes, [](long a, long b) { return b != a + 1; }) == nodes.end();
  if (rows.front().fields.size() == 4) return is_counted && !has_arc_length(starts);
  std::ranges::sort(nodes);
  return std::ranges::adjacent_find(nodes) == nodes.end();
}

Columns columns_without_header(const std::vector<CsvRow>& rows, const std::string& where) {
  const std::size_t count = rows.front().fields.size();
  Columns columns{.count = count};
  const bool nodes = begin_with_nodes(rows);
  if (count > most_columns || (!nodes && (count < 2 || count > 4))) {
    throw InputError(
        fmt::format("{}: {} column{} {}", where, count, count == 1 ? "" : "s", columns_allowed));
  }
  const std::size_t first = nodes ? 1 : 0;
  const std::size_t taken = nodes ? 3 : count;
  for (std::size_t i = 0; i < taken; ++i) columns.of[i] = first + i;
  if (!nodes) return columns;
  columns.note = fmt::format("a table of nodes: its columns are node, x, y, z{}",
                             count > 4 ? ", and further ones, which are not read" : "");
  return columns;
}

Columns columns_of_header(const std::vector<std::string_view>& fields, const std::string& where) {
  Columns columns{.count = fields.size()};
  std::vector<std::string> names;
  for (const std::string_view field : fields) {
    names.emplace_back(field);
    std::transform(names.back().begin(), names.back().end(), names.back().begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  }
  const bool has_nodes = std::ranges::find_first_of(names, label_names) != names.end();
  std::string ignored_fields;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::string& name = names[i];
    if (std::ranges::find(label_names, name) != std::end(label_names)) continue;
    const auto* found = std::find(std::begin(column_names), std::end(column_names), name);
    if (found == std::end(column_names) && has_nodes) {
      ignored_fields += (ignored_fields.empty() ? "" : ", ") + quoted_piece(fields[i]);
      continue;
    }
    if (found == std::end(column_names)) {
      throw InputError(
          fmt::format("{}: unknown column {} {}", where, quoted_piece(fields[i]), columns_allowed));
    }
    auto& of = columns.of[static_cast<std::size_t>(found - std::begin(column_names))];
    if (of) throw InputError(fmt::format("{}: column {} given twice", where, *found));
    of = i;
  }
  if (!columns.of[0] || !columns.of[1]) {
    throw InputError(fmt::format("{}: column {} is missing {}", where, columns.of[0] ? "y" : "x",
                                 columns_allowed));
  }
  const auto of_d1 =
      std::count_if(columns.of.begin() + first_of_d1, columns.of.end(),
                    [](const std::optional<std::size_t>& of) { return of.has_value(); });
  if (of_d1 % 3 != 0) {
    throw InputError(fmt::format(
        "{}: {} of the columns d1_x, d1_y, d1_z (allowed: all of them, or none)", where, of_d1));
  }
  if (!ignored_fields.empty()) {
    columns.note = fmt::format("a table of nodes: the columns {} are not read", ignored_fields);
  }
  return columns;
}

void add_row(const CsvRow& row, const Columns& columns, RawShape& raw) {
  const std::vector<std::string_view>& fields = row.fields;
  const std::string& where = row.where;
  if (fields.size() != columns.count) {
    throw InputError(fmt::format("{}: {} column{} (allowed: {}, as in the first line)", where,
                                 fields.size(), fields.size() == 1 ? "" : "s", columns.count));
  }
  std::array<double, named_columns> values{};
  for (std::size_t k = 0; k < named_columns; ++k) {
    if (!columns.of[k]) continue;
    const std::string_view field = fields[*columns.of[k]];
    const std::optional<double> value = shape_number(field);
    if (!value) {
      throw InputError(
          fmt::format("{}: {} = {} is not a number{}", where, column_names[k], quoted_piece(field),
                      field.find(',') != std::string_view::npos ? " (allowed: decimal points)"
                      : k >= first_of_d1 ? " (allowed: d1 in every row, or its columns left out)"
                                         : ""));
    }
    values[k] = *value;
  }
  raw.points.push_back({values[0], values[1], values[2]});
  if (columns.of[3]) raw.arc_length.push_back(values[3]);
  if (columns.of[first_of_d1]) raw.d1.push_back({values[4], values[5], values[6]});
  raw.lines.push_back(row.line);
  require_point_count(raw.points.size(), where);
}

}  // namespace

RawShape read_csv_shape(std::string_view text, const std::string& file) {
  RawShape raw;
  // Room for a header and one row more than allowed: the row too many is read and then rejected.
  const CsvForm form{.separator = CsvForm::detect_from_first_row,
                     .trimmed_characters = " \t\r\"",
                     .most_fields = most_columns,
                     .most_rows = static_cast<std::size_t>(most_shape_points) + 2};
  std::vector<CsvRow> rows;
  for_each_csv_row(text, file, form, [&rows](const CsvRow& row) { rows.push_back(row); });
  if (rows.empty()) return raw;
  const std::vector<std::string_view>& first = rows.front().fields;
  const std::string& where = rows.front().where;
  const bool header = std::none_of(first.begin(), first.end(), [](std::string_view field) {
    return shape_number(field).has_value();
  });
  const Columns columns =
      header ? columns_of_header(first, where) : columns_without_header(rows, where);
  for (std::size_t i = header ? 1 : 0; i < rows.size(); ++i) {
    add_row(rows[i], columns, raw);
  }
  if (!columns.note.empty()) raw.notes.push_back(columns.note);
  return raw;
}

}  // namespace dlo::compare
