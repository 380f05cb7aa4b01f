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

/// Whether the axial strain N / EA of a rod is modelled.
enum class Stretch {
  none,       ///< the rod keeps its length
  counted,    ///< axial strain is modelled; EA is then known
  automatic,  ///< modelled if the estimate of StretchEffect is above the target; EA is then known
};

/// Keeps a clamped cross-section from rotating about its direction.
struct FrameHold {
  /// First director of the rod's frame, unit vector perpendicular to the direction of the clamp.
  /// Empty: d1 of the first clamp that holds the frame, carried here by the shortest rotation of
  /// its direction.
  std::optional<Eigen::Vector3d> d1;
  double roll = 0;  ///< rotation of d1 about the direction [rad]; whole turns count

  /// Compares all fields.
  bool operator==(const FrameHold&) const = default;
};

/// A clamp or a pin, which holds one point of the rod.
struct Gripper {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< unit vector of a clamp; empty for a pin
  std::optional<FrameHold> frame;  ///< given if the clamp prevents rotation about its direction
  /// Motion of the gripper (scene_at()). If its poses have no directions, a clamp keeps its own
  /// direction. Empty: the gripper does not move. Functions that solve one static scene use the
  /// gripper as it is at the first pose.
  Trajectory trajectory = {};
  std::string where;  ///< "file:line", for messages

  /// Compares all fields.
  bool operator==(const Gripper&) const = default;
};

/// A point force and a couple. Both keep their directions in space, or rotate with the rod
/// (`follows`).
struct PointLoad {
  double at = 0;                                    ///< arc length [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]; the weight, if the file gives a mass
  double mass = 0;  ///< mass of the attached body [kg], which would move with the rod
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
  /// Whether the components of force and torque are along d1, d2 and the tangent of the
  /// cross-section, as in energy_model::Load.
  bool follows = false;

  /// Compares all fields.
  bool operator==(const PointLoad&) const = default;
};

/// A dead force per length in addition to the weight.
struct DistributedLoad {
  double from = 0;  ///< arc length [m]
  double to = 0;    ///< arc length [m], > from
  /// Values at equal distances from `from` to `to`, linear between them [N/m]. A single value is
  /// constant along the interval.
  std::vector<Eigen::Vector3d> force_per_length;

  /// Returns the force on the rod between two arc lengths [N].
  [[nodiscard]] Eigen::Vector3d force_between(double begin, double end) const;
  /// Returns the integral of the absolute value of the load [N] by the trapezoidal rule; it is
  /// larger than the integral where the direction changes between two values, and not smaller than
  /// the absolute value of the resultant.
  [[nodiscard]] double size() const;

  /// Compares all fields.
  bool operator==(const DistributedLoad&) const = default;
};

/// A body that the rod's axis must not enter. It is larger by half the rod's diameter than the body
/// in a scene file, which the rod's surface must not enter; with touches = "axis" both are equal.
struct Obstacle {
  obstacle::Body body;  ///< [m]
  /// Force per depth and per length of rod [N/m^2]; infinite: rigid.
  double stiffness = std::numeric_limits<double>::infinity();
  /// Coulomb's coefficient of friction [-], >= 0. No model has friction: Solution::neglected lists
  /// it if the rod touches such an obstacle.
  double friction = 0;
  /// Motion without rotation: positions of the file's `point`. Empty: the obstacle does not move.
  /// `body` is the obstacle at the first pose.
  Trajectory trajectory = {};

  /// Compares all fields.
  bool operator==(const Obstacle&) const = default;
};

/// An interval of the rod with other properties: a connector, a splice, a sleeve.
struct Section {
  double from = 0;               ///< arc length [m]
  double to = 0;                 ///< arc length [m], > from
  double bending_stiffness = 0;  ///< EI [N m^2], > 0; about d1 where bending_stiffness_2 is given
  double mass_per_length = 0;    ///< rho A [kg/m], >= 0
  /// GJ [N m^2]; empty: GJ / EI (EI the harmonic mean) is that of the rest of the rod.
  std::optional<double> torsional_stiffness;
  /// EI about d2 [N m^2], > 0; empty: the section is round.
  std::optional<double> bending_stiffness_2 = std::nullopt;
  /// Constant curvature of the stress-free shape about d1 and d2 of the rod's frame [1/m]; empty:
  /// that of the rod (Scene::natural_strain and natural_variation).
  std::optional<Eigen::Vector2d> natural_curvature = std::nullopt;
  /// Constant twist of the stress-free shape [rad/m]; empty: that of the rod.
  std::optional<double> natural_twist = std::nullopt;

  /// Returns the harmonic mean of EI about d1 and d2 [N m^2]; EI of a round section.
  [[nodiscard]] double mean_bending_stiffness() const;

  /// Compares all fields.
  bool operator==(const Section&) const = default;
};

