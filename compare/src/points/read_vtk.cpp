#include <fmt/format.h>

#include <algorithm>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "points/readers.hpp"

namespace dlo::compare {
namespace {

/// Returns the points of a shape, with all other data per point, in the given order.
RawShape in_order(const RawShape& points, const std::vector<std::size_t>& order) {
  RawShape result;
  result.in_metres = points.in_metres;
  result.notes = points.notes;
  for (const std::size_t i : order) {
    result.points.push_back(points.points[i]);
    if (!points.lines.empty()) result.lines.push_back(points.lines[i]);
    if (!points.arc_length.empty()) result.arc_length.push_back(points.arc_length[i]);
    if (!points.d1.empty()) result.d1.push_back(points.d1[i]);
  }
  return result;
}

/// Reads a legacy VTK file word by word and keeps count of its lines.
class VtkReader {
 public:
  VtkReader(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  [[nodiscard]] RawShape read() {
    read_preamble();
    RawShape points;
    std::vector<std::size_t> order;
    for (std::string_view word = next(); !word.empty(); word = next()) {
      if (word == "POINTS") {
        if (!points.points.empty()) fail("a second POINTS (allowed: one)");
        points = read_points();
      } else if (word == "LINES") {
        if (!order.empty()) fail("a second LINES (allowed: one)");
        order = read_lines(points.points.size());
      } else if (word == "VERTICES" || word == "POLYGONS" || word == "TRIANGLE_STRIPS") {
        fail(fmt::format("{} (allowed: POINTS and LINES)", word));
      } else if (word == "METADATA") {
        skip_metadata();
      } else if (word == "POINT_DATA" || word == "CELL_DATA") {
        if (word == "POINT_DATA") read_point_data(points);
        break;
      } else if (shape_number(word)) {
        fail(fmt::format("{} in place of a keyword such as LINES", quoted_piece(word)));
      }
    }
    if (points.points.empty()) fail("no POINTS");
    return order.empty() ? points : in_order(points, order);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(fmt::format("{}:{}: {}", file_, line_, problem));
  }

  std::string_view next_line() {
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++next_line_;
    line_ = next_line_ - 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  /// Returns the next word, empty at the end of the file.
  std::string_view next() {
    const std::size_t start = std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size());
    next_line_ += std::count(rest_.begin(), rest_.begin() + static_cast<long>(start), '\n');
    line_ = next_line_;
    rest_.remove_prefix(start);
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n"));
    rest_.remove_prefix(word.size());
    return word;
  }

  /// Skips a block of metadata, which ends with an empty line.
  void skip_metadata() {
    next_line();
    while (!rest_.empty() && !next_line().empty()) continue;
  }

  void read_preamble() {
    next_line();
    next_line();
    std::string_view format = next();
    if (format != "ASCII") {
      fail(fmt::format("{} (allowed: ASCII, the legacy format's text form)",
                       format == "BINARY" ? "BINARY" : quoted_piece(format)));
    }
    if (const std::string_view word = next(); word != "DATASET") {
      fail(fmt::format("{} in place of DATASET", quoted_piece(word)));
    }
    if (const std::string_view kind = next(); kind != "POLYDATA") {
      fail(fmt::format("DATASET {} (allowed: POLYDATA)", quoted_piece(kind)));
    }
  }

  std::size_t read_count(const char* what, std::size_t largest) {
    const std::string_view word = next();
    const std::optional<std::size_t> value = as_number<std::size_t>(word);
    if (!value || *value > largest) {
      fail(fmt::format("{} {} (allowed: 0 to {})", what, quoted_piece(word), largest));
    }
    return *value;
  }

  RawShape read_points() {
    RawShape raw;
    const std::size_t count =
        read_count("number of points", static_cast<std::size_t>(most_shape_points));
    next();  // float or double
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, 3> point{};
      for (double& coordinate : point) {
        const std::string_view word = next();
        const std::optional<double> value = shape_number(word);
        if (!value) {
          fail(word.empty()
                   ? fmt::format("the file ends in point {} of {}", i + 1, count)
                   : fmt::format("point {}: {} is not a number", i + 1, quoted_piece(word)));
        }
        coordinate = *value;
      }
      raw.points.push_back(point);
      raw.lines.push_back(line_);
    }
    return raw;
  }

