#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// A number the paper prints, beside what its formula gives.
struct TableRow {
  std::string table;        ///< the paper's number of it
  std::string quantity;     ///< symbol as printed
  std::string unit;         ///< as printed
  std::string printed;      ///< digits as in the paper
  double computed = 0;      ///< in `unit`
  std::string explanation;  ///< how it was computed
  bool agrees = false;      ///< computed, rounded to the printed digits, is what is printed
};

/// Tables 1 and 5 recomputed from the quantities they are said to follow from.
[[nodiscard]] std::vector<TableRow> recompute_tables();

}  // namespace dlo::compare
