#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/material.hpp"
#include "dlo/compare/model_chain.hpp"
#include "dlo/compare/rest_shape.hpp"
#include "dlo/compare/trajectory.hpp"
#include "dlo/energy_model/drag.hpp"
#include "dlo/obstacle/body.hpp"

namespace dlo::compare {

/// Whether a rod stretches by N / EA.
enum class Stretch {
  none,       ///< it keeps its length
  counted,    ///< it does; EA is then known
  automatic,  ///< counted where the estimate of StretchEffect says that it matters; EA is known
};

/// Keeps a clamped cross-section from rotating about its direction.
struct FrameHold {
  /// First director of the rod's frame, unit and across the direction; none: that of the first
  /// clamp that holds the frame, carried here by the shortest rotation of its direction.
  std::optional<Eigen::Vector3d> d1;
  double roll = 0;  ///< turned on from there about the direction, whole turns counted [rad]

  /// In every field.
  bool operator==(const FrameHold&) const = default;
};

/// What holds a point of the rod.
struct Gripper {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< unit; a clamp has one, a pin has none
  std::optional<FrameHold> frame;                      ///< of a clamp that does not let it turn
  /// How it moves (scene_at()); of a clamp whose poses have no directions its own stays. Empty: it
  /// stands. All that takes a scene as it is has it at the first pose.
  Trajectory trajectory = {};
  std::string where;  ///< "file:line", for messages

  /// In every field.
  bool operator==(const Gripper&) const = default;
};

/// A force that keeps its direction and a couple that keeps its axis, or such that turn with the
/// rod.
struct PointLoad {
  double at = 0;                                     ///< arc length [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]; of a mass in the file, its weight
  double mass = 0;                                   ///< [kg], of what hangs there and would move
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
  /// Force and torque are along d1, d2 and the tangent of the section, as energy_model::Load's.
  bool follows = false;

  /// In every field.
  bool operator==(const PointLoad&) const = default;
};

/// A dead force per length besides the weight.
struct DistributedLoad {
  double from = 0;  ///< arc length [m]
  double to = 0;    ///< arc length [m], > from
  /// At equal distances from `from` to `to`, linear between [N/m]; one: the same all along.
  std::vector<Eigen::Vector3d> force_per_length;

  /// Of the rod between two arc lengths [N].
  [[nodiscard]] Eigen::Vector3d between(double begin, double end) const;
  /// Sum of its sizes [N]; no less than that of its forces.
  [[nodiscard]] double size() const;

  /// In every field.
  bool operator==(const DistributedLoad&) const = default;
};

/// A body that the rod's axis stays out of: one that its surface must not enter, as a scene file
/// has it, is larger by half the diameter.
struct Obstacle {
  obstacle::Body body;  ///< [m]
  /// Force per depth and per length of rod [N/m^2]; infinite: rigid.
  double stiffness = std::numeric_limits<double>::infinity();
  /// Coulomb's coefficient [-], >= 0. No model has friction: a shape that touches such an
  /// obstacle says so (Solution::neglected).
  double friction = 0;
  /// How it moves without turning, its poses being where the file's `point` is. Empty: it stands;
  /// the body is that at the first pose.
  Trajectory trajectory = {};

  /// In every field.
  bool operator==(const Obstacle&) const = default;
};

/// A part of the rod that is another one: a connector, a splice, a sleeve.
struct Section {
  double from = 0;               ///< arc length [m]
  double to = 0;                 ///< arc length [m], > from
  double bending_stiffness = 0;  ///< EI [N m^2], > 0; about d1 where bending_stiffness_2 is given
  double mass_per_length = 0;    ///< rho A [kg/m], >= 0
  /// GJ [N m^2]; none: its share of EI is the rod's own.
  std::optional<double> torsional_stiffness;
  /// EI about d2 [N m^2], > 0; none: the section is round.
  std::optional<double> bending_stiffness_2 = std::nullopt;
  /// Curvature of the stress-free shape about d1 and d2 of the rod's frame, the same all along
  /// [1/m]; none: the rod's own there.
  std::optional<Eigen::Vector2d> natural_curvature = std::nullopt;
  /// The same of its twist [rad/m].
  std::optional<double> natural_twist = std::nullopt;

  /// As Scene's.
  [[nodiscard]] double mean_bending_stiffness() const;

