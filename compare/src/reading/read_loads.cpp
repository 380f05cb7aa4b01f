#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "reading/read_parts.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

/// Returns the cross-section that displaces the medium [m^2]; a tube is closed at its ends, so that
/// its bore is included; 0 if the section is not given.
double displaced_area(const Scene& scene) {
  if (scene.width > 0) return scene.width * scene.thickness;
  return std::numbers::pi * scene.diameter * scene.diameter / 4;
}

/// Reads the drag on the rod, by Morison's law with the rod's diameter; std::nullopt without the
/// key `velocity`.
std::optional<energy_model::Drag> read_drag(StrictTable& table, double density, double diameter) {
  if (!table.has("velocity")) return std::nullopt;
  if (!(diameter > 0)) {
    table.fail("velocity",
               "drag on a flat rod is not modelled (allowed: [rod] with diameter, or no velocity)");
  }
  energy_model::Drag drag;
  drag.velocity = table.vector("velocity");
  const double unit = density * diameter / 2;
  drag.normal = unit * table.number("normal_drag");
  table.read("tangential_drag", drag.tangential);
  drag.tangential *= std::numbers::pi * unit;
  return drag;
}

}  // namespace

PointLoad read_load(StrictTable& table, const Scene& scene) {
  PointLoad load;
  load.at = read_arc_length(table, "at", scene.length);
  const bool has_mass = table.read("mass", load.mass);
  const bool has_torque = table.read("torque", load.torque);
  table.read("follows", load.follows);
  if (has_mass) {
    if (load.follows) {
      table.fail("follows",
                 "the weight of a mass keeps its direction (allowed: with force or torque)");
    }
    load.force = load.mass * scene.gravity;
  } else if (!table.read("force", load.force) && !has_torque) {
    table.fail("force",
               "missing, and so are mass and torque (allowed: force or mass, torque, or one of the "
               "two with torque)");
  }
  table.finish();
  return load;
}

DistributedLoad read_distributed_load(StrictTable& table, const Scene& scene) {
  DistributedLoad load{0, scene.length, {}};
  if (table.has("from")) load.from = read_arc_length(table, "from", scene.length);
  if (table.has("to")) load.to = read_arc_length(table, "to", scene.length);
  if (!(load.to > load.from)) {
    table.fail(
        table.has("to") ? "to" : "from",
        fmt::format("the load ends at {:g} m, where it begins or before (allowed: to > from, "
                    "which are 0 and the rod's length if not given)",
                    load.to));
  }
  load.force_per_length = table.vectors("force_per_length");
  table.finish();
  return load;
}

void read_medium(StrictTable& table, Scene& scene) {
  const double density = table.number("density");
  const double section = displaced_area(scene);
  if (!(section > 0)) {
    table.fail("density",
               "the rod's volume is not known (allowed: [rod] with diameter, or with width and "
               "thickness, or no [medium])");
  }
  scene.drag = read_drag(table, density, scene.diameter);
  if (scene.drag && scene.drag->largest() > 0 && !scene.obstacles.empty()) {
    table.fail(
        "velocity",
        "no model supports drag together with obstacles (allowed: one of the two, or no velocity)");
  }
  table.finish();
  scene.distributed_loads.push_back({0, scene.length, {-density * section * scene.gravity}});
}

void check_turning_loads(const Scene& scene, const std::vector<StrictTable>& entries) {
  constexpr double at_clamp = 1e-9;  // divided by the length; as in energy_model
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const PointLoad& load = scene.loads[i];
    if (load.torque.isZero(0) && !load.follows) continue;
    if (!scene.obstacles.empty()) {
      entries[i].fail(load.follows ? "follows" : "torque",
                      "no model supports this together with obstacles (allowed: no obstacles, or "
                      "forces that keep their direction)");
    }
    if (!load.follows) continue;
    const auto clamped = [&](const Gripper& gripper) {
      return gripper.direction && std::abs(gripper.at - load.at) <= at_clamp * scene.length;
    };
    if (std::any_of(scene.grippers.begin(), scene.grippers.end(), clamped)) {
      entries[i].fail("follows",
                      "not supported at the position of a clamp (allowed: true elsewhere)");
    }
  }
}

}  // namespace dlo::compare
