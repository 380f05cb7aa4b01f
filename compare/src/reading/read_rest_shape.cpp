#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>

#include "dlo/compare/error.hpp"
#include "dlo/compare/rest_shape.hpp"
#include "dlo/compare/shape_file.hpp"
#include "reading/read_parts.hpp"
#include "toml/strict_table.hpp"
#include "trajectory/read_trajectory.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::compare {
namespace {

/// Reads the points of a file, or rows of three numbers, or of six with d1.
MeasuredShape read_rest_points(StrictTable& rod, const std::string& scene_file) {
  constexpr const char* key = "rest_shape";
  constexpr const char* allowed =
      "(allowed: a file of points in m beside the scene, as CSV with the columns x,y,z and, with "
      "frames, d1_x,d1_y,d1_z, or rows [[x, y, z], ..])";
  if (!rod.is(key, toml::node_type::array)) {
    const std::string name = rod.text(key);
    const std::string file = file_of_shape(path_beside(name, scene_file));
    return parse_shape(read_referenced_file(rod, key, file, allowed), name);
  }
  const Eigen::MatrixXd rows = rod.points(key);
  return shape_of(rows.topRows<3>(), {}, "the points",
                  rows.rows() == 6 ? Eigen::Matrix3Xd(rows.bottomRows<3>()) : Eigen::Matrix3Xd());
}

}  // namespace

void read_natural_strains(StrictTable& rod, Scene& scene) {
  const std::vector<Eigen::Vector2d> curvature = rod.pairs("natural_curvature");
  if (!curvature.empty()) {
    scene.natural_strain.head<2>() = curvature.front();
    scene.natural_variation.assign(curvature.begin() + 1, curvature.end());
  }
  if (std::optional<StrictTable> helix = rod.optional_table("helix")) {
    const double radius = helix->number("radius");
    const double pitch = helix->number("pitch");
    helix->finish();
    scene.natural_strain = helix_strain(radius, pitch);
  }
}

void read_rest_shape(StrictTable& rod, const std::vector<StrictTable>& sections, Scene& scene) {
  if (!rod.has("rest_shape")) return;
  for (const StrictTable& section : sections) {
    section.refuse({"natural_curvature", "natural_twist"},
                   "given in addition to rod.rest_shape, which defines it along the whole rod "
                   "(allowed: one of the two)");
  }
  try {
    scene.set_rest_shape(fit_rest_shape(read_rest_points(rod, scene.file), scene.length));
  } catch (const InputError& error) {
    // The table's own errors name the position already.
    if (!error.key().empty()) throw;
    rod.fail("rest_shape", error.what());
  }
}

}  // namespace dlo::compare
