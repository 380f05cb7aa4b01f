#include "reading/read_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "reading/read_parts.hpp"
#include "scene/members.hpp"
#include "toml/strict_table.hpp"
#include "trajectory/read_trajectory.hpp"
#include "trajectory/trajectory_files.hpp"

namespace dlo::compare {
namespace {

/// Returns the points of a whole rod's shape as rows at time 0. If the shape has no arc lengths,
/// those along the polyline are scaled to the rod.
/// @param length  of the rod [m]
std::vector<MarkerPosition> rows_of_shape(const MeasuredShape& shape, double length) {
  std::vector<double> s = shape.arc_length;
  if (s.empty()) {
    s.assign(1, 0);
    for (Eigen::Index i = 1; i < shape.points.cols(); ++i) {
      s.push_back(s.back() + (shape.points.col(i) - shape.points.col(i - 1)).norm());
    }
    const double polyline = s.back();
    for (double& at : s) at = std::min(length, at * length / polyline);
  }
  std::vector<MarkerPosition> rows;
  for (std::size_t i = 0; i < s.size(); ++i) {
    rows.push_back({0, s[i], shape.points.col(static_cast<Eigen::Index>(i))});
  }
  std::ranges::sort(rows, {}, &MarkerPosition::arc_length);
  return rows;
}

/// Reads the rows of a recording, or of a shape, whose points then have time 0.
std::shared_ptr<const MarkerMotion> read_start(StrictTable& rates, const Scene& scene) {
  const std::optional<std::string> name = rates.optional_text("start");
  if (!name) return nullptr;
  constexpr const char* allowed =
      "(allowed: a file of points in m beside the scene, as CSV with the columns x,y,z and perhaps "
      "s, or a recording with the columns time,s,x,y,z)";
  const std::string text =
      read_referenced_file(rates, "start", file_of_shape(path_beside(*name, scene.file)), allowed);
  MarkerMotion start{.file = *name, .positions = {}};
  try {
    if (has_column(text, "time")) {
      start = parse_markers(text, *name);
    } else {
      start.positions = rows_of_shape(parse_shape(text, *name), scene.length);
    }
  } catch (const InputError& error) {
    rates.fail("start", fmt::format("{} {}", error.what(), allowed));
  }
  for (const MarkerPosition& at : start.positions) {
    if (on_rod(at.arc_length, scene.length)) continue;
    rates.fail("start", fmt::format("a point at s = {:g} m (allowed: 0 to the rod's {:g} m)",
                                    at.arc_length, scene.length));
  }
  return std::make_shared<const MarkerMotion>(std::move(start));
}

void read_track(StrictTable& rates, Scene& scene) {
  rates.read("frame_rate", scene.track.frame_rate);
  rates.read("obstacle_rate", scene.track.obstacle_rate);
  rates.read("step_rate", scene.track.step_rate);
  scene.start = read_start(rates, scene);
  rates.finish();
}

}  // namespace

Scene read_scene(const toml::table& root, const std::string& file,
                 const std::vector<Material>& known_materials) {
  StrictTable table(root, "", file);
  table.use_rows_of("");
  Scene scene;
  scene.file = file;
  if (!table.read("name", scene.name)) scene.name = valid_utf8(file);
  table.read("gravity", scene.gravity);

  if (!table.has("rod")) {
    table.fail("rod", "missing, it is required (dlo init writes a scene to start from)");
  }
  StrictTable rod = table.table("rod");
  std::vector<StrictTable> sections = table.tables("section");
  read_rod(rod, sections, known_materials, scene);

  for (StrictTable& entry : table.tables("obstacle")) {
    scene.obstacles.push_back(read_obstacle(entry, scene));
  }
  std::vector<StrictTable> grippers = table.tables("gripper");
  for (StrictTable& entry : grippers) {
    scene.grippers.push_back(read_gripper(entry, scene));
  }
  if (scene.grippers.empty()) {
    throw InputError(fmt::format(
        "{}: gripper: none given, nothing would hold the rod (allowed: one or more [[gripper]])",
        file));
  }
  check_twist(scene, rod);
  std::vector<StrictTable> loads = table.tables("load");
  for (StrictTable& entry : loads) scene.loads.push_back(read_load(entry, scene));
  for (StrictTable& entry : table.tables("distributed_load")) {
    scene.distributed_loads.push_back(read_distributed_load(entry, scene));
  }
  if (auto medium = table.optional_table("medium")) {
    read_medium(*medium, scene);
  }
  check_material_directors(scene, rod, sections);
  check_turning_loads(scene, loads);
  check_rolls(scene, grippers);
  if (auto settings = table.optional_table("force_model")) {
    scene.force_model = read_force_model(*settings);
    check(scene.force_model, settings->where());
  }
  if (auto rates = table.optional_table("track")) read_track(*rates, scene);
  table.finish();
  return scene;
}

}  // namespace dlo::compare
