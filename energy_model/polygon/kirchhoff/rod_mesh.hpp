#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "kirchhoff/rod_span.hpp"
#include "kirchhoff/surface.hpp"

namespace dlo::energy_model {

/// A node of a mesh at which contact with a rigid body begins, ends or is a point.
struct RodContact {
  Eigen::Index node = 0;
  bool moves = false;  ///< its arc length is unknown
  double force = 0;    ///< of the body on the rod there, unknown, along its normal
  std::optional<obstacle::Body> touched;  ///< at this node alone
  std::optional<Surface> surface;         ///< or else that on which the rod lies beside it

  /// Of a point next to it.
  [[nodiscard]] obstacle::Gap gap(const Eigen::Vector3d& r) const {
    return touched ? touched->gap(r) : surface->gap(r);
  }
};

/// What a rod touches.
struct RodContacts {
  std::vector<RodContact> nodes;                ///< by growing arc length
  std::vector<std::optional<Surface>> surface;  ///< of each interval, on which it lies; none: empty

  /// Null: it is free.
  [[nodiscard]] const Surface* surface_of(Eigen::Index interval) const {
    const auto i = static_cast<std::size_t>(interval);
    return i < surface.size() && surface[i] ? &*surface[i] : nullptr;
  }
};

/// The nodes of a span: its ends and those of its parts, grips and loads, and as many between them
/// as are asked for.
struct RodMesh {
  Eigen::VectorXd s;            ///< growing, at least 2
  Eigen::Matrix3Xd load;        ///< on each node
  Eigen::Matrix3Xd couple;      ///< the same
  Eigen::Matrix3Xd own_load;    ///< that follows it, along d1, d2 and t
  Eigen::Matrix3Xd own_couple;  ///< the same
  Eigen::Matrix3Xd pull;        ///< q on each node's tangent, of energy -q.t; zero at first
  Eigen::Matrix3Xd pull_d1;     ///< the same on its d1
  std::vector<const RodSpan::Hold*> hold;  ///< at each node, null for none; of the span
  std::vector<const RodSection*> section;  ///< of each interval; of the span
  RodContacts contacts;

  /// Whether a node is an end, a grip, a load or where another part begins, which stays there.
  [[nodiscard]] bool is_fixed(Eigen::Index node) const {
    const auto i = static_cast<std::size_t>(node);
    return node == 0 || node == intervals() || hold[i] != nullptr || !load.col(node).isZero(0) ||
           !couple.col(node).isZero(0) || !own_load.col(node).isZero(0) ||
           !own_couple.col(node).isZero(0) || section[i - 1] != section[i];
  }
  [[nodiscard]] Eigen::Index intervals() const { return s.size() - 1; }
  [[nodiscard]] double width(Eigen::Index interval) const { return s[interval + 1] - s[interval]; }
  [[nodiscard]] const RodSection& section_of(Eigen::Index interval) const {
    return *section[static_cast<std::size_t>(interval)];
  }
};

/// Where s is, or would be inserted, among nodes.
[[nodiscard]] Eigen::Index node_at(const Eigen::VectorXd& nodes, double s);

/// @param longest  no interval is longer; between two grips there are eight at least
/// @param further  arc lengths that have to be nodes
[[nodiscard]] RodMesh make_mesh(const RodSpan& span, double longest,
                                const std::vector<double>& further = {});

/// The mesh with given nodes, the span's ends, parts, grips and loads among them.
[[nodiscard]] RodMesh mesh_at(const RodSpan& span, const Eigen::VectorXd& nodes);

/// The inner force n, of what lies beyond on what lies before, if the first grip alone carried
/// weight and loads.
struct ForceField {
  Eigen::Matrix3Xd on_interval;  ///< in the middle of each interval
  Eigen::Matrix3Xd after_node;
};
[[nodiscard]] ForceField carried_force(const RodSpan& span, const RodMesh& mesh);

}  // namespace dlo::energy_model
