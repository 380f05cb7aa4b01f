#pragma once

#include <type_traits>

#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

// Each function calls `visit` with the keys of a table that are one member, and the members.

template <typename Visit>
void for_each_member(ForceModelSettings& settings, const Visit& visit) {
  visit("points", settings.points);
  visit("law", settings.law);
  visit("joint_law", settings.joint_law);
  visit("bookkeeping", settings.bookkeeping);
  visit("stepper", settings.stepper);
  visit("bending_rule", settings.bending_rule);
  visit("design_curvature", settings.design_curvature);
  visit("point_weight", settings.point_weight);
  visit("c_b", settings.c_b);
  visit("c_c", settings.c_c);
  visit("c_F", settings.c_F);
  visit("c_h", settings.c_h);
  visit("l_s", settings.l_s);
}

/// @param scene  a Scene or a const Scene
template <typename AnyScene, typename Visit>
requires std::is_same_v<std::remove_const_t<AnyScene>, Scene>
void for_each_member(AnyScene& scene, const Visit& visit) {
  visit("length", scene.length);
  visit("diameter", scene.diameter);
  visit("width", scene.width);
  visit("thickness", scene.thickness);
  visit("mass_per_length", scene.given_mass_per_length);
  visit("axial_stiffness", scene.given_axial_stiffness);
  visit("torsional_stiffness", scene.torsional_stiffness);
  visit("natural_twist", scene.natural_strain.z());
}

template <typename Visit>
void for_each_member(Section& section, const Visit& visit) {
  visit("mass_per_length", section.mass_per_length);
  visit("torsional_stiffness", section.torsional_stiffness);
  visit("natural_curvature", section.natural_curvature);
  visit("natural_twist", section.natural_twist);
}

/// Reads these members by the rows of their keys; a key that is not given leaves its member as it
/// is.
template <typename Owner>
void read_members(StrictTable& table, Owner& owner) {
  for_each_member(owner, [&table](const char* key, auto& member) { table.read(key, member); });
}

/// Reads the table [force_model].
/// @throws InputError that names file, line, key, value and what is allowed; check() rejects
/// settings that contradict each other
[[nodiscard]] ForceModelSettings read_force_model(StrictTable& table);

}  // namespace dlo::compare
