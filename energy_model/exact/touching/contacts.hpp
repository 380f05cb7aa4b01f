#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "dlo/obstacle/body.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Position of a contact of a shape in a mesh.
struct PlacedContact {
  ContactPart part;
  Eigen::Index begin = 0;  ///< node of a point contact, or first node of a contact interval
  Eigen::Index end = 0;    ///< last node of a contact interval
  /// Index in RodContacts::nodes; none: a grip carries the force.
  std::optional<std::size_t> begin_force;
  /// Index in RodContacts::nodes for the end of a part that lies; none: a grip carries the force,
  /// or contact at a point.
  std::optional<std::size_t> end_force;
};

/// The whole rod in its own units, with initial cross-sections for shooting.
struct ContactStart {
  RodSpan span;
  RodMesh mesh;  ///< mesh of `span`
  ClampFrames frames;
  std::vector<RodState> states;
  std::vector<PlacedContact> contacts;
  std::vector<obstacle::Body> bodies;
};

/// Creates an initial guess from a shape that states which parts of the rod touch which obstacles.
/// @return std::nullopt for contacts that confirm_contacts() does not support, or if the integrator
/// failed along a part that lies
[[nodiscard]] std::optional<ContactStart> start_with_contacts(const Problem& problem,
                                                              const Equilibrium& shape,
                                                              double tolerance);

/// Returns the equilibrium near a shape that states which parts of the rod touch which obstacles,
/// for an intrinsically straight rod with any grips on rigid bodies of any shape. The result is
/// verified here: gaps, forces and pressures of the right sign, and a positive second variation.
/// @param shape      shape of this problem or of a similar one, with the reactions of its grips,
///                   its contacts, and d1 if the rod has two bending stiffnesses
/// @param tolerance  local error of the integrator
/// @return std::nullopt for another kind of problem, for a shape without samples or without a
/// reaction for each grip, and for contacts that are not supported: a point contact at a grip, a
/// load or a change of section, a part that lies across one of these, or two parts that lie next to
/// each other
[[nodiscard]] std::optional<Equilibrium> confirm_contacts(const Problem& problem,
                                                          const Equilibrium& shape,
                                                          double tolerance,
                                                          const Deadline& deadline);

}  // namespace dlo::energy_model
