#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../helpers.hpp"

namespace dlo::test {

using CsvRow = std::vector<std::string>;

/// Returns the fields of a line of CSV without line ends in its fields; quotes are kept.
inline CsvRow csv_fields(const std::string& line) {
  CsvRow fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

/// Returns the rows of CSV text, its header first; empty lines are omitted.
inline std::vector<CsvRow> csv_rows(const std::string& text) {
  std::vector<CsvRow> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) rows.push_back(csv_fields(line));
  }
  return rows;
}

/// Whether CSV text is a table: rows below a header, of as many fields each.
inline bool is_table(const std::string& text) {
  const std::vector<CsvRow> rows = csv_rows(text);
  return rows.size() > 1 && std::all_of(rows.begin(), rows.end(), [&](const CsvRow& row) {
           return row.size() == rows.front().size();
         });
}

/// Returns the number of a field; NaN if it is empty.
inline double csv_number_of(const std::string& field) {
  return field.empty() ? NAN : std::strtod(field.c_str(), nullptr);
}

/// Returns the numbers of all rows from a given one on. @param skip  number of columns before them
inline std::vector<std::vector<double>> csv_numbers(const std::vector<CsvRow>& rows,
                                                    std::size_t first, std::size_t skip = 0) {
  std::vector<std::vector<double>> numbers;
  for (std::size_t i = first; i < rows.size(); ++i) {
    std::vector<double> row;
    for (std::size_t k = skip; k < rows[i].size(); ++k) row.push_back(csv_number_of(rows[i][k]));
    numbers.push_back(std::move(row));
  }
  return numbers;
}

/// Returns the value in a column of the first row below the header. Throws std::runtime_error if
/// there is no such column, and std::out_of_range if a row is missing.
inline std::string first_row_value(const std::string& text, const std::string& column) {
  const std::vector<CsvRow> rows = csv_rows(text);
  const auto name = std::find(rows.at(0).begin(), rows.at(0).end(), column);
  if (name == rows.at(0).end()) throw std::runtime_error("no column " + column + " in " + text);
  return rows.at(1).at(static_cast<std::size_t>(name - rows.at(0).begin()));
}

}  // namespace dlo::test
