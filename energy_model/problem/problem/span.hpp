#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "dlo/obstacle/body.hpp"
#include "problem/natural_strains.hpp"

namespace dlo::energy_model {

/// Kind of grip that holds a rod; later ones hold more.
enum class HeldBy { nothing, pin, clamp };

/// Part of a rod that is solved separately: between two clamps, between a clamp and a free end, or
/// a rod without clamps. A clamp that does not hold the rod's frame does not end a span if a torque
/// passes through it. Units of the span (lengths in l, forces in EI/l^2) and its own frame, in
/// which a planar span lies in x-y. s runs from the span's start.
struct Span {
  struct Hold {
    double at = 0;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< position relative to the anchor
    /// Direction of a clamp within the span, about which the rod is free to rotate.
    std::optional<Eigen::Vector3d> direction = std::nullopt;
  };
  struct Load {
    double at = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    /// Couple about z, of a planar span; its energy is -couple times the angle of the tangent.
    double couple = 0;
    /// Reference of couple_zero(): s, and the angle of its direction in the plane [rad].
    double zero_at = 0, zero_angle = 0;
  };
  struct Obstacle {
    std::size_t index = 0;  ///< index in Problem::obstacles
    obstacle::Body body;    ///< in the span's frame, relative to the anchor
  };
  /// Yielding obstacle: one-sided springs along the rod.
  struct SoftObstacle : Obstacle {
    double stiffness = 0;  ///< force per depth and length
  };

  /// Constraint of the rod on a rigid obstacle: along a part that lies on it, or at one point.
  struct Contact {
    Obstacle obstacle;
    double begin = 0, end = 0;  ///< s; equal if the rod touches at one point
    /// Whether the contact point, between grips, is the local minimum of the distance near `begin`;
    /// else it is at `begin`.
    bool slides = true;
    int feature = 0;  ///< feature of the body that the rod touches; a part lies on only one

    [[nodiscard]] bool lies() const { return end > begin; }
  };

  struct Part {
    double begin = 0, end = 0;
    Eigen::Vector3d stiffness = {1, 1, 0};  ///< same order and unit as Span::stiffness
    /// Weight per length in excess of Span::weight.
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  };

  /// Rotation between the frames that clamps at both ends hold; whole turns are in SpanEnergy's
  /// unknowns.
  struct Twist {
    /// Harmonic mean of GJ along the span, divided by EI [-].
    double stiffness = 0;
    /// d1 that the end holds, if d1 at the start is d1().
    Eigen::Vector3d end_d1 = Eigen::Vector3d::UnitX();
    /// HeldTurns::turns, for a rod with material directors that is searched from its start; else
    /// empty.
    std::optional<double> turns = std::nullopt;
  };

  double length = 1;
  bool planar = true;
  bool confined = false;  ///< Problem::confined_to_plane
  /// Direction of a clamp at the start; empty if there is none. That clamp is the anchor.
  std::optional<Eigen::Vector3d> start_direction;
  /// Direction of a clamp at the end; empty if there is none. That clamp is the last of `holds`.
  std::optional<Eigen::Vector3d> end_direction;
  double anchor = 0;        ///< s of the first grip
  std::vector<Hold> holds;  ///< other grips, by growing s
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  std::vector<Load> loads;  ///< by growing s
  /// Line loads that are not in `weight`, in the span's units and s.
  std::vector<LineLoad> line_loads;
  std::vector<SoftObstacle> soft_obstacles;
  /// Rigid obstacles, which the energy does not contain except as `contacts`.
  std::vector<Obstacle> rigid_obstacles;
  std::vector<Contact> contacts;  ///< by growing s, not overlapping
  std::optional<Twist> twist;  ///< if clamps hold frames at both ends; the span is then not planar
  std::vector<Part> parts;     ///< intervals with another cross-section, by growing s
  /// Ends of elements by growing s, taken from a known shape, in place of the estimated decay
  /// lengths of layers (elements_of()); empty: no shape is known.
  std::vector<double> cuts;
  /// Additional ends of elements: where contact with soft obstacles begins and ends, by growing s.
  std::vector<double> contact_ends;
  /// Natural strains about d1, d2 and the tangent of a frame that has first_d1() at the start; only
  /// about d1 if planar. Given for all rods with material directors, zero if the rod is straight.
  NaturalStrains natural;
  /// EI about d1 and d2, and GJ, of a rod with material directors, divided by the unit of EI,
  /// outside `parts`. The directors are those of `natural`. Without material directors both EI are
  /// equal.
  Eigen::Vector3d stiffness = {1, 1, 0};
  /// d1 at a clamped start that is determined by the principal axes of the section; none: d1().
  std::optional<Eigen::Vector3d> principal_d1;

