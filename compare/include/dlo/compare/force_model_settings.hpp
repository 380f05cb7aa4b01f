#pragma once

#include <optional>
#include <string>
#include <vector>

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
