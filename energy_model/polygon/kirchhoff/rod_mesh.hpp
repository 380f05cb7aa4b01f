#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "kirchhoff/rod_span.hpp"
#include "kirchhoff/surface.hpp"

namespace dlo::energy_model {

/// Node of a mesh at which contact with a rigid body begins, ends or is a point.
struct RodContact {
  Eigen::Index node = 0;
  bool is_position_unknown = false;  ///< whether its arc length is unknown
  double force = 0;  ///< unknown force of the body on the rod at the node, along the body's normal
  std::optional<obstacle::Body> touched;  ///< body that only this node touches
  std::optional<Surface> surface;  ///< otherwise the surface on which the rod lies beside this node

  /// Returns the gap between a point near this node and the body or surface.
  [[nodiscard]] obstacle::Gap gap(const Eigen::Vector3d& r) const {
    return touched ? touched->gap(r) : surface->gap(r);
  }
};

/// Contacts of a rod.
struct RodContacts {
  std::vector<RodContact> nodes;  ///< nodes of contact by growing arc length
  /// Surface on which each interval lies; empty: no interval lies.
  std::vector<std::optional<Surface>> surface;

  /// Returns the surface on which an interval lies; null if it is free.
  [[nodiscard]] const Surface* surface_of(Eigen::Index interval) const {
    const auto i = static_cast<std::size_t>(interval);
    return i < surface.size() && surface[i] ? &*surface[i] : nullptr;
  }
};

/// Nodes of a span: its ends, the ends of its parts, grips, loads, and as many nodes between them
/// as requested.
struct RodMesh {
  Eigen::VectorXd s;                 ///< arc lengths of the nodes, growing, at least 2
  Eigen::Matrix3Xd load;             ///< force on each node
  Eigen::Matrix3Xd couple;           ///< couple on each node
  Eigen::Matrix3Xd follower_load;    ///< force that follows the rod, along its d1, d2 and t
  Eigen::Matrix3Xd follower_couple;  ///< couple that follows the rod, along its d1, d2 and t
  /// Vector q on each node's tangent with the energy -q.t; initially zero.
  Eigen::Matrix3Xd tangent_force;
  Eigen::Matrix3Xd d1_force;  ///< vector q on each node's d1 with the energy -q.d1; initially zero
  std::vector<const RodSpan::Hold*> hold;  ///< grip of the span at each node; null: none
  std::vector<const RodSection*> section;  ///< section of the span in each interval
  RodContacts contacts;

  /// Whether a node has a fixed arc length: an end, a grip, a load, or the begin of another part.
  [[nodiscard]] bool is_fixed(Eigen::Index node) const {
    const auto i = static_cast<std::size_t>(node);
    return node == 0 || node == intervals() || hold[i] != nullptr || !load.col(node).isZero(0) ||
           !couple.col(node).isZero(0) || !follower_load.col(node).isZero(0) ||
           !follower_couple.col(node).isZero(0) || section[i - 1] != section[i];
  }
  [[nodiscard]] Eigen::Index intervals() const { return s.size() - 1; }
  [[nodiscard]] double width(Eigen::Index interval) const { return s[interval + 1] - s[interval]; }
  [[nodiscard]] const RodSection& section_of(Eigen::Index interval) const {
    return *section[static_cast<std::size_t>(interval)];
  }
};

/// Returns the index of the first node whose arc length is not less than s.
[[nodiscard]] Eigen::Index node_at(const Eigen::VectorXd& nodes, double s);

/// Creates a mesh with equal intervals between fixed nodes.
/// @param longest  largest length of an interval; between two grips there are at least eight
///                 intervals
/// @param further  additional arc lengths of nodes
[[nodiscard]] RodMesh make_mesh(const RodSpan& span, double longest,
                                const std::vector<double>& further = {});

/// Creates the mesh with given nodes, which have to include the span's ends, parts, grips and
/// loads.
[[nodiscard]] RodMesh mesh_at(const RodSpan& span, const Eigen::VectorXd& nodes);

/// Inner force n, of the part beyond on the part before, if the first grip alone carried weight and
/// loads. Drag and loads that follow the rod are not included.
struct ForceField {
  Eigen::Matrix3Xd on_interval;  ///< force in the middle of each interval
  Eigen::Matrix3Xd after_node;
};
[[nodiscard]] ForceField internal_force(const RodSpan& span, const RodMesh& mesh);

}  // namespace dlo::energy_model
