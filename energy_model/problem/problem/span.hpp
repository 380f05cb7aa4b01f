#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "dlo/obstacle/body.hpp"
#include "problem/natural_strains.hpp"

namespace dlo::energy_model {

/// How a grip holds a rod, the more the later.
enum class HeldBy { nothing, pin, clamp };

/// The part of a rod between two clamps, or between a clamp and a free end, or a rod without
/// clamps. Clamps that a torque passes through, because they do not hold the rod's frame, do not
/// end it where there is one. Own units (lengths in l, forces in EI/l^2), own frame, in which a
/// planar span lies in x-y. s runs from the span's start.
struct Span {
  struct Hold {
    double at = 0;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< from the anchor
    /// Of a clamp inside the span, about which the rod is free to rotate.
    std::optional<Eigen::Vector3d> direction = std::nullopt;
  };
  struct Load {
    double at = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double couple = 0;  ///< about z, of a planar span: its energy is -couple times the angle there
    /// couple_zero(): s, and the angle of its direction in the plane [rad].
    double zero_at = 0, zero_angle = 0;
  };
  struct Obstacle {
    std::size_t index = 0;  ///< of the problem's obstacles
    obstacle::Body body;    ///< seen from the anchor
  };
  /// One-sided springs along the rod.
  struct SoftObstacle : Obstacle {
    double stiffness = 0;  ///< per length
  };

  /// Where the rod is held on a rigid obstacle: along a part, which lies on it, or at one point.
  struct Contact {
    Obstacle obstacle;
    double begin = 0, end = 0;  ///< s; equal where it touches at one point
    /// The point, between grips, is that next to `begin` where the rod is nearest; else `begin`.
    bool slides = true;
    int feature = 0;  ///< of the body, which the rod touches there; it lies on one only

    [[nodiscard]] bool lies() const { return end > begin; }
  };

  /// A part with a section of its own.
  struct Part {
    double begin = 0, end = 0;
    Eigen::Vector3d stiffness = {1, 1, 0};             ///< as Span::stiffness
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();  ///< more than elsewhere
  };

  /// Both clamps hold the rod's frame; whole turns are in SpanEnergy's unknowns.
  struct Twist {
    /// Mean GJ over EI: what the span resists twist with, times its length.
    double stiffness = 0;
    Eigen::Vector3d end_d1 = Eigen::Vector3d::UnitX();  ///< of a rod whose d1 at the start is d1()
    /// HeldTurns::turns, of a rod with material directors that is searched from the start; else
    /// empty.
    std::optional<double> turns = std::nullopt;
  };

  double length = 1;
  bool planar = true;
  bool confined = false;                           ///< Problem::confined_to_plane
  std::optional<Eigen::Vector3d> start_direction;  ///< a clamp holds the start, which is the anchor
  std::optional<Eigen::Vector3d> end_direction;    ///< a clamp holds the end, the last of `holds`
  double anchor = 0;                               ///< s of the first grip
  std::vector<Hold> holds;                         ///< the other grips, by growing s
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  std::vector<Load> loads;           ///< by growing s
  std::vector<LineLoad> line_loads;  ///< what is not in `weight`, of own units and s
  std::vector<SoftObstacle> soft_obstacles;
  std::vector<Obstacle> rigid_obstacles;  ///< which the energy knows nothing of but for these:
  std::vector<Contact> contacts;          ///< by growing s, none over another
  std::optional<Twist> twist;             ///< where both ends are clamped, not planar
  std::vector<Part> parts;                ///< where the section is another one, by growing s
  /// Where pieces end, instead of where layers are guessed to have decayed (pieces_of()): as a
  /// shape that is known wants it, by growing s; empty: nothing is known.
  std::vector<double> cuts;
  /// Where pieces end besides: where contact with soft obstacles begins and ends, by growing s.
  std::vector<double> contact_ends;
  /// About d1, d2 and the tangent of a frame that has first_d1() at the start; about d1 alone if
  /// planar. Of all rods with material directors, zero if the rod is straight.
  NaturalStrains natural;
  /// EI about the same d1 and d2, and GJ of a rod with material directors, over the unit of EI,
  /// where `parts` do not say so. Without material directors both EI are the same.
  Eigen::Vector3d stiffness = {1, 1, 0};
  /// d1 at a clamped start where the principal axes of the section say so; none: d1().
  std::optional<Eigen::Vector3d> principal_d1;

  /// d1 of the frame that a clamp's direction has here: z, if that is not nearly the direction.
  [[nodiscard]] static Eigen::Vector3d d1(const Eigen::Vector3d& direction);

  /// d1 of the frame at the start, whose tangent this is.
  [[nodiscard]] Eigen::Vector3d first_d1(const Eigen::Vector3d& tangent) const {
    return principal_d1.value_or(d1(tangent));
  }
  /// Whether the rod's frame is fixed to its material (dlo::energy_model::has_material_directors).
  [[nodiscard]] bool has_material_directors() const { return !natural.empty(); }

  /// Weight and line loads of the rod between two arc lengths; negative where `to` comes first.
  [[nodiscard]] Eigen::Vector3d weight_between(double from, double to) const;
  /// Weight outside parts and line loads, per length in the mean.
  [[nodiscard]] Eigen::Vector3d mean_weight() const;
  /// Sum of the sizes of weight and loads, for scales.
  [[nodiscard]] double total_load() const;
  /// Of weight and loads on what lies before s.
  [[nodiscard]] Eigen::Vector3d force_before(double s) const;
  /// The most that a grip within these arc lengths, or `margin` beyond them, does.
  [[nodiscard]] HeldBy held_within(double begin, double end, double margin) const;
  /// Then nothing is known of the energy out of the plane.
  [[nodiscard]] bool has_couples() const;
  /// What leaves the plane is not looked at: the rod cannot, or couples have no potential there.
  [[nodiscard]] bool stays_in_plane() const { return planar && (confined || has_couples()); }
  /// Weight and loads all point the same way.
  [[nodiscard]] bool pulled_one_way() const;
  /// A uniform straight rod with one clamp and nothing but weight and loads, in a plane. What else
  /// there may be has to be asked for here: such spans are solved and certified in ways of their
  /// own.
  [[nodiscard]] bool is_plain_cantilever() const {
    return planar && start_direction && holds.empty() && soft_obstacles.empty() &&
           contacts.empty() && parts.empty() && line_loads.empty() && !has_couples() &&
           !has_material_directors();
  }
};

}  // namespace dlo::energy_model
