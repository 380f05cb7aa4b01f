#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "record/field.hpp"

namespace dlo::compare {

/// A CSV table of JSON documents, one per row, so that JSON and CSV have the same content.
class CsvTable {
 public:
  /// @param columns  such as "rms_m=deviation/rms_m,scene,wall_s=solver/wall_s:4": the name, the
  /// path in the document if it differs from the name, and the number of digits if it is not ten
  explicit CsvTable(std::string_view columns);

  /// Adds columns.
  void add(std::string_view columns);

  /// Returns the header as a line.
  [[nodiscard]] std::string header() const;
  /// Returns a row as a line; values that the document lacks leave their field empty.
  [[nodiscard]] std::string row(const Json& document) const;
  /// Returns the header, and a row for each document.
  [[nodiscard]] std::string text(const Json& documents) const;

 private:
  struct Column {
    std::string name;
    Json::json_pointer path;
    int digits = 10;
  };
  std::vector<Column> columns_;
};

}  // namespace dlo::compare
