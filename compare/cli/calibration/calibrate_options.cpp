#include "calibration/calibrate_options.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"
#include "fit/chain_springs.hpp"
#include "option/option_values.hpp"
#include "option/share.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {
namespace {

constexpr const char* measured = "Young's modulus from measured shapes";

/// Reads the quantity > 0 of an option, if it is given.
std::optional<double> quantity_of(const char* option, const std::string& text,
                                  compare::Dimension dimension) {
  if (text.empty()) return std::nullopt;
  try {
    const double value = compare::parse_quantity(text, dimension);
    if (value > 0) return value;
  } catch (const compare::InputError& error) {
    throw compare::InputError(fmt::format("{} = {}: {}", option, text, error.what()));
  }
  throw compare::InputError(fmt::format("{} = {}: out of range (allowed: > 0)", option, text));
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("+-0123456789") == std::string::npos;
}

/// Returns an empty string for a file or for a number in range, else the error.
std::string check_segments(const std::string& text) {
  if (!is_number(text)) return "";
  std::string copy = text;
  return CLI::Range(4, 200)(copy);
}

}  // namespace

ChainLayout CalibrateOptions::chain_layout() const {
  if (segments.empty()) return {};
  if (is_number(segments)) return {.segments = std::stoi(segments)};
  return {.segment_lengths = compare::segment_lengths(shape_options.load(segments).points)};
}

compare::MaterialFitOptions CalibrateOptions::material_options() const {
  constexpr int profile_points = 41;
  using compare::Dimension;
  const ChainLayout chain = chain_layout();
  return {.pose = shape_options.pose(),
          .arc_lengths = shape_options.arc_lengths(),
          .density = density,
          .torsional_stiffness = torsional_stiffness,
          .natural_curvature_terms = natural_curvature_terms,
          .direction_tolerance =
              quantity_of("--clamp-angles", clamp_angles, Dimension::angle).value_or(0),
          .position_tolerance =
              quantity_of("--clamp-positions", clamp_positions, Dimension::length).value_or(0),
          .roll_tolerance = quantity_of("--clamp-rolls", clamp_rolls, Dimension::angle).value_or(0),
          .shared_clamps = same_clamps,
          .direction_scatter =
              quantity_of("--clamp-scatter", clamp_scatter, Dimension::angle).value_or(0),
          .camera_tilt = quantity_of("--camera-tilt", camera_tilt, Dimension::angle).value_or(0),
          .predict = predict,
          .choose_options = chosen.empty() ? std::nullopt : std::optional(chosen == "auto"),
          .chain_segments = chain.segments,
          .chain_segment_lengths = chain.segment_lengths,
          .profile_points = plot.draws() ? profile_points : 0,
          .noise = quantity_of("--noise", noise, Dimension::length),
          .solve = overrides.solve()};
}

