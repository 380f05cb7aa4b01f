#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "dlo/obstacle/body.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {

/// Where a contact of a shape stands in a mesh.
struct PlacedContact {
  ContactPart part;
  Eigen::Index begin = 0;                  ///< node; of what lies the first one
  Eigen::Index end = 0;                    ///< node
  std::optional<std::size_t> begin_force;  ///< of RodContacts::nodes; none: a grip's
  std::optional<std::size_t> end_force;    ///< the same; of a point none
};

/// The whole rod in its own units, and cross-sections from which to shoot.
struct ContactStart {
  RodSpan span;
  RodMesh mesh;  ///< of that span
  ClampFrames frames;
  std::vector<RodState> states;
  std::vector<PlacedContact> contacts;
  std::vector<obstacle::Body> bodies;
};

/// From a shape that says which parts of the rod touch which obstacles.
/// @return nothing where that is not known here: the rod lies on both sides of a grip, or next to
///         where it lies elsewhere, or something else acts on what lies
[[nodiscard]] std::optional<ContactStart> start_with_contacts(const Problem& problem,
                                                              const Equilibrium& shape,
                                                              double tolerance);

}  // namespace dlo::energy_model
