#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "record/field.hpp"

namespace dlo::compare {

/// A table of CSV made of documents, one a row, so that JSON and CSV say the same.
class CsvTable {
 public:
  /// @param columns  "rms_m=deviation/rms_m,scene,wall_s=solver/wall_s:4": a name, where that is
  /// not its path in a document the path, and the digits unless they are ten
  explicit CsvTable(std::string_view columns);

  /// More of them.
  void add(std::string_view columns);

  /// The header, as a line.
  [[nodiscard]] std::string header() const;
  /// A line; what the document does not have leaves its field empty.
  [[nodiscard]] std::string row(const Json& document) const;
  /// The header, and a line of each.
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
