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

/// Where the polygon's points and weights are along the rod.
enum class Bookkeeping {
  paper,       ///< L = l/(N-1), P_0 at the gripper, masses m/N
  consistent,  ///< the gripper holds the middle of a segment, weights w L, w L/2 at a free end
};

/// Of the joints' law.
template <>
struct Choices<BendingLaw> {
  /// In the enumeration's order.
  static constexpr Choice<BendingLaw> all[] = {{BendingLaw::paper, "paper", "cubic in the angle"},
                                               {BendingLaw::hooke, "hooke", "as a rod bends"}};
};

/// Of the joints of model chain.
template <>
struct Choices<energy_model::JointLaw> {
  /// Without that of the paper, which is BendingLaw's.
  static constexpr Choice<energy_model::JointLaw> all[] = {
      {energy_model::JointLaw::hooke, "hooke", "linear in 2 tan(angle/2), as a rod bends"},
      {energy_model::JointLaw::linear, "linear", "linear in the angle, as most simulators have it"},
      {energy_model::JointLaw::binormal, "binormal", "discrete elastic rods"}};
};

/// Of the bookkeeping.
template <>
struct Choices<Bookkeeping> {
  /// In the enumeration's order.
  static constexpr Choice<Bookkeeping> all[] = {
      {Bookkeeping::paper, "paper", "as printed"},
      {Bookkeeping::consistent, "consistent", "second order in the segment length"}};
};

/// Of the stepper.
template <>
struct Choices<Stepper> {
  /// In the enumeration's order.
  static constexpr Choice<Stepper> all[] = {
      {Stepper::basic, "basic", "moves by c_F F"},
      {Stepper::limited, "limited", "no point further than l_s"},
      {Stepper::relative, "relative", "or than l_s against its neighbour"},
      {Stepper::dynamic, "dynamic", "relative, plus c_h of the last movement"},
      {Stepper::automatic, "auto", "finds its own constants"},
      {Stepper::verlet, "verlet", "velocities and real masses"},
      {Stepper::implicit, "implicit", "Newton's steps, seldom more than thirty"}};
};

/// Settings of the force model. What is not given is derived from the scene.
struct ForceModelSettings {
  int points = 16;                     ///< N
  BendingLaw law = BendingLaw::hooke;  ///< of bending
  /// Of model chain alone, besides law hooke: joints as other programs have them; none: as `law`.
  std::optional<energy_model::JointLaw> joint_law = std::nullopt;
  Bookkeeping bookkeeping = Bookkeeping::consistent;   ///< of the polygon
  Stepper stepper = Stepper::automatic;                ///< of the simulation
  BendingRule bending_rule = BendingRule::formula_21;  ///< of the law `paper`
  std::optional<double> design_curvature;              ///< k of Formula 21 [1/m]
  std::optional<double> point_weight;  ///< of every point, bookkeeping `paper` only [N]
  std::optional<double> c_b;           ///< [N]
  std::optional<double> c_c;           ///< [N]; default: AE
  std::optional<double> c_F;           ///< [m/N]
  std::optional<double> c_h;           ///< [-]
  std::optional<double> l_s;           ///< [m]

  /// In every field.
  bool operator==(const ForceModelSettings&) const = default;
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

}  // namespace dlo::compare