  /// Reads the arrays of a FIELD that a shape uses: d1, and arc_length_m. `dlo solve` writes them;
  /// a file with arc_length_m is in metres.
  void read_point_data(RawShape& raw) {
    const std::size_t count = raw.points.size();
    for (std::string_view word = next(); !word.empty() && word != "CELL_DATA"; word = next()) {
      if (word == "arc_length_m") {
        if (next() != "1") fail("arc_length_m: must have one component");
        raw.arc_length = read_array("arc_length_m", 1, count);
        raw.in_metres = true;
      } else if (word == "d1" && next() == "3") {
        const std::vector<double> numbers = read_array("d1", 3, count);
        raw.d1.clear();
        for (std::size_t i = 0; i < count; ++i) {
          raw.d1.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
        }
      }
    }
  }

  std::vector<double> read_array(const char* name, std::size_t components, std::size_t points) {
    if (read_count(fmt::format("{}: number of values", name).c_str(), points) != points) {
      fail(fmt::format("{}: must have {} values, one a point", name, points));
    }
    next();  // float or double
    std::vector<double> values;
    for (std::size_t i = 0; i < components * points; ++i) {
      const std::string_view number = next();
      const std::optional<double> value = shape_number(number);
      if (!value) fail(fmt::format("{}: {} is not a number", name, quoted_piece(number)));
      values.push_back(*value);
    }
    return values;
  }

  /// Returns the indices of the points in their order along the polyline.
  std::vector<std::size_t> read_lines(std::size_t points) {
    if (points == 0) fail("LINES before POINTS");
    constexpr auto most = static_cast<std::size_t>(3 * most_shape_points);
    const std::size_t cells = read_count("LINES: number of lines", most);
    const std::size_t size = read_count("LINES: size", most);
    const std::string_view saved = rest_;
    const long saved_line = next_line_;
    if (next() == "OFFSETS") return read_offsets(points, cells, size);
    rest_ = saved;
    next_line_ = saved_line;
    std::vector<std::size_t> order;
    for (std::size_t c = 0; c < cells; ++c) {
      const std::size_t count = read_count("LINES: points of a line", most);
      std::vector<std::size_t> cell;
      for (std::size_t i = 0; i < count; ++i)
        cell.push_back(read_count("LINES: index", points - 1));
      append(cell, order);
    }
    return order;
  }

  /// Reads LINES in the format of version 5.1, with OFFSETS and CONNECTIVITY.
  std::vector<std::size_t> read_offsets(std::size_t points, std::size_t offsets, std::size_t size) {
    next();  // type
    std::vector<std::size_t> begin;
    for (std::size_t i = 0; i < offsets; ++i) {
      begin.push_back(read_count("OFFSETS: offset", size));
      if (i > 0 && begin[i] < begin[i - 1]) fail("OFFSETS: must not fall");
    }
    if (const std::string_view word = next(); word != "CONNECTIVITY") {
      fail(fmt::format("{} in place of CONNECTIVITY", quoted_piece(word)));
    }
    next();  // type
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < size; ++i) {
      indices.push_back(read_count("CONNECTIVITY: index", points - 1));
    }
    std::vector<std::size_t> order;
    for (std::size_t c = 0; c + 1 < offsets; ++c) {
      append({indices.begin() + static_cast<long>(begin[c]),
              indices.begin() + static_cast<long>(begin[c + 1])},
             order);
    }
    return order;
  }

  /// Appends a cell to a polyline.
  /// @param cell  indices of its points, two or more
  /// @throws InputError if the cell does not begin where the polyline ends, or has fewer than two
  /// points
  void append(const std::vector<std::size_t>& cell, std::vector<std::size_t>& order) const {
    if (cell.size() < 2) fail("a line of fewer than two points");
    if (!order.empty() && cell.front() != order.back()) {
      fail("several separate lines (allowed: one polyline, or lines that follow on)");
    }
    order.insert(order.end(), cell.begin() + (order.empty() ? 0 : 1), cell.end());
    require_point_count(order.size(), fmt::format("{}:{}", file_, line_));
  }

  std::string_view rest_;
  std::string file_;
  long next_line_ = 1;  // line in which rest_ begins
  long line_ = 1;       // line of the last word or line
};

}  // namespace

RawShape read_vtk_shape(std::string_view text, const std::string& file) {
  const std::size_t start = text.find("# vtk");
  return VtkReader(text.substr(start), file).read();
}

}  // namespace dlo::compare
