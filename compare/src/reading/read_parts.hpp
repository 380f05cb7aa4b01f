#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/trajectory.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// An arc length of the rod. @throws InputError naming file, line, key, value and what is allowed,
///                                   as the others
[[nodiscard]] double read_arc_length(StrictTable& table, std::string_view key, double length);

/// A direction of any length, made unit.
[[nodiscard]] Eigen::Vector3d unit_vector(StrictTable& table, std::string_view key);

/// Where something is whose poses, if it has any, say so too: the first of them is where it is.
[[nodiscard]] Eigen::Vector3d read_place(StrictTable& table, const char* key,
                                         const Trajectory& trajectory);

/// Reads the table [rod] and the tables [[section]] into a scene whose gravity is known.
/// @throws InputError naming file, line, key, value and what is allowed
void read_rod(StrictTable& rod, std::vector<StrictTable>& sections,
              const std::vector<Material>& known_materials, Scene& scene);

/// Natural curvature and twist of a table [rod], or its helix.
/// @throws InputError naming file, line, key, value and what is allowed
void read_natural_strains(StrictTable& rod, Scene& scene);

/// Its points without stress, if it has some.
/// @param sections  the tables of the rod's sections, which have been read
/// @throws InputError likewise
void read_rest_shape(StrictTable& rod, const std::vector<StrictTable>& sections, Scene& scene);

/// The material of a table [rod], by its name or as a table of its own.
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Material read_material(StrictTable& rod,
                                     const std::vector<Material>& known_materials);

/// A cable's section, mass and stiffness. @return whether the rod has layers
/// @throws InputError likewise
[[nodiscard]] bool read_layers(StrictTable& rod, const std::vector<Material>& known_materials,
                               Scene& scene);

/// Reads a table [[gripper]] of a scene whose rod and obstacles have been read.
/// @throws InputError naming file, line, key, value and what is allowed, as the others; also if it
///         is behind or within an obstacle
[[nodiscard]] Gripper read_gripper(StrictTable& table, const Scene& scene);

/// That two clamps which hold the rod's frame know how it twists.
/// @param rod  its table
void check_twist(const Scene& scene, const StrictTable& rod);

/// That a clamp says which way a rod is intrinsically curved, and where its principal axes are.
/// @param sections  the tables of its sections
void check_material_directors(const Scene& scene, const StrictTable& rod,
                              const std::vector<StrictTable>& sections);

/// That the grips alone say where each roll counts from.
/// @param entries  the grippers' tables, in the scene's order
void check_rolls(const Scene& scene, const std::vector<StrictTable>& entries);

/// Reads a table [[load]] of a scene whose rod has been read.
/// @throws InputError naming file, line, key, value and what is allowed, as the others
[[nodiscard]] PointLoad read_load(StrictTable& table, const Scene& scene);

/// The same of [[distributed_load]].
[[nodiscard]] DistributedLoad read_distributed_load(StrictTable& table, const Scene& scene);

/// Reads [medium] into a scene whose obstacles have been read.
void read_medium(StrictTable& table, Scene& scene);

/// What has no potential, and couples, act on a rod that touches nothing; what follows it, where no
/// clamp holds it.
/// @param entries  the loads' tables, in the scene's order
void check_turning_loads(const Scene& scene, const std::vector<StrictTable>& entries);

/// Reads a table [[obstacle]] of a scene whose rod has been read.
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Obstacle read_obstacle(StrictTable& table, const Scene& scene);

}  // namespace dlo::compare
