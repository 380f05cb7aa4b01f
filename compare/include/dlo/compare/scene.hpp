#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/material.hpp"

namespace dlo::compare {

/// The joints' law of the force model, see force_model::BendingLaw.
enum class Law { paper, hooke };
/// Where the polygon's points and weights are along the rod.
enum class Bookkeeping {
  paper,       ///< L = l/(N-1), P_0 at the gripper, masses m/N
  consistent,  ///< the gripper holds the middle of a segment, weights w L, w L/2 at a free end
};
/// The force model's steppers, see force_model::Stepper.
enum class StepperName { basic, limited, relative, dynamic, automatic };
/// How c_b of the paper's law follows from the material.
enum class BendingRule {
  formula_21,      ///< the paper's: EI k^2 / ((1 - cos a) sin(a/2)), a = L k
  moment_matched,  ///< the physical moment at curvature k: Formula 21 divided by a
};

/// As a scene file spells it.
[[nodiscard]] const char* to_string(Law law);
/// As a scene file spells it.
[[nodiscard]] const char* to_string(Bookkeeping bookkeeping);
/// As a scene file spells it.
[[nodiscard]] const char* to_string(StepperName stepper);
/// As a scene file spells it.
[[nodiscard]] const char* to_string(BendingRule rule);

/// What holds a point of the rod.
struct Gripper {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< unit; a clamp has one, a pin has none
  std::string where;                                   ///< "file:line", for messages
};

/// A force that keeps its direction.
struct PointLoad {
  double at = 0;                                    ///< arc length [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
};

/// A half-space that the rod stays out of.
struct Obstacle {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< of the plane [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< unit, to the free side
  /// Force per depth and per length of rod [N/m^2]; infinite: rigid.
  double stiffness = std::numeric_limits<double>::infinity();
};

/// Settings of the force model. What is not given is derived from the scene.
struct ForceModelSettings {
  int points = 16;                                     ///< N
  Law law = Law::hooke;                                ///< of bending
  Bookkeeping bookkeeping = Bookkeeping::consistent;   ///< of the polygon
  StepperName stepper = StepperName::automatic;        ///< of the simulation
  BendingRule bending_rule = BendingRule::formula_21;  ///< of the law `paper`
  std::optional<double> design_curvature;              ///< k of Formula 21 [1/m]
  std::optional<double> point_weight;  ///< of every point, bookkeeping `paper` only [N]
  std::optional<double> c_b;           ///< [N]
  std::optional<double> c_c;           ///< [N]; default: AE
  std::optional<double> c_F;           ///< [m/N]
  std::optional<double> c_h;           ///< [-]
  std::optional<double> l_s;           ///< [m]
};

/// @throws InputError, beginning with `where`, if settings contradict each other, such as a c_F for
/// a stepper that chooses its own
void check(const ForceModelSettings& settings, const std::string& where);

/// Reads a parameters file, as `dlo calibrate` writes it: a [force_model] table with the keys of a
/// scene's; the table [derived], for programs of the user's own, is left alone.
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] ForceModelSettings parse_parameters(const std::string& text, const std::string& file);
/// Reads such a file. @throws InputError as parse_parameters, or if it cannot be read
[[nodiscard]] ForceModelSettings load_parameters(const std::string& path);

/// A physical scene in SI units.
struct Scene {
  std::string name;                         ///< for people; regression tests know the scene by it
  std::string file;                         ///< where it was read from, for messages
  Eigen::Vector3d gravity = {0, -9.81, 0};  ///< [m/s^2]
  double length = 0;                        ///< l [m]
  double diameter = 0;                      ///< d [m]
  Material material;                        ///< round rod of one material
  std::vector<Gripper> grippers;            ///< one or more, in the file's order
  std::vector<PointLoad> loads;             ///< may be empty
  std::vector<Obstacle> obstacles;          ///< may be empty
  ForceModelSettings force_model;           ///< as the file has it

  [[nodiscard]] double cross_section() const;               ///< A [m^2]
  [[nodiscard]] double bending_stiffness() const;           ///< EI [N m^2]
  [[nodiscard]] double axial_stiffness() const;             ///< EA [N]
  [[nodiscard]] Eigen::Vector3d weight_per_length() const;  ///< rho A g [N/m]
  [[nodiscard]] double mass() const;                        ///< [kg]
  [[nodiscard]] double gamma() const;                       ///< w l^3 / (EI) [-]
  /// Unit normal of the plane that grips, forces and obstacles share, if they do; of several planes
  /// any one.
  [[nodiscard]] std::optional<Eigen::Vector3d> plane_normal() const;
  /// Whether there is one.
  [[nodiscard]] bool planar() const { return plane_normal().has_value(); }
  [[nodiscard]] int spans() const;  ///< parts that the clamps cut the rod into
};

/// Reads a scene. @param file  its name, for messages and Scene::file
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Scene parse_scene(const std::string& text, const std::string& file,
                                const std::vector<Material>& known_materials = materials());

/// Reads a scene file. @throws InputError as parse_scene, or if it cannot be read
[[nodiscard]] Scene load_scene(const std::string& path,
                               const std::vector<Material>& known_materials = materials());

/// The three scenes of the paper's Figs. 12 and 13, built into the library (data/scenes).
[[nodiscard]] std::vector<Scene> paper_scenes();

/// Names of choices, as scene files and options spell them.
[[nodiscard]] const std::vector<std::string>& law_names();
/// Of Bookkeeping.
[[nodiscard]] const std::vector<std::string>& bookkeeping_names();
/// Of StepperName.
[[nodiscard]] const std::vector<std::string>& stepper_names();
/// Of BendingRule.
[[nodiscard]] const std::vector<std::string>& bending_rule_names();
/// @throws InputError if there is no such law
[[nodiscard]] Law law_from(const std::string& name);
/// @throws InputError if there is no such bookkeeping
[[nodiscard]] Bookkeeping bookkeeping_from(const std::string& name);
/// @throws InputError if there is no such stepper
[[nodiscard]] StepperName stepper_from(const std::string& name);
/// @throws InputError if there is no such rule
[[nodiscard]] BendingRule bending_rule_from(const std::string& name);

}  // namespace dlo::compare
