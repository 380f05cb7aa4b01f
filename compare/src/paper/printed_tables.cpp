#include "paper/printed_tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/builtin_data.hpp"
#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/force_model/heuristics.hpp"
#include "polygon/point_layout.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

const toml::table& printed_tables() {
  static const toml::table tables =
      parse_toml(std::string(builtin::tables_toml), "data/paper/tables.toml");
  return tables;
}

double printed(std::string_view table, std::string_view key) {
  const auto number = printed_tables()[table][key].value<double>();
  if (!number) throw std::out_of_range(fmt::format("data/paper: {} has no {}", table, key));
  return *number;
}

const Table1& table_1() {
  const auto value = [](const char* key) { return printed("table_1", key); };
  static const Table1 table = {.length = value("length_cm") / 100,
                               .mass = value("mass_kg"),
                               .points = static_cast<Eigen::Index>(value("points")),
                               .c_c = value("c_c"),
                               .c_b = value("c_b"),
                               .grip_force = value("c_e_gripper_N"),
                               .point_weight = -value("c_e_gravity_N"),
                               .c_F = value("c_F"),
                               .l_s = value("l_s")};
  return table;
}

double printed_point_weight() { return -printed("table_5", "c_e_gravity_N"); }

double printed_contraction_stiffness() { return printed("table_5", "c_c_used"); }

namespace {

/// Reads printed values of one table, and compares computed values with them, row by row.
class PrintedTable {
 public:
  explicit PrintedTable(std::string name) : name_(std::move(name)) {}

  [[nodiscard]] double value(std::string_view key) const { return printed(name_, key); }

  [[nodiscard]] TableRow row(std::string_view key, const std::string& quantity,
                             const std::string& unit, int decimals, double computed,
                             const std::string& explanation) const {
    TableRow row{name_ == "table_1" ? "1" : "5",
                 quantity,
                 unit,
                 fmt::format("{:.{}f}", value(key), decimals),
                 computed,
                 explanation};
    row.agrees = fmt::format("{:.{}f}", computed, decimals) == row.printed;
    return row;
  }

 private:
  std::string name_;
};

constexpr double gravity = 9.81;  // [m/s^2]; the paper does not state a value

void add_table_1(std::vector<TableRow>& rows) {
  using force_model::Formula13;
  const PrintedTable table("table_1");
  const double mass = table_1().mass;
  const auto points = static_cast<double>(table_1().points);
  const double length = table_1().length;
  const double force = 0.8 * mass * gravity;
  const double angle = 2.5 * std::numbers::pi / 180;
  rows.push_back(table.row("c_c", "c_c", "N", 5, force_model::contraction_stiffness(force, 5),
                           "Formula 11 with F = 0.8 m g = 0.07848 N at 5 %; F = 0.981 N of the "
                           "remark gives 19.62 N, F = m g gives 1.962 N"));
  rows.push_back(table.row(
      "c_b", "c_b", "N", 5, force_model::bending_stiffness(force, angle, Formula13::table_1),
      fmt::format(
          "Formula 13 with cos(alpha) in place of the printed sin(pi - alpha), F = 0.07848 N "
          "at 2.5 deg; as printed it gives {:.2f}",
          force_model::bending_stiffness(force, angle, Formula13::printed))));
  rows.push_back(table.row(
      "c_e_gravity_N", "c_e (grav)", "N", 5, -mass * gravity / (points + 1),
      fmt::format("m g / 11, although N = 10; m g / N would be {:.5f}", -mass * gravity / points)));
  rows.push_back(table.row(
      "c_F", "c_F", "m/N", 5, table_1_step_share * (length / points) / (2 * table_1().c_c),
      "no formula in the paper; 0.86 of the largest stable step L/(2 c_c) with L = l/N, "
      "and 0.78 of it with L = l/(N-1); Tables 2 and 4 require cm/N instead"));
  rows.push_back(
      table.row("l_s", "l_s", "m", 5, table_1_limit_share * length / points,
                "no formula in the paper; 0.6 of l/N; Tables 2 and 4 require cm instead"));
}

void add_table_5(std::vector<TableRow>& rows) {
  const PrintedTable table("table_5");
  const double E = table.value("youngs_modulus_N_per_mm2") * 1e6;
  const double d = table.value("diameter_mm") / 1000;
  const double l = table.value("length_cm") / 100;
  const double rho = table.value("density_kg_per_dm3") * 1000;
  const double k = table.value("k_per_mm") * 1000;
  const double N = table.value("points");
  const double A = std::numbers::pi * d * d / 4;
  const double EI = E * A * d * d / 16;
  const double L = l / (N - 1);
  rows.push_back(
      table.row("mass_kg", "m", "kg", 3, rho * A * l, "rho A l; the print rounds it up"));
  rows.push_back(table.row("c_c", "c_c", "N", 0, A * E, "A E, as Formula 11 asks"));
  rows.push_back(table.row(
      "c_b", "c_b", "N", 2, paper_bending_stiffness(BendingRule::formula_21, EI, k, L),
      fmt::format("Formula 21 with alpha_l = l k/(N-1) = {:.5f} rad; moment-matched at the "
                  "same bending it would be {:.2f}",
                  L * k, paper_bending_stiffness(BendingRule::moment_matched, EI, k, L))));
  rows.push_back(table.row("c_e_gripper_N", "c_e (gripper)", "N", 3, rho * A * l * gravity,
                           fmt::format("m g; printed as in Table 1. Over 5 % of a segment it is "
                                       "{:.1f} N/m",
                                       rho * A * l * gravity / (0.05 * L))));
  rows.push_back(table.row("c_e_gravity_N", "c_e (grav)", "N", 5, -rho * A * l * gravity / N,
                           "rho A l g / 16; the printed number is Table 1's, of another rod"));
}

}  // namespace

std::vector<TableRow> recompute_tables() {
  std::vector<TableRow> rows;
  add_table_1(rows);
  add_table_5(rows);
  return rows;
}

}  // namespace dlo::compare