/// The quantity by which a scene gives a rod's stiffness or mass: Young's modulus and density, or
/// EI and mass per length.
struct NamedValue {
  const char* name = "";  ///< "E", "EI" or "EI about d1"; "density" or "mass per length"
  const char* unit = "";  ///< "Pa" or "N m^2"; "kg/m^3" or "kg/m"
  double value = 0;       ///< value in `unit`
};

/// Poisson's ratio nu of a rod whose torsional stiffness is needed and not given: GJ = EI / (1 +
/// nu), EI the harmonic mean of those about d1 and d2. This formula is exact for round sections,
/// solid or hollow, for elliptic ones (Saint-Venant), and for a rectangular one in the limit of a
/// thin strip. GJ of a section with given width and thickness is Saint-Venant's.
inline constexpr double assumed_poisson_ratio = 0.3;

/// Sampling rates of a moving scene.
struct TrackRates {
  double frame_rate = 1000;  ///< rate at which grippers are moved [Hz], > 0
  /// Rate at which obstacles are moved [Hz], > 0; empty: in every frame.
  std::optional<double> obstacle_rate;
  /// Steps of the force model per second [Hz], > 0.
  double step_rate = 30000;

  /// Compares all fields.
  bool operator==(const TrackRates&) const = default;
};

/// A physical scene in SI units. The rod has one material and is round, a tube or a flat strip, or
/// it is given by its EI (about d1 and d2, if they differ) and its mass per length. If both are
/// given, EI and mass per length determine bending and weight, and material and section only the
/// axial stiffness.
struct Scene {
  std::string name;  ///< title for people; regression tests identify the scene by it
  std::string file;  ///< name of the file that the scene was read from, for messages
  Eigen::Vector3d gravity = {0, -9.81, 0};  ///< [m/s^2]
  double length = 0;                        ///< l [m]
  /// d [m]; 0: unknown. A material then requires a rectangular section.
  double diameter = 0;
  double inner_diameter = 0;  ///< inner diameter of a tube [m], < diameter; 0: solid
  double width = 0;           ///< edge of a rectangular section along d1 [m]; 0: not rectangular
  double thickness = 0;       ///< edge of a rectangular section along d2 [m]
  Material material;          ///< youngs_modulus 0: unknown; for layers the mean over the section
  /// Bounds of the stiffnesses of a rod of layers; given_bending_stiffness and torsional_stiffness
  /// are set to one of the two bounds.
  std::optional<LayeredSection> layers;
  std::optional<double> given_bending_stiffness;  ///< EI [N m^2], > 0; empty: from the material
  std::optional<double> given_mass_per_length;    ///< rho A [kg/m], >= 0; empty: from the material
  /// EI about d2 [N m^2], > 0, in addition to given_bending_stiffness, which then is EI about d1;
  /// empty: round.
  std::optional<double> given_bending_stiffness_2;
  std::optional<double> given_axial_stiffness;  ///< EA [N], > 0; empty: see axial_stiffness()
  Stretch stretch = Stretch::none;              ///< whether models with axial strain include it
  /// GJ [N m^2], > 0; empty: assumed_torsional_stiffness() of a rod with material directors.
  /// Another rod needs it if two clamps hold its frame; else it has no effect.
  std::optional<double> torsional_stiffness;
  /// Intervals with other properties, by arc length, without overlap.
  std::vector<Section> sections;
  /// Means along the rod of the natural curvature about d1 and d2 and of the natural twist, that
  /// is, of the stress-free shape [1/m]. The first clamp along the rod holds that frame
  /// (energy_model::first_frame).
  Eigen::Vector3d natural_strain = Eigen::Vector3d::Zero();
  /// Variation of the natural curvature along the rod: coefficients of Legendre's P_1, P_2, .. of 2
  /// s/l - 1 [1/m].
  std::vector<Eigen::Vector2d> natural_variation;
  /// Fit to points in space, if the stress-free shape is given by points. Its arcs are also the
  /// natural curvature and twist of `sections`, or natural_strain if there is one arc.
  std::optional<RestShape> rest_shape;
  std::vector<Gripper> grippers;                   ///< one or more, in the file's order
  std::vector<PointLoad> loads;                    ///< may be empty
  std::vector<DistributedLoad> distributed_loads;  ///< they add up, with the buoyancy of [medium]
  std::optional<energy_model::Drag> drag;          ///< drag of a steady stream on the whole rod
  std::vector<Obstacle> obstacles;                 ///< may be empty
  ForceModelSettings force_model;                  ///< as given in the file
  TrackRates track;                                ///< as given in the file
  /// Points of the rod from which a rod with inertia starts ([track] start). Points at one time are
  /// a shape that is released from rest; points at several times are a recording, whose velocities
  /// are used too. Null: the rod starts from its equilibrium.
  std::shared_ptr<const MarkerMotion> start;
  std::optional<ModelChain> model;  ///< simulator's model that the scene was made from, if any

