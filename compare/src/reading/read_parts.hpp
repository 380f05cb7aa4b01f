#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/trajectory.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Reads an arc length on the rod; one that is beyond an end by rounding is moved to that end.
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] double read_arc_length(StrictTable& table, std::string_view key, double length);

/// Reads a direction of any length > 0 and returns the unit vector.
[[nodiscard]] Eigen::Vector3d unit_vector(StrictTable& table, std::string_view key);

/// Reads a position. If there are poses, the first of them gives the position, and the key is
/// refused.
[[nodiscard]] Eigen::Vector3d read_place(StrictTable& table, const char* key,
                                         const Trajectory& trajectory);

/// Reads the table [rod] and the tables [[section]] into a scene whose gravity is known.
/// @throws InputError that names file, line, key, value and what is allowed
void read_rod(StrictTable& rod, std::vector<StrictTable>& sections,
              const std::vector<Material>& known_materials, Scene& scene);

/// Reads the natural curvature of a table [rod], or the curvature and twist of its helix; the key
/// natural_twist is read by read_members().
/// @throws InputError that names file, line, key, value and what is allowed
void read_natural_strains(StrictTable& rod, Scene& scene);

/// Reads the points of the stress-free shape, if there are any.
/// @param sections  the tables of the rod's sections, which have been read
/// @throws InputError that names file, line, key, value and what is allowed
void read_rest_shape(StrictTable& rod, const std::vector<StrictTable>& sections, Scene& scene);

/// Reads the material of a table [rod] or of a layer, by its name or as a table.
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] Material read_material(StrictTable& rod,
                                     const std::vector<Material>& known_materials);

/// Reads a cable's section, mass and stiffness. @return whether the rod has layers
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] bool read_layers(StrictTable& rod, const std::vector<Material>& known_materials,
                               Scene& scene);

/// Reads a table [[gripper]] of a scene whose rod and obstacles have been read.
/// @throws InputError that names file, line, key, value and what is allowed; also if the gripper is
/// behind or within an obstacle, or so near that the rod's surface would be
[[nodiscard]] Gripper read_gripper(StrictTable& table, const Scene& scene);

/// Checks that GJ is given or assumed if two clamps hold the rod's frame.
/// @param rod  table of the rod
void check_twist(const Scene& scene, const StrictTable& rod);

/// Checks that a clamp determines the direction in which a rod is intrinsically curved, and its
/// principal axes.
/// @param sections  tables of the rod's sections
void check_material_directors(const Scene& scene, const StrictTable& rod,
                              const std::vector<StrictTable>& sections);

/// Checks that the grips alone determine the reference of each roll.
/// @param entries  the grippers' tables, in the scene's order
void check_rolls(const Scene& scene, const std::vector<StrictTable>& entries);

/// Reads a table [[load]] of a scene whose rod has been read.
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] PointLoad read_load(StrictTable& table, const Scene& scene);

/// Reads a table [[distributed_load]] of a scene whose rod has been read.
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] DistributedLoad read_distributed_load(StrictTable& table, const Scene& scene);

/// Reads [medium], whose buoyancy becomes a distributed load, into a scene whose rod and obstacles
/// have been read.
void read_medium(StrictTable& table, Scene& scene);

/// Checks couples and follower loads: no model takes them in a scene with obstacles, and a follower
/// load must not be at a clamp.
/// @param entries  the loads' tables, in the scene's order
void check_turning_loads(const Scene& scene, const std::vector<StrictTable>& entries);

/// Reads a table [[obstacle]] of a scene whose rod has been read.
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] Obstacle read_obstacle(StrictTable& table, const Scene& scene);

}  // namespace dlo::compare