  /// In every field.
  bool operator==(const Section&) const = default;
};

/// As what a rod's stiffness or mass is told: Young's modulus and density, or EI and mass per
/// length of a rod that is given by these.
struct NamedValue {
  const char* name = "";  ///< "E", "EI" or "EI about d1"; "density" or "mass per length"
  const char* unit = "";  ///< "Pa" or "N m^2"; "kg/m^3" or "kg/m"
  double value = 0;       ///< in that unit
};

/// Poisson's ratio of a rod whose torsional stiffness is needed and not given: GJ = EI / (1 + nu),
/// EI the harmonic mean of those about d1 and d2. So it is for a round section, solid or hollow,
/// and every elliptic one (Saint-Venant), and for a rectangular one in the limit of a thin strip.
/// Of one whose width and thickness are given GJ is Saint-Venant's.
inline constexpr double assumed_poisson_ratio = 0.3;

/// How a scene that moves is looked at.
struct TrackRates {
  double frames = 1000;  ///< frames a second [Hz], > 0: how often grippers move
  /// How often obstacles move [Hz], > 0; none: with every frame.
  std::optional<double> obstacles;
  /// Steps of the force model a second [Hz], > 0.
  double steps = 30000;

  /// In every field.
  bool operator==(const TrackRates&) const = default;
};

/// A physical scene in SI units. A rod is of one material and round, a tube or a flat strip, or is
/// given by its EI (about d1 and d2, if they differ) and its mass per length; where both are given,
/// these count for bending and weight, and material and section for the axial stiffness only.
struct Scene {
  std::string name;                         ///< for people; regression tests know the scene by it
  std::string file;                         ///< where it was read from, for messages
  Eigen::Vector3d gravity = {0, -9.81, 0};  ///< [m/s^2]
  double length = 0;                        ///< l [m]
  /// d [m]; 0: not known, then there is no material but that of a rectangular section.
  double diameter = 0;
  double inner_diameter = 0;  ///< of a tube [m], < diameter; 0: solid
  double width = 0;           ///< of a rectangular section, along d1 [m]; 0: it is none
  double thickness = 0;       ///< of a rectangular section, along d2 [m]
  Material material;          ///< youngs_modulus 0: not known; of layers the mean of the section
  /// Bounds of a rod of layers, of which given_bending_stiffness and torsional_stiffness are one.
  std::optional<LayeredSection> layers;
  std::optional<double> given_bending_stiffness;  ///< EI [N m^2], > 0; none: of the material
  std::optional<double> given_mass_per_length;    ///< rho A [kg/m], >= 0; none: of the material
  /// EI about d2 [N m^2], > 0, beside given_bending_stiffness, which then is about d1; none: round.
  std::optional<double> given_bending_stiffness_2;
  std::optional<double> given_axial_stiffness;  ///< EA [N], > 0; none: axial_stiffness()
  Stretch stretch = Stretch::none;              ///< of models that have it
  /// GJ [N m^2], > 0; needed where two clamps hold frames or the rod has material directors, of no
  /// effect elsewhere.
  std::optional<double> torsional_stiffness;
  std::vector<Section> sections;  ///< where the rod is another one, by arc length, none overlap
  /// Curvature of the stress-free shape about d1 and d2 of its frame and its twist, in the mean
  /// along it [1/m]; the first clamp along the rod holds that frame (energy_model::first_frame).
  Eigen::Vector3d natural_strain = Eigen::Vector3d::Zero();
  /// What the curvature varies by: coefficients of Legendre's P_1, P_2, .. of 2 s/l - 1 [1/m].
  std::vector<Eigen::Vector2d> natural_variation;
  /// What points in space say of the stress-free shape, where they say it: its arcs are the natural
  /// curvature and twist of `sections`, or natural_strain where there is one arc.
  std::optional<RestShape> rest_shape;
  std::vector<Gripper> grippers;                   ///< one or more, in the file's order
  std::vector<PointLoad> loads;                    ///< may be empty
  std::vector<DistributedLoad> distributed_loads;  ///< may be empty; they add up
  std::optional<energy_model::Drag> drag;          ///< of a steady stream on all of the rod
  std::vector<Obstacle> obstacles;                 ///< may be empty
  ForceModelSettings force_model;                  ///< as the file has it
  TrackRates track;                                ///< as the file has it
  /// Points of the rod from which a rod with inertia starts ([track] start): at one time those of a
  /// shape that is released from rest, at more a recording, whose velocities it has; null: the rod
  /// starts from its equilibrium.
  std::shared_ptr<const MarkerMotion> start;
  std::optional<ModelChain> model;  ///< that the scene was made from

