#include "reading/new_scene.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/quote.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "toml/quantity.hpp"

namespace dlo::compare {
namespace {

/// Numbers and vectors as they are, all else as a TOML string.
std::string toml_value(const std::string& value) {
  if (value.starts_with('[')) return value;
  try {
    // TOML knows neither ".5" nor "5.".
    return fmt::format("{}", parse_quantity(value, Dimension::number));
  } catch (const InputError&) {
    return toml_string(value);
  }
}

bool is_z_up(const SceneChoices& choices) { return choices.up == "z"; }

/// A vector of this length upwards.
std::string upwards(const SceneChoices& choices, double length) {
  const std::string text = fmt::format("{:.4g}", length);
  return is_z_up(choices) ? "[0, 0, " + text + "]" : "[0, " + text + ", 0]";
}

/// In a scene file angles are in the x-y plane, which is level if z is up.
std::string direction_value(const SceneChoices& choices) {
  if (!is_z_up(choices) || choices.direction.starts_with('[')) {
    return toml_value(choices.direction);
  }
  try {
    const double angle = parse_quantity(choices.direction, Dimension::angle);
    const auto rounded = [](double value) { return std::abs(value) < 1e-15 ? 0 : value; };
    return fmt::format("[{}, 0, {}]", rounded(std::cos(angle)), rounded(std::sin(angle)));
  } catch (const InputError&) {
    return toml_value(choices.direction);  // reading the scene tells what is wrong
  }
}

std::string direction_words(const SceneChoices& choices) {
  return is_z_up(choices)
             ? "# Of the rod there, along growing arc length: a vector; [0, 0, -1] hangs down, [1, "
               "0, 0] is\n# level. A pin has none."
             : "# Of the rod there, along growing arc length: an angle in the x-y plane from +x "
               "(\"-90 deg\" hangs\n# down; without unit: rad), or a vector such as [1, 0, 0]. A "
               "pin has none.";
}

std::string material_lines(const SceneChoices& choices, const std::vector<Material>& known) {
  std::string names;
  for (const Material& material : known) {
    names += (names.empty() ? "" : (names.size() - names.rfind('\n')) > 75 ? ",\n#   " : ", ");
    names += material.name;
  }
  const std::string head = fmt::format(
      "# A name, or your own as {{ youngs_modulus = \"5 MPa\", density = \"1100 kg/m^3\" }}.\n"
      "# Moduli in Pa, kPa, MPa, GPa; densities in kg/m^3, g/cm^3. dlo materials lists the "
      "values:\n"
      "#   {}\n",
      names);
  if (choices.youngs_modulus.empty()) {
    return head + fmt::format("material = {}\n", toml_string(choices.material));
  }
  return head + fmt::format("material = {{ youngs_modulus = {}, density = {} }}\n",
                            toml_value(choices.youngs_modulus), toml_value(choices.density));
}

std::string required_part(const SceneChoices& choices, const std::vector<Material>& known) {
  return fmt::format(
      R"(# A scene of dlo: a rod, what holds it and what pulls at it. It solves as it is:
#   dlo solve FILE
# Numbers are in SI units; a string may carry another unit: 0.006 or "6 mm".
# Lines that begin with # and no blank are optional: take the # away to use them.

name = {name}
gravity = {gravity}  # m/s^2; {up} points up

[rod]
length = {length}  # {units}
diameter = {diameter}  # round, solid; bending stiffness EI = E pi d^4 / 64
{material}# Or what was measured, in place of diameter and material (they may stay, for the axial stiffness):
#   bending_stiffness = "1.2e-3 N m^2", mass_per_length = "20 g/m"
# EI of a chain of hinges: joint_stiffness = "0.03 N m/rad" and joint_spacing = "4 cm" instead.
# A tube has an inner_diameter too; a flat rod has width (along d1) and thickness in place of diameter.
# Of a flat cable bending_stiffness = ["1.2e-3 N m^2", "0.04 N m^2"], about d1 and about d2 of the
# first clamp's frame: d2 is the normal of the scene's plane unless a frame or roll says otherwise.
# The stress-free shape need not be straight: natural_curvature = "3 1/m" bends it to the left in its plane;
# [x, y] are about d1 and d2 of the first clamp's frame, natural_twist = "90 deg/m" about the rod.
# torsional_stiffness (GJ) is then EI / 1.3, if it is not given. Instead of these two, of a helix:
# helix = {{ radius = "2 cm", pitch = "1 cm" }}; of points of that shape in space: rest_shape = "points.csv".
# stretch = true lets model exact stretch it by its tension over EA: axial_stiffness = "400 kN", or E A;
# stretch = "auto" where that moves the shape or changes the tension by more than --target-error.
# Of a cable, from the inside out, instead of diameter and material:
# layers = [{{ outer_diameter = "2 mm", material = "copper" }}, {{ strands = 6, strand_diameter = "2 mm",
# material = "copper" }}], and layer_bound = "free" of strands that slip on each other.

# What holds the rod; one [[gripper]] for each.
[[gripper]]
at = 0  # arc length that is held, from 0 to the rod's length
position = [0, 0, 0]  # of the rod's axis there [x, y, z]
# "clamp" holds position and direction, "pin" the position only
hold = "clamp"
{direction_words}
direction = {direction}
)",
      fmt::arg("name", toml_string(choices.name)),
      fmt::arg("units", known_units(Dimension::length)),
      fmt::arg("length", toml_value(choices.length)),
      fmt::arg("diameter", toml_value(choices.diameter)),
      fmt::arg("material", material_lines(choices, known)),
      fmt::arg("gravity", upwards(choices, -9.81)), fmt::arg("up", choices.up),
      fmt::arg("direction_words", direction_words(choices)),
      fmt::arg("direction", direction_value(choices)));
}

enum class Meaning { said, omitted };

/// Names as TOML has them, with what they mean if `meaning` is asked for.
template <Chosen Value>
std::string toml_choices(Meaning meaning) {
  std::vector<std::string> choices;
  for (const auto& choice : Choices<Value>::all) {
    choices.push_back(toml_string(choice.name));
    if (meaning == Meaning::said) choices.back() += fmt::format(" ({})", choice.meaning);
  }
  return one_of(choices);
}

constexpr char optional_lines[] = R"(
# A clamp lets the rod rotate about its direction unless it holds the rod's frame, by one of
#   roll = "90 deg"             turned on from the first such clamp's frame, turns counted
#   frame = [[1, 0, 0], ..]     rows d1, d2, d3; d3 is the direction
#   quaternion = [1, 0, 0, 0]   w, x, y, z; it turns the axes x, y, z into d1, d2, d3
# the latter two with turns = 1, 2, .. for whole turns more. Two such clamps twist the rod between
# them; [rod] then needs torsional_stiffness = "{torsion:.3g} N m^2" (GJ, here EI / 1.3).

# A second gripper, here a pin at the other end.
#[[gripper]]
#at = {length:.4g}
#position = [{x:.4g}, {y:.4g}, {z:.4g}]
#hold = "pin"

# A gripper, or an [[obstacle]], may move, and dlo track follows the rod. In place of position and
# direction (of an obstacle: point) it has two poses or more; all else takes the first, or --time T:
#   [[gripper.pose]]
#   time = 0                  s, ms, min
#   position = [{x:.4g}, {y:.4g}, {z:.4g}]
#   direction = {direction}   of a clamp; in no pose: the gripper's own stays
# or trajectory = "way.csv" beside this file: a header time,x,y,z[,dx,dy,dz][,roll], in s, m, rad.
# Or of two markers on the gripper: time,s,x,y,z, s where they are along the rod, straight there.
# With cutoff = "10 Hz" beside it what is faster is left out, without a lag (-3 dB there).

# A part of the rod that is another one, such as a connector; one [[section]] for each. What it does
# not say is the rod's own; torsional_stiffness too, where the rod has one.
#[[section]]
#from = {section_from:.4g}  # arc lengths
#to = {section_to:.4g}
#bending_stiffness = {section_EI:.3g}  # N m^2, N mm^2
#mass_per_length = {section_mass:.3g}  # kg/m, g/m, g/cm

# A force at a point of the rod, one [[load]] for each; of a weight that hangs there mass = "10 g"; of
# a couple torque = [0, 0, "1 N m"]; follows = true lets both turn with the rod. Along the rod
# [[distributed_load]] has from, to and force_per_length; [medium] has the density of what the rod is
# immersed in, and the velocity of what drags it.
#[[load]]
#at = {middle:.4g}  # arc length
#force = {force}  # N, mN, kN

# What the rod cannot pass; one [[obstacle]] for each. Grippers are outside of it.
#[[obstacle]]
#shape = "plane"
#point = {floor}  # any point of the plane
#normal = {normal}  # to the free side
# Other shapes: point is the middle of
#   "sphere"    with radius
#   "cylinder"  with axis and radius, without ends
#   "capsule"   with axis, radius and the length between the middles of its round ends
#   "box"       with size = [along axis (+x), along normal (+y), across], radius of its edges
#touches = "surface"  # of the rod, half a diameter from its axis; or "axis"
# Force per depth and per length of rod if it yields (N/m^2, N/mm^2); without it it is rigid.
#stiffness = {stiffness:.3g}
# Coulomb's coefficient. No model has friction, and what solves the scene says so where it counts.
#friction = 0.3

# How dlo track looks at what moves.
#[track]
#frame_rate = "{frames:g} Hz"  # Hz, kHz
#obstacle_rate = "25 Hz"  # how often obstacles move; without it with every frame
#step_rate = "{steps:g} Hz"  # steps of the force model a second
# With --dynamic, start = "start.csv" beside this file releases the rod from a shape (x,y,z[,s]), or
# continues a recording (time,s,x,y,z), in s and m; without it the rod starts in equilibrium.

# The force model, which dlo compare, calibrate and solve --model force use; these are the defaults.
# dlo calibrate FILE -o params.toml finds the parameters.
#[force_model]
#points = {points}  # N, 4 or more
#law = "{law}"  # of the joints: {laws}
#bookkeeping = "{bookkeeping}"  # {bookkeepings}
#stepper = "{stepper}"  # {steppers}
#c_c = {c_c:.4g}  # N, stretch stiffness, here A E
# Further keys, where law, bookkeeping or stepper allow them:
#   c_b              [N]    bending stiffness, law paper; else it follows from
#   bending_rule     {bending_rules}, law paper
#   design_curvature [1/m]  k of the bending rule
#   joint_law        {joint_laws}: joints of model chain alone, law hooke
#   point_weight     [N]    weight of every point, bookkeeping paper
#   c_F              [m/N]  step factor, stepper basic, limited, relative or dynamic
#   c_h              [-]    share of the last movement, 0 <= c_h < 1, stepper dynamic
#   l_s              [m]    largest movement per step, stepper limited, relative, dynamic or auto
)";

