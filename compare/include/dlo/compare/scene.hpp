#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/material.hpp"

namespace dlo::compare {

enum class Law { paper, hooke };
enum class Bookkeeping {
  paper,       ///< L = l/(N-1), P_0 at the gripper, masses m/N
  consistent,  ///< the gripper holds the middle of a segment, weights w L, w L/2 at a free end
};
enum class StepperName { basic, limited, relative, dynamic, automatic };
/// How c_b of the paper's law follows from the material.
enum class BendingRule {
  formula_21,      ///< the paper's: EI k^2 / ((1 - cos a) sin(a/2)), a = L k
  moment_matched,  ///< the physical moment at curvature k: Formula 21 divided by a
};

[[nodiscard]] const char* to_string(Law law);
[[nodiscard]] const char* to_string(Bookkeeping bookkeeping);
[[nodiscard]] const char* to_string(StepperName stepper);
[[nodiscard]] const char* to_string(BendingRule rule);

struct Gripper {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< unit; a clamp has one, a pin has none
  std::string where;                                   ///< "file:line", for messages
};

struct PointLoad {
  double at = 0;                                    ///< arc length [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
};

struct Obstacle {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< of the plane [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< unit, to the free side
  /// Force per depth and per length of rod [N/m^2]; infinite: rigid.
  double stiffness = std::numeric_limits<double>::infinity();
};

/// Settings of the force model. Zeros are derived.
struct ForceModelSettings {
  int points = 16;  ///< N
  Law law = Law::hooke;
  Bookkeeping bookkeeping = Bookkeeping::consistent;
  StepperName stepper = StepperName::automatic;
  BendingRule bending_rule = BendingRule::formula_21;
  std::optional<double> design_curvature;  ///< k of Formula 21 [1/m]
  std::optional<double> point_weight;      ///< of every point, bookkeeping `paper` only [N]
  std::optional<double> c_b;               ///< [N]
  std::optional<double> c_c;               ///< [N]; default: AE
  std::optional<double> c_F;               ///< [m/N]
  std::optional<double> c_h;               ///< [-]
  std::optional<double> l_s;               ///< [m]
};

/// @throws InputError, beginning with `where`, if settings contradict each other, such as a c_F for
/// a stepper that chooses its own
void check(const ForceModelSettings& settings, const std::string& where);

/// Reads a parameters file, as `dlo calibrate` writes it: a [force_model] table with the keys of a
/// scene's; the table [derived], for programs of the user's own, is left alone.
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] ForceModelSettings parse_parameters(const std::string& text, const std::string& file);
[[nodiscard]] ForceModelSettings load_parameters(const std::string& path);

/// A physical scene in SI units.
struct Scene {
  std::string name;
  std::string file;
  Eigen::Vector3d gravity = {0, -9.81, 0};  ///< [m/s^2]
  double length = 0;                        ///< l [m]
  double diameter = 0;                      ///< d [m]
  Material material;
  std::vector<Gripper> grippers;
  std::vector<PointLoad> loads;
  std::vector<Obstacle> obstacles;
  ForceModelSettings force_model;

  [[nodiscard]] double cross_section() const;               ///< A [m^2]
  [[nodiscard]] double bending_stiffness() const;           ///< EI [N m^2]
  [[nodiscard]] double axial_stiffness() const;             ///< EA [N]
  [[nodiscard]] Eigen::Vector3d weight_per_length() const;  ///< rho A g [N/m]
  [[nodiscard]] double mass() const;                        ///< [kg]
  [[nodiscard]] double gamma() const;                       ///< w l^3 / (EI) [-]
  /// Unit normal of the plane that grips, forces and obstacles share, if they do; of several planes
  /// any one.
  [[nodiscard]] std::optional<Eigen::Vector3d> plane_normal() const;
  [[nodiscard]] bool planar() const { return plane_normal().has_value(); }
  [[nodiscard]] int spans() const;  ///< parts that the clamps cut the rod into
};

/// Reads a scene. @param file  its name, for messages and Scene::file
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Scene parse_scene(const std::string& text, const std::string& file,
                                const std::vector<Material>& known_materials = materials());

[[nodiscard]] Scene load_scene(const std::string& path,
                               const std::vector<Material>& known_materials = materials());

/// The three scenes of the paper's Figs. 12 and 13, built into the library (data/scenes).
[[nodiscard]] std::vector<Scene> paper_scenes();

/// Names of choices, as scene files and options spell them.
[[nodiscard]] const std::vector<std::string>& law_names();
[[nodiscard]] const std::vector<std::string>& bookkeeping_names();
[[nodiscard]] const std::vector<std::string>& stepper_names();
[[nodiscard]] const std::vector<std::string>& bending_rule_names();
[[nodiscard]] Law law_from(const std::string& name);
[[nodiscard]] Bookkeeping bookkeeping_from(const std::string& name);
[[nodiscard]] StepperName stepper_from(const std::string& name);
[[nodiscard]] BendingRule bending_rule_from(const std::string& name);

}  // namespace dlo::compare
