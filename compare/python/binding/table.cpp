#include "table.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <functional>
#include <limits>

#include "base/number.hpp"

namespace dlo::python {
namespace {

/// Calls `take` with every field; a field in quotes may hold commas, and quotes that are doubled.
void each_field(const std::string& line, const std::function<void(const std::string&)>& take) {
  std::string field;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size() && (quoted || line[i] != '\n'); ++i) {
    const char c = line[i];
    if (c == '"') {
      const bool is_doubled = quoted && i + 1 < line.size() && line[i + 1] == '"';
      if (is_doubled) {
        field += line[++i];
      } else {
        quoted = !quoted;
      }
    } else if (c == ',' && !quoted) {
      take(field);
      field.clear();
    } else {
      field += c;
    }
  }
  take(field);
}

}  // namespace

Table::Table(const std::string& header) {
  each_field(header, [this](const std::string& name) { columns_.push_back({name, {}, {}}); });
}

void Table::add(const std::string& line) {
  std::size_t column = 0;
  each_field(line, [&](const std::string& field) { add_field(columns_.at(column++), field); });
}

void Table::add_field(Column& column, const std::string& field) {
  if (!column.words.empty()) {
    column.words.push_back(field);
    return;
  }
  const auto number =
      field.empty() ? std::numeric_limits<double>::quiet_NaN() : compare::as_number<double>(field);
  if (number) {
    column.numbers.push_back(*number);
    return;
  }
  // Fields are written with ten digits; what was read so far is written so again.
  for (const double before : column.numbers) {
    column.words.push_back(std::isnan(before) ? "" : fmt::format("{:.10g}", before));
  }
  column.words.push_back(field);
}

py::dict Table::arrays() const {
  py::dict result;
  for (const Column& column : columns_) {
    const py::str name(column.name);
    if (column.words.empty()) {
      result[name] = py::array_t<double>(static_cast<py::ssize_t>(column.numbers.size()),
                                         column.numbers.data());
    } else {
      result[name] = py::array(py::cast(column.words));
    }
  }
  return result;
}

}  // namespace dlo::python