  /// Returns d1 of the frame for the direction of a clamp: z, unless z is nearly along the
  /// direction.
  [[nodiscard]] static Eigen::Vector3d d1(const Eigen::Vector3d& direction);

  /// Returns d1 of the frame at the start, whose tangent is given.
  [[nodiscard]] Eigen::Vector3d first_d1(const Eigen::Vector3d& tangent) const {
    return principal_d1.value_or(d1(tangent));
  }
  /// Whether the rod's frame is fixed to its material (dlo::energy_model::has_material_directors).
  [[nodiscard]] bool has_material_directors() const { return !natural.empty(); }

  /// Returns the weight and line loads of the rod between two arc lengths; negative if `to` is less
  /// than `from`.
  [[nodiscard]] Eigen::Vector3d weight_between(double from, double to) const;
  /// Returns the weight per length outside parts, plus the mean of the line loads.
  [[nodiscard]] Eigen::Vector3d mean_weight() const;
  /// Returns the sum of the norms of weight and loads, as a scale. A couple counts divided by the
  /// length.
  [[nodiscard]] double total_load() const;
  /// Returns the force of weight and loads on the rod from its start to s, without loads at s.
  [[nodiscard]] Eigen::Vector3d force_before(double s) const;
  /// Returns the strongest kind of grip within these arc lengths, extended by `margin` on both
  /// sides.
  [[nodiscard]] HeldBy held_within(double begin, double end, double margin) const;
  /// Whether couples act, for which the energy out of the plane is undefined.
  [[nodiscard]] bool has_couples() const;
  /// Whether shapes out of the plane are excluded, because the rod is confined or couples have no
  /// potential there.
  [[nodiscard]] bool stays_in_plane() const { return planar && (confined || has_couples()); }
  /// Whether weight and loads point in the same direction, or are zero; false with couples.
  [[nodiscard]] bool has_unidirectional_load() const;
  /// Whether this is a uniform straight rod in a plane with one clamp under weight and point forces
  /// alone, without contact. Such spans are solved and certified by separate methods, so a new kind
  /// of load or constraint has to be excluded here.
  [[nodiscard]] bool is_plain_cantilever() const {
    return planar && start_direction && holds.empty() && soft_obstacles.empty() &&
           contacts.empty() && parts.empty() && line_loads.empty() && !has_couples() &&
           !has_material_directors();
  }
};

/// Removes the rigid obstacles that lie, as far as the rod reaches, within another one. Contact
/// with both would be the same constraint twice, with undetermined multipliers. Of two that
/// coincide the first stays. The remaining obstacles keep the rod out of all of them, up to
/// rounding.
void remove_redundant_obstacles(Span& span);

/// Removes rigid obstacles whose surface differs little from that of an obstacle that stays.
/// Contact with both would be nearly the same constraint twice, and the active set would alternate
/// between them. The caller has to verify that the rod stays out of the removed obstacles.
/// @param preferred  index in the problem of the obstacle that stays in any case
/// @return whether an obstacle was removed
bool omit_similar_obstacles(Span& span, std::size_t preferred);

}  // namespace dlo::energy_model
