#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

#include "batch/sweep.hpp"

namespace dlo::python {

namespace py = pybind11;

/// A sweep's table, column by column.
class Table {
 public:
  explicit Table(const std::vector<compare::SweepColumn>& columns);

  /// @param cells  of a row, one for each column
  void add(const std::vector<compare::SweepCell>& cells);

  /// A dict of arrays: int64 of what is whole, float64 of numbers (NaN where there is none), str of
  /// text ("" there). With the GIL.
  [[nodiscard]] py::dict arrays() const;

 private:
  struct Column {
    compare::SweepColumn is;
    std::vector<std::int64_t> whole;  // only the one that `is` says is filled
    std::vector<double> numbers;
    std::vector<std::string> words;
  };
  static void add_cell(Column& column, const compare::SweepCell& cell);

  std::vector<Column> columns_;
};

}  // namespace dlo::python
