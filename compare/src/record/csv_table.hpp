#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "record/field.hpp"

namespace dlo::compare {

/// A CSV table of JSON documents, one per row, so that JSON and CSV have the same content.
class CsvTable {
 public:
  /// @param columns  such as "rms_m=deviation/rms_m,scene,wall_s=solver/wall_s:4": the name, the
  /// path in the document if it differs from the name, and the number of digits, 1 to 9, if not
  /// ten. The path "#" is the number of the row, from 1
  explicit CsvTable(std::string_view columns);

  void add(std::string_view columns);

  /// Returns the header as a line.
  [[nodiscard]] std::string header() const;
  /// Returns a row as a line; values that the document lacks leave their field empty.
  /// @param number  of the row, from 1
  [[nodiscard]] std::string row(const Json& document, std::size_t number = 0) const;
  /// Returns the header, and a row for each document.
  [[nodiscard]] std::string text(const Json& documents) const;
  /// Returns the table for people: titles with units, numbers as in Document::text(), and only the
  /// columns that have a value in one of the rows.
  [[nodiscard]] std::string aligned(const Json& documents, const Magnitudes& large) const;

 private:
  struct Column {
    std::string name;
    Json::json_pointer path;
    int digits = 10;
  };
  [[nodiscard]] static Json cell(const Column& column, const Json& document, std::size_t number);

  std::vector<Column> columns_;
};

/// A result as a JSON document, from which its text and its table follow.
struct Document {
  Json json;
  /// Columns, as CsvTable has them, of lists of objects by their paths, such as
  /// {{"dynamic/frames", "time_s,rms_m"}}; an empty text omits the list. Lists within a list's
  /// objects are shown only if they have columns here.
  std::map<std::string, std::string> columns = {};
  Magnitudes large = {};  ///< numbers of the text below 1e-9 of these are rounding
  /// Path of the list that is the CSV table. Empty: the document is the only row. csv() needs an
  /// entry of `columns` for it in either case.
  std::string table = {};
  std::string head = {};  ///< text for people before the values
  Json shown = {};        ///< values of the text; null: those of `json`

  /// Returns the head, a line `name  value unit` for each value, then a table for each list of
  /// objects. Name and unit are those of the key, such as `rms_m`. Numbers have four significant
  /// digits, unless they are whole or just below 1; shares of the length are percentages. The key
  /// `schema`, values that are null, points and long lists of numbers are omitted.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::string csv() const;
};

}  // namespace dlo::compare