  [[nodiscard]] double cross_section() const;  ///< A [m^2]; 0 if the dimensions are unknown
  /// Returns I / A of the cross-section about d1 and d2 [m^2]; 0 if the dimensions are unknown.
  [[nodiscard]] Eigen::Vector2d squared_gyration() const;
  [[nodiscard]] double bending_stiffness() const;  ///< EI about d1 [N m^2], outside sections
  /// Returns EI about d2 [N m^2], outside sections, if it differs from EI about d1: the given
  /// value, or that of the material and a rectangular section that is not square.
  [[nodiscard]] std::optional<double> bending_stiffness_2() const;
  /// Returns the smaller of EI about d1 and about d2 [N m^2], outside sections.
  [[nodiscard]] double softer_bending_stiffness() const;
  /// Returns the harmonic mean of EI about d1 and d2 [N m^2], outside sections, to which GJ of a
  /// rod of one material is proportional; EI of a round rod.
  [[nodiscard]] double mean_bending_stiffness() const;
  [[nodiscard]] double mass_per_length() const;  ///< rho A [kg/m], outside sections
  /// Returns GJ [N m^2], outside sections: the given value; else assumed_torsional_stiffness() of a
  /// rod with material directors, and 0 of any other.
  [[nodiscard]] double twisting_stiffness() const;
  /// Returns GJ [N m^2] of one material with assumed_poisson_ratio, outside sections: for a
  /// rectangular section E / (2 (1 + nu)) times its torsion constant, else, and if EI is given,
  /// mean_bending_stiffness() / (1 + nu).
  [[nodiscard]] double assumed_torsional_stiffness() const;
  /// Whether twisting_stiffness() is an assumption: the rod has material directors and GJ is not
  /// given.
  [[nodiscard]] bool assumes_torsion() const;
  /// Returns EA [N], one value for the whole rod: the given one, or that of the material; else EA
  /// of a rod of one material with this EI and section (solid and round: 16 EI / d^2); without a
  /// section 1e6 EI / l^2, as of a rod 250 times as long as thick.
  [[nodiscard]] double axial_stiffness() const;
  /// Returns EA [N] if it is given or follows from material and section; empty if it would be an
  /// assumption, since EA of a cable whose strands slip is far larger than that of a solid rod with
  /// its EI and diameter.
  [[nodiscard]] std::optional<double> known_axial_stiffness() const;
  /// Returns the stiffness that a fit multiplies: E or EI.
  [[nodiscard]] NamedValue stiffness() const;
  /// Returns the mass parameter that a fit multiplies: density or mass per length.
  [[nodiscard]] NamedValue mass_parameter() const;
  [[nodiscard]] double mass() const;  ///< total mass of the rod [kg], with sections
  /// Returns the mean weight per length [N/m]: mass() times gravity, divided by the length.
  [[nodiscard]] Eigen::Vector3d weight_per_length() const;
  /// Returns the weight of the rod between two arc lengths [N], 0 <= begin <= end <= length.
  [[nodiscard]] Eigen::Vector3d weight_between(double begin, double end) const;
  /// Returns the sum of all distributed loads between two arc lengths [N], 0 <= begin <= end <=
  /// length.
  [[nodiscard]] Eigen::Vector3d distributed_between(double begin, double end) const;
  /// Returns the sum of the absolute values of all point and distributed loads [N], without weight
  /// and drag; couples are divided by the length.
  [[nodiscard]] double total_load_magnitude() const;
  /// Whether a load has a couple.
  [[nodiscard]] bool has_couples() const;
  /// Checks that all loads have a potential (energy_model::has_potential).
  /// @param model_name  model or computation that the message names, such as "the energy model"
  /// @throws InputError that names the drag, the first load that follows the rod, or the couples
  void require_potential(const char* model_name) const;
  /// Checks that no load has a couple, and that all have a potential.
  /// @param model_name  model or computation that the message names
  /// @throws InputError as require_potential(), or that names the first load with a couple
  void require_no_couples(const char* model_name) const;
  /// Returns int 1/GJ ds between two arc lengths [1/(N m)], with sections, for a rod that has a GJ.
  [[nodiscard]] double twisting_compliance(double begin, double end) const;
  /// Returns int 1/EI ds between two arc lengths [1/(N m)], EI about d1, with sections.
  [[nodiscard]] double bending_compliance(double begin, double end) const;
  /// Returns w l^3 / (EI) [-], w the mean weight per length and EI the smaller one outside
  /// sections.
  [[nodiscard]] double gamma() const;
  /// Whether the stress-free shape is curved or twisted.
  [[nodiscard]] bool naturally_bent() const { return naturally_curved() || naturally_twisted(); }
  /// Whether the stress-free shape is curved.
  [[nodiscard]] bool naturally_curved() const;
  /// Whether the stress-free shape is twisted.
  [[nodiscard]] bool naturally_twisted() const;
  /// Whether EI about d1 and about d2 differ in the rod or in one of its sections.
  [[nodiscard]] bool has_two_stiffnesses() const;
  /// Whether d1 and d2 are fixed to the rod's material (energy_model::has_material_directors).
  [[nodiscard]] bool has_material_directors() const {
    return naturally_bent() || has_two_stiffnesses();
  }
  /// Returns the frame (columns d1, d2, t) in which the first clamp holds a rod with material
  /// directors.
  /// @throws InputError if there is no clamp, or if neither its frame nor a plane determines d1
  [[nodiscard]] Eigen::Matrix3d first_frame() const;
  /// Returns the normal of the plane in which an intrinsically curved rod is assumed to be bent,
  /// because its first clamp gives no d1: that of the scene without loads
  /// (energy_model::natural_normal). Empty: the clamp gives d1, there is no clamp or no such plane,
  /// or the rod is intrinsically straight.
  [[nodiscard]] std::optional<Eigen::Vector3d> assumed_normal() const;
  /// Returns the scene with an intrinsically straight and untwisted rod.
  [[nodiscard]] Scene without_natural_strain() const;
  /// Returns the mean curvature of the stress-free shape as the vector in space about which the
  /// tangent rotates [1/m], with d1 and d2 as the first clamp holds them; zero for an intrinsically
  /// straight rod.
  /// @throws InputError for a curved rod in the cases of first_frame()
  [[nodiscard]] Eigen::Vector3d natural_curvature() const;
  /// Returns the mean of the natural curvature between two arc lengths, begin < end, as
  /// natural_curvature() does of the whole rod.
  [[nodiscard]] Eigen::Vector3d natural_curvature(double begin, double end) const;
  /// Whether two clamps or more hold the rod's frame, which twists the rod or prevents twist. The
  /// first clamp of a rod with material directors always holds it.
  [[nodiscard]] bool prescribes_twist() const;
  /// Returns the scene with clamps that let the rod rotate about their directions, except for the
  /// first clamp of a rod with material directors.
  [[nodiscard]] Scene without_twist() const;
  /// Returns the unit normal of the plane that contains grips and forces, is perpendicular to
  /// couples and is a plane of symmetry of obstacles in reach; any one of several. Empty if there
  /// is none, if clamps hold twist or a load that follows the rod leaves the plane, which bends the
  /// rod out of it, or if the natural curvature is about another axis, the plane is oblique to the
  /// principal axes of the cross-section, or a curved or not round rod is naturally twisted.
  [[nodiscard]] std::optional<Eigen::Vector3d> plane_normal() const;
  /// Whether plane_normal() exists.
  [[nodiscard]] bool planar() const { return plane_normal().has_value(); }
  [[nodiscard]] int spans() const;  ///< number of intervals between clamps and ends

