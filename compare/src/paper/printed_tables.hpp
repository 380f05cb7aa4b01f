#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// Returns data/paper/tables.toml: the paper's tables as printed, digit by digit.
[[nodiscard]] const toml::table& printed_tables();

/// Returns a number of table_1 or table_5 as printed, in the unit that the key names.
/// @throws std::out_of_range if the file has no such number
[[nodiscard]] double printed(std::string_view table, std::string_view key);

/// Table 1 in SI units, except for two entries that contain a length in an unstated unit.
struct Table1 {
  double length = 0;        ///< [m]
  double mass = 0;          ///< [kg]
  Eigen::Index points = 0;  ///< N
  double c_c = 0;           ///< [N]
  double c_b = 0;           ///< [N]
  double grip_force = 0;    ///< force at a displacement of 5 % of a segment [N]
  double point_weight = 0;  ///< [N]
  double c_F = 0;           ///< [unstated unit of length per newton]
  double l_s = 0;           ///< [unstated unit of length]

  /// Returns the length of a segment, l/(N-1) [m].
  [[nodiscard]] double segment() const { return length / static_cast<double>(points - 1); }
};

/// Returns Table 1, which is read once.
[[nodiscard]] const Table1& table_1();

/// Weight of the points of the paper's rod.
enum class PaperWeight {
  from_rod,  ///< rho A l g / N
  printed,   ///< printed_point_weight()
};

/// Returns the weight of a point as printed in Table 5 [N]. The number is an error of the paper: it
/// is the weight of a point of Table 1's rod.
[[nodiscard]] double printed_point_weight();

/// Returns the c_c with which Fig. 12 was calculated, according to the text [N].
[[nodiscard]] double printed_contraction_stiffness();

/// Number that the paper prints, with the value of its formula.
struct TableRow {
  std::string table;        ///< number of the table in the paper
  std::string quantity;     ///< symbol as printed
  std::string unit;         ///< unit as printed
  std::string printed;      ///< digits as printed
  double computed = 0;      ///< value of the formula, in `unit`
  std::string explanation;  ///< formula and its inputs
  bool agrees = false;      ///< whether `computed`, rounded to the printed digits, equals `printed`
};

/// Recomputes Tables 1 and 5 from the quantities from which, according to the paper, they follow.
[[nodiscard]] std::vector<TableRow> recompute_tables();

}  // namespace dlo::compare
