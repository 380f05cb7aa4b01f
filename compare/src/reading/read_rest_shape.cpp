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

/// Largest number of Legendre polynomials of the natural curvature; with more, a curvature has more
/// waves than a smooth rod.
constexpr std::size_t most_natural_terms = 24;

/// Checks that the stress-free shape is given in one way only.
void require_one_rest_shape(const StrictTable& rod) {
  for (const char* key : {"helix", "rest_shape"}) {
    for (const char* other : {"natural_curvature", "natural_twist", "helix"}) {
      if (!rod.has(key) || !rod.has(other) || std::string_view(key) == other) continue;
      rod.fail(key, fmt::format("given besides {} (allowed: natural_curvature with natural_twist, "
                                "or helix, or rest_shape)",
                                other));
    }
  }
}

/// Reads the points of a file, or rows of three numbers, or of six with d1.
MeasuredShape read_rest_points(StrictTable& rod, const std::string& scene_file) {
  constexpr const char* key = "rest_shape";
  constexpr const char* allowed =
      "(allowed: a file of points in m beside the scene, as CSV with the columns x,y,z and, with "
      "frames, d1_x,d1_y,d1_z, or rows [[x, y, z], ..])";
  if (!rod.is_array(key)) {
    const std::string name = rod.text(key);
    const std::string file = file_of_shape(path_beside(name, scene_file));
    return parse_shape(read_beside(rod, key, file, allowed), name);
  }
  constexpr std::size_t most = 10'000;
  const Eigen::MatrixXd rows = rod.points(key, most);
  return shape_of(rows.topRows<3>(), {}, "the points",
                  rows.rows() == 6 ? Eigen::Matrix3Xd(rows.bottomRows<3>()) : Eigen::Matrix3Xd());
}

}  // namespace

void read_natural_strains(StrictTable& rod, Scene& scene) {
  require_one_rest_shape(rod);
  const std::vector<Eigen::Vector2d> curvature =
      rod.pairs("natural_curvature", Dimension::curvature, most_natural_terms);
  if (!curvature.empty()) {
    scene.natural_strain.head<2>() = curvature.front();
    scene.natural_variation.assign(curvature.begin() + 1, curvature.end());
  }
  scene.natural_strain.z() =
      rod.optional_number("natural_twist", Dimension::twist, Range::any()).value_or(0);
  if (std::optional<StrictTable> helix = rod.optional_table("helix")) {
    helix->only(scene_keys("helix"));
    const Range size = Range::between(1e-9, 1e6, " m");
    const Range rise = Range::between(-1e6, 1e6, " m, > 0 right-handed, < 0 left-handed");
    const double radius = helix->number("radius", Dimension::length, size);
    const double pitch = helix->number("pitch", Dimension::length, rise);
    helix->finish();
    scene.natural_strain = helix_strain(radius, pitch);
  }
}

void read_rest_shape(StrictTable& rod, const std::vector<StrictTable>& sections, Scene& scene) {
  if (!rod.has("rest_shape")) return;
  for (const StrictTable& section : sections) {
    for (const char* key : {"natural_curvature", "natural_twist"}) {
      if (!section.has(key)) continue;
      section.fail(key,
                   "given besides rod.rest_shape, which defines it along the whole rod (allowed: "
                   "one of the two)");
    }
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