  [[nodiscard]] double cross_section() const;  ///< A [m^2]; 0 if its sizes are not known
  /// I / A of it about d1 and d2 [m^2]; 0 likewise.
  [[nodiscard]] Eigen::Vector2d squared_gyration() const;
  [[nodiscard]] double bending_stiffness() const;  ///< EI [N m^2], outside sections; about d1
  /// EI about d2 [N m^2], outside sections, where it is another one than that about d1: given, or
  /// of the material and a rectangular section that is not square.
  [[nodiscard]] std::optional<double> bending_stiffness_2() const;
  /// The smaller EI of those about d1 and d2 [N m^2], outside sections.
  [[nodiscard]] double softer_bending_stiffness() const;
  /// Their harmonic mean [N m^2], which GJ of one material goes with; EI of a round rod.
  [[nodiscard]] double mean_bending_stiffness() const;
  [[nodiscard]] double mass_per_length() const;  ///< rho A [kg/m], outside sections
  /// GJ [N m^2], outside sections: as given, of a rod with material directors
  /// assumed_torsional_stiffness() if not given; else 0.
  [[nodiscard]] double twisting_stiffness() const;
  /// GJ [N m^2] of one material with assumed_poisson_ratio, outside sections: of a rectangular
  /// section E / (2 (1 + nu)) times its torsion constant, else mean_bending_stiffness() / (1 + nu).
  [[nodiscard]] double assumed_torsional_stiffness() const;
  /// Whether that GJ is an assumption.
  [[nodiscard]] bool assumes_torsion() const;
  /// EA [N], one for all of the rod: as given, or of the material; without one of a rod of one
  /// material with this EI and section (solid and round: 16 EI / d^2); without a section 1e6 EI /
  /// l^2, a rod 250 times as long as thick.
  [[nodiscard]] double axial_stiffness() const;
  /// The same where the scene says it; none where it is only assumed: of the EI and the diameter of
  /// a cable whose strands slip EA is far more than a solid rod's.
  [[nodiscard]] std::optional<double> known_axial_stiffness() const;
  /// The stiffness that a fit multiplies.
  [[nodiscard]] NamedValue stiffness() const;
  /// The same of the mass.
  [[nodiscard]] NamedValue heaviness() const;
  [[nodiscard]] double mass() const;  ///< [kg], with sections
  /// Mean over the rod [N/m]: its mass with sections times gravity over its length.
  [[nodiscard]] Eigen::Vector3d weight_per_length() const;
  /// Of the rod between two arc lengths [N], 0 <= begin <= end <= length.
  [[nodiscard]] Eigen::Vector3d weight_between(double begin, double end) const;
  /// Of distributed loads, as above [N].
  [[nodiscard]] Eigen::Vector3d distributed_between(double begin, double end) const;
  /// Sum of the sizes of all loads, weight not counted; of couples over the length [N].
  [[nodiscard]] double total_of_loads() const;
  /// Whether a load has a couple.
  [[nodiscard]] bool has_couples() const;
  /// @param who  needs a potential, as "the energy model does"
  /// @throws InputError if a load has none (energy_model::has_potential), which names it
  void require_potential(const char* who) const;
  /// @param who  does not take couples, nor what has no potential, as "the polygons of models force
  /// and chain do"
  /// @throws InputError if there are some
  void require_no_couples(const char* who) const;
  /// int 1/GJ ds between two arc lengths [1/(N m)], as above; of a rod with a GJ.
  [[nodiscard]] double twisting_compliance(double begin, double end) const;
  /// int 1/EI ds between two arc lengths [1/(N m)], as above.
  [[nodiscard]] double bending_compliance(double begin, double end) const;
  /// w l^3 / (EI) [-], w the mean weight per length and EI the smaller one outside sections.
  [[nodiscard]] double gamma() const;
  /// Whether the stress-free shape is curved or twisted.
  [[nodiscard]] bool naturally_bent() const { return naturally_curved() || naturally_twisted(); }
  /// The same of the curvature alone.
  [[nodiscard]] bool naturally_curved() const;
  /// The same of the twist alone.
  [[nodiscard]] bool naturally_twisted() const;
  /// Whether the rod, or a section of it, has one EI about d1 and another about d2.
  [[nodiscard]] bool has_two_stiffnesses() const;
  /// Whether d1 and d2 are fixed to the rod's material (energy_model::has_material_directors).
  [[nodiscard]] bool has_material_directors() const {
    return naturally_bent() || has_two_stiffnesses();
  }
  /// Frame (columns d1, d2, t) in which the first clamp holds a rod with material directors.
  /// @throws InputError if no clamp, or no plane, says where it is
  [[nodiscard]] Eigen::Matrix3d first_frame() const;
  /// Returns the normal of the plane in which an intrinsically curved rod is assumed to be bent,
  /// because its first clamp gives no d1: that of the scene without loads
  /// (energy_model::natural_normal). Empty: the clamp gives d1, or the rod is straight.
  [[nodiscard]] std::optional<Eigen::Vector3d> assumed_normal() const;
  /// The same rod, intrinsically straight.
  [[nodiscard]] Scene without_natural_strain() const;
  /// Mean curvature of the stress-free shape in the axes that the first clamp holds, as a vector
  /// about which its tangent turns [1/m]; zero for a rod that is intrinsically straight. @throws
  /// InputError if no clamp, or no plane, says where its frame is
  [[nodiscard]] Eigen::Vector3d natural_curvature() const;
  /// The same of the rod between two arc lengths, begin < end.
  [[nodiscard]] Eigen::Vector3d natural_curvature(double begin, double end) const;
  /// Whether two clamps or more hold the rod's frame, which twists it or keeps it from twisting. Of
  /// a rod with material directors the first clamp always does.
  [[nodiscard]] bool holds_twist() const;
  /// The same with clamps that let the rod rotate about their directions, but for the first clamp
  /// of a rod with material directors.
  [[nodiscard]] Scene without_twist() const;
  /// Unit normal of the plane that grips, forces and obstacles in reach share, if they do, no twist
  /// is held, which bends a rod out of its plane, and the rod is not curved about another axis by
  /// nature and not oblique to its principal axes; of several planes any one.
  [[nodiscard]] std::optional<Eigen::Vector3d> plane_normal() const;
  /// Whether there is one.
  [[nodiscard]] bool planar() const { return plane_normal().has_value(); }
  [[nodiscard]] int spans() const;  ///< parts that the clamps cut the rod into

