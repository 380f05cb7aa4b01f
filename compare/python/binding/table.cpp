#include "table.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <limits>
#include <variant>

namespace dlo::python {
namespace {

using compare::CellKind;

double number_of(const compare::SweepCell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return *number;
  if (const auto* count = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*count);
  return std::numeric_limits<double>::quiet_NaN();
}

template <typename Number>
py::array array_of(const std::vector<Number>& numbers) {
  return py::array_t<Number>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

}  // namespace

Table::Table(const std::vector<compare::SweepColumn>& columns) {
  for (const compare::SweepColumn& column : columns) columns_.push_back({column, {}, {}, {}});
}

void Table::add(const std::vector<compare::SweepCell>& cells) {
  for (std::size_t i = 0; i < columns_.size(); ++i) add_cell(columns_[i], cells.at(i));
}

void Table::add_cell(Column& column, const compare::SweepCell& cell) {
  switch (column.is.kind) {
    case CellKind::whole:
      column.whole.push_back(std::get<std::int64_t>(cell));
      break;
    case CellKind::number:
      column.numbers.push_back(number_of(cell));
      break;
    case CellKind::text: {
      const auto* text = std::get_if<std::string>(&cell);
      column.words.push_back(text != nullptr ? *text : std::string());
      break;
    }
  }
}

py::dict Table::arrays() const {
  py::dict result;
  for (const Column& column : columns_) {
    const py::str name(column.is.name);
    if (column.is.kind == CellKind::whole) {
      result[name] = array_of(column.whole);
    } else if (column.is.kind == CellKind::number) {
      result[name] = array_of(column.numbers);
    } else {
      result[name] = py::array(py::cast(column.words));
    }
  }
  return result;
}

}  // namespace dlo::python
