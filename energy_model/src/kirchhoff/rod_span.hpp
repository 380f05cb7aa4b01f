#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/energy_model/plane.hpp"
#include "dlo/energy_model/problem.hpp"
#include "dlo/energy_model/turns.hpp"
#include "kirchhoff/rod_flow.hpp"

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
  /// Of one section.
  struct Part {
    double begin = 0;  ///< s
    double end = 0;    ///< s
    RodSection section;
  };
  /// What clamps at both ends that hold the rod's frame ask for.
  struct Twist {
    double compliance = 0;             ///< int EI / GJ ds
    Eigen::Vector3d start_d1, end_d1;  ///< across the directions, unit, not rolled
    HeldTurns turns;
  };
  double begin = 0;  ///< arc length of s = 0
  double length = 1;
  std::vector<Part> parts;                         ///< by growing s, from 0 to its length
  std::optional<Eigen::Vector3d> start_direction;  ///< unit; free if not given
  std::optional<Eigen::Vector3d> end_direction;
  std::vector<Hold> holds;     ///< by growing s, those of the clamps at the ends included
  std::vector<Load> loads;     ///< by growing s; those on clamps are the gripper's alone
  std::optional<Plane> plane;  ///< if grips and forces lie in one
  std::optional<Twist> twist;  ///< nothing: the torque M is zero
};

/// Cuts a problem at its clamps. Grips within 1e-9 l of an end of the rod are at that end.
/// @throws std::invalid_argument if the problem is out of range, has obstacles, or grips are
/// further apart than the rod between them
[[nodiscard]] std::vector<RodSpan> cut_at_clamps(const Problem& problem);

/// All of the rod as one span without directions; loads on clamps are the gripper's and the span's.
/// @throws std::invalid_argument as cut_at_clamps()
[[nodiscard]] RodSpan uncut(const Problem& problem);

/// The nodes of a span: its ends and those of its parts, grips and loads, and as many between them
/// as are asked for.
struct RodMesh {
  Eigen::VectorXd s;      ///< growing, at least 2
  Eigen::Matrix3Xd load;  ///< on each node
  Eigen::Matrix3Xd pull;  ///< q on each node's tangent, of energy -q.t; zero at first
  std::vector<const RodSpan::Hold*> hold;  ///< at each node, null for none; of the span
  std::vector<const RodSection*> section;  ///< of each interval; of the span

  [[nodiscard]] Eigen::Index intervals() const { return s.size() - 1; }
  [[nodiscard]] double width(Eigen::Index interval) const { return s[interval + 1] - s[interval]; }
  [[nodiscard]] const RodSection& section_of(Eigen::Index interval) const {
    return *section[static_cast<std::size_t>(interval)];
  }
};

/// @param longest  no interval is longer; between two grips there are eight at least
[[nodiscard]] RodMesh make_mesh(const RodSpan& span, double longest);

/// The mesh with given nodes, the span's ends, parts, grips and loads among them.
[[nodiscard]] RodMesh mesh_at(const RodSpan& span, const Eigen::VectorXd& nodes);

/// The inner force n, of what lies beyond on what lies before, if the first grip alone carried
/// weight and loads.
struct ForceField {
  Eigen::Matrix3Xd on_interval;  ///< in the middle of each interval
  Eigen::Matrix3Xd after_node;
};
[[nodiscard]] ForceField carried_force(const RodSpan& span, const RodMesh& mesh);

/// The section at s; of two that meet there the one after it.
[[nodiscard]] const RodSection& section_at(const RodSpan& span, double s);

/// Least bending stiffness of a span, about either axis.
[[nodiscard]] double softest(const RodSpan& span);

/// Sum of the norms of weight and loads.
[[nodiscard]] double total_load(const RodSpan& span);

}  // namespace dlo::energy_model
