#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// data/paper/tables.toml: the paper's tables digit by digit.
[[nodiscard]] const toml::table& printed_tables();

/// A number of table_1 or table_5 as printed, in the unit that the key names.
/// @throws std::out_of_range if the file has none
[[nodiscard]] double printed(std::string_view table, std::string_view key);

/// Table 1 in SI units, but for what it says per unit of a length that it leaves open.
struct Table1 {
  double length = 0;        ///< [m]
  double mass = 0;          ///< [kg]
  Eigen::Index points = 0;  ///< N
  double c_c = 0;           ///< [N]
  double c_b = 0;           ///< [N]
  double grip_force = 0;    ///< at 5 % of a segment [N]
  double point_weight = 0;  ///< [N]
  double c_F = 0;           ///< of the open unit per newton
  double l_s = 0;           ///< in the open unit

  /// l/(N-1) [m].
  [[nodiscard]] double segment() const { return length / static_cast<double>(points - 1); }
};

/// Read once.
[[nodiscard]] const Table1& table_1();

/// Which weight the points of the paper's rod have.
enum class PaperWeight {
  of_the_rod,  ///< rho A l g / N
  printed,     ///< printed_point_weight()
};

/// Weight of a point in Table 5, though Table 1's rod had it [N].
[[nodiscard]] double printed_point_weight();

/// c_c that the text says Fig. 12 was calculated with [N].
[[nodiscard]] double printed_contraction_stiffness();

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