/// Adds the options of quantities that are fitted in addition to E.
void CalibrateOptions::add_numbers_of_wire(CLI::App& command, CLI::Option* shape) {
  const OptionGroup group(command, measured);
  const auto of_shapes = [shape](CLI::Option* option) { option->needs(shape); };
  of_shapes(command.add_flag("--density", density, "fit the density as well"));
  of_shapes(command.add_flag("--torsional-stiffness", torsional_stiffness,
                             "fit GJ as well, from shapes whose clamps twist the wire"));
  of_shapes(command.add_option(
      "--noise", noise,
      "standard deviation of one coordinate such as \"0.5 mm\"; default: estimated"));
  of_shapes(command
                .add_option("--natural-curvature", natural_curvature_terms,
                            "also fit the wire's natural curvature by this many Legendre "
                            "polynomials (1: constant along the wire)")
                ->check(CLI::Range(0, 24)));
  of_shapes(
      command.add_option("--clamp-angles", clamp_angles,
                         "standard deviation of the clamps' directions such as \"5 deg\"; the "
                         "directions are fitted as well, per shape unless --same-clamps"));
  of_shapes(command.add_option("--clamp-positions", clamp_positions,
                               "standard deviation of the grippers' positions such as \"2 mm\"; "
                               "the positions are fitted as well, per shape unless --same-clamps"));
  of_shapes(command.add_option(
      "--clamp-rolls", clamp_rolls,
      "standard deviation of the clamps' rolls, their rotations about the wire's tangent, in "
      "space: \"180 deg\" if they are unknown; fitted per shape, even with --same-clamps"));
  of_shapes(command.add_flag(
      "--same-clamps", same_clamps,
      "the clamps have the same misalignment in all shapes, as in one fixture: one misalignment is "
      "fitted to all shapes, and -o writes it; with --clamp-angles or --clamp-positions"));
  of_shapes(command.add_option(
      "--clamp-scatter", clamp_scatter,
      "with --same-clamps: standard deviation of each shape's directions from the shared ones, "
      "such as \"5 deg\"; these deviations are fitted as well"));
  of_shapes(
      command.add_option("--camera-tilt", camera_tilt,
                         "standard deviation of the camera's tilt from level, such as \"2 deg\"; "
                         "one tilt common to all shapes is fitted as well, and -o writes it"));
  of_shapes(command.add_flag("--predict", predict,
                             "leave out each shape in turn and predict it by the fit to the "
                             "others: says which options predict best (three shapes or more)"));
  of_shapes(
      command
          .add_option(
              "--options", chosen,
              "given: fit with the options as given; auto: if residuals are systematic, choose the "
              "number of natural curvature terms and nominal, shared or per-shape clamps by "
              "leave-one-out prediction; default: auto if there are three shapes or more and "
              "neither --natural-curvature, --same-clamps nor an option --clamp-* is given")
          ->check(CLI::IsMember({"given", "auto"})));
}

void CalibrateOptions::add_output(CLI::App& command) {
  std::vector<std::string> formats = compare::names<Format>();
  formats.emplace_back("toml");
  add_checked(command, "--format", output.format, CLI::IsMember(formats),
              "text, json, csv or toml");
  add_file(command, "-o,--output", output.file,
           "write to FILE instead of standard output; .json and .csv are formats, a .toml gets "
           "what --parameters (with --shape: --materials and --calibrated, with --motion: "
           "--calibrated) reads, and the text still goes to standard output");
  take_format_of_file(command, output, formats);
}

void CalibrateOptions::add_to(CLI::App& command) {
  command.add_option("SCENE", scenes, "scene files (TOML)")->required();
  const std::string parameters = "Parameters of the force model";
  CLI::Option* holdout =
      command
          .add_option("--holdout", holdouts,
                      "hold-out scenes, or with --shape hold-out shapes: judged, not fitted. If "
                      "each shape has its own scene, the scenes of hold-out shapes come last")
          ->type_name("FILE ...")
          ->group(parameters);
  CLI::Option* wanted =
      command
          .add_option("--target", target,
                      "RMS deviation wanted, share of the length such as 0.1%; law hooke takes N "
                      "from it unless --points is given. Exit status 1 if it is missed; without "
                      "--target the default is 0.1%, and status is 0")
          ->transform(share_of_length())
          ->group(parameters);
  CLI::Option* shape =
      command.add_option("--shape", shapes, "one per scene, or several of one scene")
          ->type_name("FILE ...")
          ->excludes(wanted)
          ->group(measured);
  add_numbers_of_wire(command, shape);
  command
      .add_option(
          "--motion", motions,
          "recorded motions of the rod, CSV files of markers, time,s,x,y,z in s and m: stiffness "
          "over mass and damping. Exit status 3 if the stiffness is not identified")
      ->type_name("FILE ...")
      ->excludes(shape)
      ->excludes(holdout)
      ->excludes(wanted)
      ->group("Stiffness and damping from a recorded motion");
  command
      .add_option(
          "--segments", segments,
          "number of segments of your simulator's chain, 4 to 200, or a file of its points if the "
          "segments are unequal: computes the joint stiffness for which the chain is closest to "
          "the rod, for three ways to clamp it; with --shape: closest to the fitted rod")
      ->type_name("N|FILE")
      ->check(check_segments)
      ->excludes(wanted)
      ->excludes(holdout)
      ->group(measured);
  plot.add_to(command, "points on the fitted rod, and E's profile likelihood,")
      ->needs(shape)
      ->group(measured);
  shape_options.add_to(command, ChordLengths::not_exact_enough);
  overrides.add_to(command);
  add_output(command);
}

}  // namespace dlo::cli
