#include "points/read_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {
namespace {

constexpr const char* column_names[] = {"x", "y", "z", "s", "d1_x", "d1_y", "d1_z"};
constexpr std::size_t named_columns = std::size(column_names);
constexpr std::size_t first_of_d1 = 4;
constexpr const char* columns_allowed =
    "(allowed: x,y or x,y,z or x,y,z,s, or a header with these names in any order, besides d1_x, "
    "d1_y, d1_z, and node, id, index or point)";

/// Position of the named ones among the columns.
struct Columns {
  std::size_t count = 0;
  std::array<std::optional<std::size_t>, named_columns> of;
};

/// Of a number that a row is known by. Points are in the order of their rows.
constexpr const char* label_names[] = {"node", "id", "index", "point"};

std::string_view trimmed_field(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t\r\"");
  if (start == std::string_view::npos) return {};
  return text.substr(start, text.find_last_not_of(" \t\r\"") - start + 1);
}

/// What separates fields: comma, semicolon, tab or, as '\0', any blanks.
char separator_of(std::string_view line) {
  for (const char separator : {',', ';', '\t'}) {
    if (line.find(separator) != std::string_view::npos) return separator;
  }
  return '\0';
}

std::vector<std::string_view> split_fields(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = separator == '\0' ? line.find_first_of(" \t") : line.find(separator);
    fields.push_back(trimmed_field(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
    if (separator != '\0') continue;
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  }
}

Columns columns_without_header(std::size_t count, const std::string& where) {
  if (count < 2 || count > 4) {
    throw InputError(
        fmt::format("{}: {} column{} {}", where, count, count == 1 ? "" : "s", columns_allowed));
  }
  Columns columns{.count = count};
  for (std::size_t i = 0; i < count; ++i) columns.of[i] = i;
  return columns;
}

Columns columns_of_header(const std::vector<std::string_view>& fields, const std::string& where) {
  Columns columns{.count = fields.size()};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    std::string name(fields[i]);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (std::ranges::find(label_names, name) != std::end(label_names)) continue;
    const auto* found = std::find(std::begin(column_names), std::end(column_names), name);
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
  return columns;
}

void add_row(const std::vector<std::string_view>& fields, const Columns& columns,
             const std::string& where, long line, RawShape& raw) {
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
  raw.lines.push_back(line);
  require_point_count(raw.points.size(), where);
}

}  // namespace

RawShape read_csv_shape(std::string_view text, const std::string& file) {
  RawShape raw;
  std::optional<Columns> columns;
  char separator = '\0';
  for (long number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed_field(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    const std::string where = fmt::format("{}:{}", file, number);
    if (!columns) separator = separator_of(line);
    const std::vector<std::string_view> fields = split_fields(line, separator);
    if (!columns) {
      const bool header = std::none_of(fields.begin(), fields.end(), [](std::string_view field) {
        return shape_number(field).has_value();
      });
      columns =
          header ? columns_of_header(fields, where) : columns_without_header(fields.size(), where);
      if (header) continue;
    }
    add_row(fields, *columns, where, number, raw);
  }
  return raw;
}

}  // namespace dlo::compare