/// Examples that fit the rod: a pin at its end, a small force, a floor in its reach.
std::string optional_part(const SceneChoices& choices, const Scene& scene) {
  const double l = scene.length;
  const Eigen::Vector3d pin = 0.7 * l * scene.grippers.front().direction.value();
  const double weight = scene.mass() * scene.gravity.norm();
  const ForceModelSettings defaults;
  const double force = weight > 0 ? weight : scene.bending_stiffness() / (l * l);
  return fmt::format(
      optional_lines, fmt::arg("torsion", scene.bending_stiffness() / 1.3), fmt::arg("length", l),
      fmt::arg("section_from", 0.4 * l), fmt::arg("section_to", 0.45 * l),
      fmt::arg("section_EI", 10 * scene.bending_stiffness()),
      fmt::arg("section_mass", 2 * scene.mass_per_length()), fmt::arg("x", pin.x()),
      fmt::arg("y", pin.y()), fmt::arg("z", pin.z()), fmt::arg("middle", l / 2),
      fmt::arg("force", upwards(choices, -0.1 * force)),
      fmt::arg("floor",
               upwards(choices, std::min(is_z_up(choices) ? pin.z() : pin.y(), 0.0) - 0.1 * l)),
      fmt::arg("normal", upwards(choices, 1)), fmt::arg("stiffness", 1e3 * force / (l * l)),
      fmt::arg("c_c", scene.axial_stiffness()), fmt::arg("direction", direction_value(choices)),
      fmt::arg("frames", scene.track.frames), fmt::arg("steps", scene.track.steps),
      fmt::arg("points", defaults.points), fmt::arg("law", to_string(defaults.law)),
      fmt::arg("laws", toml_choices<BendingLaw>(Meaning::said)),
      fmt::arg("joint_laws", toml_choices<energy_model::JointLaw>(Meaning::omitted)),
      fmt::arg("bookkeeping", to_string(defaults.bookkeeping)),
      fmt::arg("bookkeepings", toml_choices<Bookkeeping>(Meaning::said)),
      fmt::arg("stepper", to_string(defaults.stepper)),
      fmt::arg("steppers", toml_choices<Stepper>(Meaning::omitted)),
      fmt::arg("bending_rules", toml_choices<BendingRule>(Meaning::omitted)));
}

}  // namespace

std::string scene_text(const SceneChoices& choices, const std::vector<Material>& known_materials) {
  const std::string text = required_part(choices, known_materials);
  const Scene scene = parse_scene(text, "the new scene", known_materials);
  if (scene.diameter > scene.length) {
    throw InputError("the new scene", "rod.diameter",
                     fmt::format(" = {}: thicker than long (allowed: at most the length, {:g} m)",
                                 choices.diameter, scene.length));
  }
  return text + optional_part(choices, scene);
}

}  // namespace dlo::compare