  /// Makes a shape the stress-free one, in place of any natural curvature and twist before. Of
  /// several arcs each is a section, or cuts one.
  /// @param shape  of a rod of this length
  void set_rest_shape(const RestShape& shape);

  /// Multiplies E, and EI and GJ with it, those of sections too: their ratios are those of
  /// Poisson's ratio and of the sections' shapes.
  void scale_modulus(double factor);
  /// Multiplies GJ, that of sections too; an assumed one is then given.
  void scale_torsion(double factor);
  /// Multiplies the density, and all given masses per length with it.
  void scale_density(double factor);

  /// In every field.
  bool operator==(const Scene&) const = default;
};

/// What a sum of arc lengths may leave the rod by, as a share of its length: single precision
/// rounds each of some segments by 6e-8.
inline constexpr double arc_rounding = 1e-6;

/// An arc length that somebody gives, on the rod: one beyond an end by rounding is that end [m].
/// None of one that is farther away.
[[nodiscard]] std::optional<double> on_rod(double s, double length);

/// First and last time of all poses of a scene [s].
struct TimeSpan {
  double begin = 0;  ///< [s]
  double end = 0;    ///< [s], >= begin
};

/// When a scene moves; nothing of one that stands.
[[nodiscard]] std::optional<TimeSpan> motion_of(const Scene& scene);

/// The scene as it is at a time, standing: grippers and obstacles at their poses, none of which it
/// has any more.
/// @param obstacle_time  the same for obstacles, which a loop may move less often [s]
[[nodiscard]] Scene scene_at(const Scene& scene, double time, double obstacle_time);
/// At one time.
[[nodiscard]] Scene scene_at(const Scene& scene, double time);

}  // namespace dlo::compare
