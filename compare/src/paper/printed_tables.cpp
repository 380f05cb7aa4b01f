#include "paper/printed_tables.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "scene/builtin_data.hpp"
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

}  // namespace dlo::compare
