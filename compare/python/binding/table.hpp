#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace dlo::python {

namespace py = pybind11;

/// Columns of a CSV table as it is written by a sweep, filled line by line.
class Table {
 public:
  /// @param header  the names of the columns, with the line's end
  explicit Table(const std::string& header);

  /// @param line  as many fields, with the line's end
  void add(const std::string& line);

  /// A dict of arrays: float64 where every field is a number or empty (NaN), else of str. With the
  /// GIL.
  [[nodiscard]] py::dict arrays() const;

 private:
  struct Column {
    std::string name;
    std::vector<double> numbers;
    std::vector<std::string> words;  // of all rows, once a field is no number
  };
  static void add_field(Column& column, const std::string& field);

  std::vector<Column> columns_;
};

}  // namespace dlo::python
