#include "reading/read_place.hpp"

#include <fmt/format.h>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

double read_arc_length(StrictTable& table, std::string_view key, double length) {
  Range range = Range::between(0, length, " m, the rod's length");
  range.low -= arc_rounding * length;
  range.high += arc_rounding * length;
  return *on_rod(table.number(key, Dimension::length, range), length);
}

Eigen::Vector3d unit_vector(StrictTable& table, std::string_view key) {
  const Eigen::Vector3d vector = table.vector(key, Dimension::number);
  if (!(vector.norm() > 0)) table.fail(key, "must not be the zero vector");
  return vector.normalized();
}

Eigen::Vector3d read_place(StrictTable& table, const char* key, const Trajectory& trajectory) {
  if (trajectory.empty()) return table.vector(key, Dimension::length);
  if (table.has(key)) {
    table.fail(key,
               fmt::format("given besides poses, which say where it is (allowed: no {})", key));
  }
  return trajectory.poses().front().position;
}

}  // namespace dlo::compare
