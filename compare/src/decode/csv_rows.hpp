#pragma once

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// A row of a table, without blanks around its fields.
struct CsvRow {
  long line = 0;      ///< number in the file, from 1
  std::string where;  ///< "file:line", for messages
  std::vector<std::string_view> fields;
};

/// Format of a table.
struct CsvForm {
  /// Separator is that of the first row: comma, semicolon, tab or any blanks.
  static constexpr char detect_from_first_row = '\1';

  char separator = ',';
  /// Characters that are skipped at both ends of a line and of a field.
  std::string_view trimmed_characters = " \t\r";
  /// Largest number of fields in a row. One more is read, so that the reader can report it.
  std::size_t most_fields = std::numeric_limits<std::size_t>::max();
  /// Number of rows after which the reading ends.
  std::size_t most_rows = std::numeric_limits<std::size_t>::max();
};

/// Calls `take` for each row of a table, also for the header; empty lines and lines that begin with
/// # are skipped.
void for_each_csv_row(std::string_view text, const std::string& file, CsvForm form,
                      const std::function<void(const CsvRow&)>& take);

}  // namespace dlo::compare