  /// Replaces the natural curvature and twist by those of a shape. If the shape has several arcs,
  /// each becomes a section or divides existing ones.
  /// @param shape  of a rod of this length
  void set_rest_shape(const RestShape& shape);

  /// Multiplies E and with it EI, EA and GJ, also of sections: their ratios depend only on
  /// Poisson's ratio and on the shapes of the sections.
  void scale_modulus(double factor);
  /// Multiplies GJ, also of sections; an assumed GJ becomes a given one.
  void scale_torsion(double factor);
  /// Multiplies the density and all given masses per length.
  void scale_density(double factor);

  /// Compares all fields.
  bool operator==(const Scene&) const = default;
};

/// Largest distance of a given arc length from the rod that counts as rounding, divided by the rod
/// length: in single precision each of the summed segments is rounded by 6e-8.
inline constexpr double arc_rounding = 1e-6;

/// Returns an arc length given by a user, moved to the end of the rod if it is beyond that end by
/// rounding [m]; empty if it is farther away.
[[nodiscard]] std::optional<double> on_rod(double s, double length);

/// First and last time of all poses of a scene [s].
struct TimeSpan {
  double begin = 0;  ///< [s]
  double end = 0;    ///< [s], >= begin
};

/// Returns the time span of a moving scene; empty if nothing moves.
[[nodiscard]] std::optional<TimeSpan> motion_time_span(const Scene& scene);

/// Returns the static scene at a time: grippers and obstacles are at their poses and have no
/// trajectories.
/// @param obstacle_time  time of the obstacles' poses [s]; a control loop may update them less
/// often
[[nodiscard]] Scene scene_at(const Scene& scene, double time, double obstacle_time);
/// Returns the static scene at one time of grippers and obstacles [s].
[[nodiscard]] Scene scene_at(const Scene& scene, double time);

}  // namespace dlo::compare
