#pragma once

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// A line of a table, without blanks around its fields.
struct CsvRow {
  long line = 0;      ///< number in the file, from 1
  std::string where;  ///< "file:line", for messages
  std::vector<std::string_view> fields;
};

/// How a table separates its fields.
struct CsvForm {
  /// As the first row has it: comma, semicolon, tab or any blanks.
  static constexpr char of_first_row = '\1';

  char separator = ',';
  std::string_view around = " \t\r";  ///< passed over at both ends of a line and of a field
  std::size_t most_fields = std::numeric_limits<std::size_t>::max();  ///< one more may come
  std::size_t most_rows = std::numeric_limits<std::size_t>::max();
};

/// Calls for each row of a table, the header's too; empty lines and those that begin with # are
/// passed over.
void for_each_csv_row(std::string_view text, const std::string& file, CsvForm form,
                      const std::function<void(const CsvRow&)>& take);

}  // namespace dlo::compare
