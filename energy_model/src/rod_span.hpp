#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/energy_model/plane.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// A piece of rod between two clamps, or between a clamp and a free end, or the whole of a rod
/// without clamps. Lengths in l, forces in EI/l^2; s runs along the arc length from the piece's
/// beginning, positions are relative to the problem's first grip.
struct RodSpan {
  struct Hold {
    double at = 0;  ///< s
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::size_t grip = 0;  ///< in Problem::grips
  };
  struct Load {
    double at = 0;  ///< s
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
  };
  /// What clamps at both ends that hold the rod's frame ask for.
  struct Twist {
    double stiffness = 0;  ///< GJ / EI
    double roll = 0;       ///< of the end less that of the beginning [rad]
    /// First directors, across the directions, unit; of both ends or of none.
    std::optional<Eigen::Vector3d> start_d1, end_d1;
  };
  double begin = 0;  ///< arc length of s = 0
  double length = 1;
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> start_direction;  ///< unit; free if not given
  std::optional<Eigen::Vector3d> end_direction;
  std::vector<Hold> holds;     ///< by growing s, those of the clamps at the ends included
  std::vector<Load> loads;     ///< by growing s; those on clamps are the gripper's alone
  std::optional<Plane> plane;  ///< if grips and forces lie in one
  std::optional<Twist> twist;  ///< nothing: the torque M is zero
};

/// Cuts a problem at its clamps. Grips within 1e-9 l of an end of the rod are at that end.
/// @throws std::invalid_argument if the problem is out of range, has walls, or grips are further
/// apart than the rod between them
[[nodiscard]] std::vector<RodSpan> cut_at_clamps(const Problem& problem);

/// The nodes of a span: ends, grips and loads, and as many between them as are asked for.
struct RodMesh {
  Eigen::VectorXd s;      ///< growing, at least 2
  Eigen::Matrix3Xd load;  ///< on each node
  Eigen::Matrix3Xd pull;  ///< q on each node's tangent, of energy -q.t; zero at first
  std::vector<const RodSpan::Hold*> hold;  ///< at each node, null for none; of the span

  [[nodiscard]] Eigen::Index intervals() const { return s.size() - 1; }
};

/// @param longest  no interval is longer; between two grips there are eight at least
[[nodiscard]] RodMesh make_mesh(const RodSpan& span, double longest);

/// The mesh with given nodes, the span's ends, grips and loads among them.
[[nodiscard]] RodMesh mesh_at(const RodSpan& span, const Eigen::VectorXd& nodes);

/// The inner force n, of what lies beyond on what lies before, if the first grip alone carried
/// weight and loads.
struct ForceField {
  Eigen::Matrix3Xd on_interval;  ///< in the middle of each interval
  Eigen::Matrix3Xd after_node;
};
[[nodiscard]] ForceField carried_force(const RodSpan& span, const RodMesh& mesh);

/// Sum of the norms of weight and loads.
[[nodiscard]] double total_load(const RodSpan& span);

}  // namespace dlo::energy_model
