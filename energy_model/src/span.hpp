#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// The part of a rod between two clamps, or between a clamp and a free end, or a rod without
/// clamps. Own units (lengths in l, forces in EI/l^2), own frame, in which a planar span lies in
/// x-y. s runs from the span's start.
struct Span {
  struct Hold {
    double at = 0;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< from the anchor
  };
  struct Load {
    double at = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
  };
  /// A half-space's wall: one-sided springs along the rod, or rigid.
  struct Wall {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
    double offset = 0;  ///< normal . (anchor - point): clearance of the anchor
    double stiffness = std::numeric_limits<double>::infinity();  ///< per length
  };

  /// Both clamps hold the rod's frame; whole turns are in SpanEnergy's unknown.
  struct Twist {
    double stiffness = 0;                               ///< GJ / EI
    Eigen::Vector3d end_d1 = Eigen::Vector3d::UnitX();  ///< of a rod whose d1 at the start is d1()
  };

  double length = 1;
  bool planar = true;
  std::optional<Eigen::Vector3d> start_direction;  ///< a clamp holds the start, which is the anchor
  std::optional<Eigen::Vector3d> end_direction;    ///< a clamp holds the end, the last of `holds`
  double anchor = 0;                               ///< s of the first grip
  std::vector<Hold> holds;                         ///< the other grips, by growing s
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  std::vector<Load> loads;  ///< by growing s
  std::vector<Wall> walls;
  std::optional<Twist> twist;  ///< where both ends are clamped, not planar

  /// d1 of the frame that a clamp's direction has here: z, if that is not nearly the direction.
  [[nodiscard]] static Eigen::Vector3d d1(const Eigen::Vector3d& direction);

  /// Sum of weight and loads, for scales.
  [[nodiscard]] double total_load() const;
  /// Of weight and loads on what lies before s.
  [[nodiscard]] Eigen::Vector3d force_before(double s) const;
  /// Weight and loads all point the same way.
  [[nodiscard]] bool pulled_one_way() const;
  /// One clamp and nothing but weight and loads, in a plane.
  [[nodiscard]] bool is_plain_cantilever() const {
    return planar && start_direction && holds.empty() && walls.empty();
  }
};

}  // namespace dlo::energy_model
