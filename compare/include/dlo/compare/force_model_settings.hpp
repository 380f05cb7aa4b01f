#pragma once

#include <optional>
#include <string>

#include "dlo/compare/bending_rule.hpp"
#include "dlo/compare/choice.hpp"
#include "dlo/energy_model/chain.hpp"
#include "dlo/force_model/bending_law.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::compare {

using force_model::BendingLaw;
using force_model::Stepper;

/// Positions and weights of the polygon's points along the rod.
enum class Bookkeeping {
  paper,       ///< L = l/(N-1), P_0 at the gripper, masses m/N
  consistent,  ///< the gripper holds the middle of a segment, weights w L, w L/2 at a free end
};

/// Names of the joints' bending laws.
template <>
struct Choices<BendingLaw> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<BendingLaw> all[] = {{BendingLaw::paper, "paper", "cubic in the angle"},
                                               {BendingLaw::hooke, "hooke", "as a rod bends"}};
};

/// Names of the joint laws of model chain.
template <>
struct Choices<energy_model::JointLaw> {
  /// All values except the paper's law, which is in Choices<BendingLaw>.
  static constexpr Choice<energy_model::JointLaw> all[] = {
      {energy_model::JointLaw::hooke, "hooke", "linear in 2 tan(angle/2), as a rod bends"},
      {energy_model::JointLaw::linear, "linear", "linear in the angle, as most simulators have it"},
      {energy_model::JointLaw::binormal, "binormal", "discrete elastic rods"}};
};

/// Names of the bookkeeping.
template <>
struct Choices<Bookkeeping> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<Bookkeeping> all[] = {
      {Bookkeeping::paper, "paper", "as printed"},
      {Bookkeeping::consistent, "consistent", "second order in the segment length"}};
};

/// Names of the steppers.
template <>
struct Choices<Stepper> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<Stepper> all[] = {
      {Stepper::basic, "basic", "moves by c_F F"},
      {Stepper::limited, "limited", "no point further than l_s"},
      {Stepper::relative, "relative", "or than l_s against its neighbour"},
      {Stepper::dynamic, "dynamic", "relative, plus c_h of the last movement"},
      {Stepper::automatic, "auto", "finds its own constants"},
      {Stepper::verlet, "verlet", "velocities and real masses"},
      {Stepper::implicit, "implicit", "Newton's steps, seldom more than thirty"}};
};

/// Settings of the force model. Values that are not given are derived from the scene.
struct ForceModelSettings {
  int points = 16;                     ///< N
  BendingLaw law = BendingLaw::hooke;  ///< bending law
  /// Joint law of another program, which only model chain supports, in place of law hooke. Empty:
  /// `law` applies.
  std::optional<energy_model::JointLaw> joint_law = std::nullopt;
  Bookkeeping bookkeeping = Bookkeeping::consistent;   ///< end and mass convention of the polygon
  Stepper stepper = Stepper::automatic;                ///< stepper of the simulation
  BendingRule bending_rule = BendingRule::formula_21;  ///< rule for c_b of the law `paper`
  std::optional<double> design_curvature;              ///< k of Formula 21 [1/m]
  std::optional<double> point_weight;  ///< weight of every point, for bookkeeping `paper` only [N]
  std::optional<double> c_b;           ///< [N]
  std::optional<double> c_c;           ///< [N]; default: AE
  std::optional<double> c_F;           ///< [m/N]
  std::optional<double> c_h;           ///< [-]
  std::optional<double> l_s;           ///< [m]

  /// Compares all fields.
  bool operator==(const ForceModelSettings&) const = default;
};

/// Checks that settings do not contradict each other.
/// @throws InputError, beginning with `where`, if they do, such as a c_F for a stepper that chooses
/// its own
void check(const ForceModelSettings& settings, const std::string& where);

/// Reads a parameters file, as `dlo calibrate` writes it: a table [force_model] with the keys of a
/// scene's. The table [derived], for other programs, is ignored.
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] ForceModelSettings parse_parameters(const std::string& text, const std::string& file);

/// Reads a parameters file from a path. @throws InputError as parse_parameters, or if it cannot be
/// read
[[nodiscard]] ForceModelSettings load_parameters(const std::string& path);

}  // namespace dlo::compare
