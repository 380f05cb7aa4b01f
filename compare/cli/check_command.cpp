#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "comparison_text.hpp"
#include "dlo/compare/display.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/quantity.hpp"
#include "dlo/compare/shape_check.hpp"
#include "json.hpp"
#include "output.hpp"
#include "scene_options.hpp"
#include "shape_options.hpp"
#include "share.hpp"
#include "terminal.hpp"

namespace dlo::cli {
namespace {

struct CheckOptions {
  std::string scene;
  std::string shape;
  std::string tolerance;
  std::string measure = "rms";
  std::optional<double> min_seen;
  bool no_modulus = false;
  ShapeOptions shapes;
  SceneOptions overrides;
  OutputOptions output;
};

/// What was allowed, and whether the shape keeps to it.
struct Verdict {
  compare::ShapeTolerance tolerance;
  compare::ShapeJudgement judgement;

  [[nodiscard]] const char* text() const { return judgement.pass ? "pass" : "fail"; }
};

/// "1%" or 0.01 of the rod's length, or a length with a unit.
double tolerance_m(const std::string& text, double length) {
  const bool percent = text.ends_with('%');
  const std::string number = percent ? text.substr(0, text.size() - 1) : text;
  double value = 0;
  try {
    value = compare::parse_quantity(number, compare::Dimension::number) / (percent ? 100 : 1);
    if (value > 0 && value < 1) return value * length;
  } catch (const compare::InputError&) {
    try {
      value = percent ? 0 : compare::parse_quantity(text, compare::Dimension::length);
    } catch (const compare::InputError&) {
      throw compare::InputError(fmt::format(
          "--tolerance = {}: neither a share of the length nor a length (allowed: such as 1%, 0.01 "
          "or \"2 mm\")",
          text));
    }
    if (value > 0) return value;
  }
  throw compare::InputError(fmt::format(
      "--tolerance = {}: out of range (allowed: above 0, a share of the length below 1, a length "
      "with its unit)",
      text));
}

std::string text(const compare::ShapeCheck& c, const compare::Scene& scene,
                 const std::optional<Verdict>& verdict, const CheckOptions& options) {
  std::string out;
  const compare::Alignment& a = c.alignment;
  const std::vector<double>& s = c.reference.arc_length;
  append(out, "{}   Gamma = {:.4g}\n", compare::display(c.scene), c.gamma);
  append(out, "  shape           {}: {} points, {}\n", compare::display(c.file), s.size(),
         range_text(a, scene.length));
  if (!c.direction_is_clear) append(out, "                  (the other direction fits as well)\n");
  constexpr const char* rules[] = {"", "the file's own", "chord lengths of the whole rod",
                                   "nearest points, so differences along the rod do not show"};
  append(out, "  arc lengths     {}\n", rules[static_cast<std::size_t>(a.arc_lengths)]);
  append(out,
         "  seen            s = {:.4g} to {:.4g} m, {:.4g} % of l; polyline {:.4g} m; largest gap "
         "{:.4g} m at s = {:.4g} m\n",
         s.front(), s.back(), c.seen_share * 100, c.polyline_length_m, c.largest_gap_m,
         c.largest_gap_at_m);
  const std::string hint =
      c.hint.empty() ? options.shapes.unit_hint(c.polyline_length_m, scene.length) : c.hint;
  if (!hint.empty()) append(out, "                  ({})\n", hint);
  if (options.shapes.pose() == compare::PoseFreedom::known) {
    append(out, "  frame           the scene's\n");
  } else {
    append(out, "  frame           found ({}): {}\n", compare::to_string(options.shapes.pose()),
           pose_text(a.pose));
    if (!c.turn_is_clear) {
      append(out,
             "                  (the turn about the rod's own line is not told by these points)\n");
    }
  }
  const compare::Deviation& d = c.deviation;
  append(out, "  deviation       RMS {:.4g} mm = {:.4g} % of l", d.rms_m * 1e3,
         d.rms_over_length * 100);
  if (std::isfinite(d.rms_over_movement)) {
    append(out, " = {:.4g} % of the movement", d.rms_over_movement * 100);
  }
  const Eigen::Vector3d at = c.worst_position.array() + 0.0;  // turns -0 into 0
  append(out,
         "\n                  largest {:.4g} mm at s = {:.4f} m (point {} of the file, at "
         "[{:.4g}, {:.4g}, {:.4g}] m)\n",
         d.max_m * 1e3, d.max_at_m, c.worst_point, at.x(), at.y(), at.z());
  if (std::isfinite(d.tip_m)) append(out, "                  tip {:.4g} mm\n", d.tip_m * 1e3);
  if (c.whole_rms_m > d.rms_m * (1 + 1e-6)) {
    append(out,
           "                  as the whole rod RMS {:.4g} mm, largest {:.4g} mm: what is missing "
           "counts with its distance from the outermost point\n",
           c.whole_rms_m * 1e3, c.whole_max_m * 1e3);
  }
  if (std::isfinite(d.angle_rms_rad)) {
    append(out, "                  tangent RMS {:.4g} deg, curvature RMS {:.4g} 1/m\n",
           d.angle_rms_rad * 57.29577951308232, d.curvature_rms_per_m);
  }
  if (std::isfinite(c.movement_m)) {
    append(out, "  movement        the rod is {:.4g} mm = {:.4g} % of l away from straight (RMS)\n",
           c.movement_m * 1e3, c.movement_m / scene.length * 100);
  }
  add_modulus(out, c.effective_modulus, NAN, c.modulus);
  add_state(out, c.state, scene.length, "the shape");
  if (verdict) {
    append(out, "  verdict         {}: {}\n",
           verdict_word(verdict->text(), verdict->judgement.pass, options.output.file),
           verdict->judgement.reason);
  }
  return out;
}

Json json(const compare::ShapeCheck& c, const std::optional<Verdict>& verdict,
          const CheckOptions& options) {
  const std::vector<double>& s = c.reference.arc_length;
  Json result = {{"schema", "dlo/check/1"},
                 {"scene", c.scene},
                 {"shape", c.file},
                 {"gamma", c.gamma},
                 {"points", s.size()}};
  result.update(to_json(c.alignment));
  result["direction_is_clear"] = c.direction_is_clear;
  result["turn_is_clear"] = c.turn_is_clear;
  result["seen"] = {{"from_m", s.front()},
                    {"to_m", s.back()},
                    {"share", c.seen_share},
                    {"polyline_length_m", c.polyline_length_m},
                    {"largest_gap_m", c.largest_gap_m},
                    {"largest_gap_at_m", c.largest_gap_at_m},
                    {"excess_m", c.excess_m}};
  result["hint"] = c.hint.empty() ? Json() : Json(c.hint);
  result["deviation"] = deviation_json(c.deviation);
  result["deviation"]["whole_rms_m"] = c.whole_rms_m;
  result["deviation"]["whole_max_m"] = c.whole_max_m;
  result["deviation"]["worst_point"] = c.worst_point;
  result["deviation"]["worst_position_m"] = to_json(c.worst_position);
  result["movement_m"] = c.movement_m;
  result.update(modulus_json(c.effective_modulus));
  result["effective_modulus_Pa"] = c.modulus;
  if (verdict) {
    result["tolerance"] = {{"measure", options.measure},
                           {"allowed_m", verdict->tolerance.allowed_m},
                           {"least_seen_share", verdict->tolerance.least_seen_share},
                           {"part", verdict->tolerance.part}};
    result["judged_m"] = verdict->judgement.judged_m;
    result["verdict"] = verdict->text();
    result["reason"] = verdict->judgement.reason;
  }
  result["state"] = to_json(c.state);
  result["arc_length_m"] = s;
  result["points_m"] = points_json(c.alignment.shape.points);
  result["reference_points_m"] = points_json(c.reference.points);
  return result;
}

std::string csv(const compare::ShapeCheck& c, const std::optional<Verdict>& verdict) {
  const compare::Deviation& d = c.deviation;
  std::string out =
      "scene,shape,gamma,points,reversed,arc_lengths,from_m,to_m,rms_m,rms_over_length,"
      "rms_over_movement,max_m,max_at_m,worst_point,tip_m,movement_m,effective_modulus_ratio,"
      "rms_at_effective_modulus_m,optimum,tolerance_m,verdict,seen_share,reason,whole_rms_m,"
      "whole_max_m\n";
  const std::vector<double>& s = c.reference.arc_length;
  const bool has_modulus = c.effective_modulus.optimum != compare::Optimum::none;
  const std::string fields[] = {csv_field(c.scene),
                                csv_field(c.file),
                                csv_number(c.gamma),
                                std::to_string(s.size()),
                                c.alignment.reversed ? "true" : "false",
                                compare::to_string(c.alignment.arc_lengths),
                                csv_number(s.front()),
                                csv_number(s.back()),
                                csv_number(d.rms_m),
                                csv_number(d.rms_over_length),
                                csv_number(d.rms_over_movement),
                                csv_number(d.max_m),
                                csv_number(d.max_at_m),
                                std::to_string(c.worst_point),
                                csv_number(d.tip_m),
                                csv_number(c.movement_m),
                                csv_number(c.effective_modulus.ratio),
                                csv_number(c.effective_modulus.rms_m),
                                has_modulus ? compare::to_string(c.effective_modulus.optimum) : "",
                                verdict ? csv_number(verdict->tolerance.allowed_m) : "",
                                verdict ? verdict->text() : "",
                                csv_number(c.seen_share),
                                verdict ? csv_field(verdict->judgement.reason) : "",
                                csv_number(c.whole_rms_m),
                                csv_number(c.whole_max_m)};
  append(out, "{}\n", fmt::join(fields, ","));
  return out;
}

void run(const CheckOptions& options) {
  const compare::Scene scene = options.overrides.load(options.scene);
  const compare::MeasuredShape shape = options.shapes.load(options.shape);
  std::optional<Verdict> verdict;
  if (!options.tolerance.empty()) {
    verdict.emplace();
    verdict->tolerance = {.allowed_m = tolerance_m(options.tolerance, scene.length),
                          .largest = options.measure == "max",
                          .part = options.min_seen.has_value()};
    if (options.min_seen) verdict->tolerance.least_seen_share = *options.min_seen;
  }
  const compare::ShapeCheck check = compare::check_shape(
      scene, shape,
      {.pose = options.shapes.pose(),
       .arc_lengths = options.shapes.arc_lengths(),
       .modulus = options.no_modulus ? compare::ModulusSearch::no : compare::ModulusSearch::yes,
       .solve = options.overrides.solve()});
  if (verdict) verdict->judgement = compare::judge(check, verdict->tolerance);
  std::string content;
  switch (options.output.kind()) {
    case Format::json:
      content = json_text(json(check, verdict, options));
      break;
    case Format::csv:
      content = csv(check, verdict);
      break;
    case Format::text:
      content = text(check, scene, verdict, options);
      break;
  }
  write_output(options.output, content);
  if (verdict && !verdict->judgement.pass) throw CLI::RuntimeError(1);
}

}  // namespace

void add_check(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "check", "how far a shape of your own simulator or camera is from the energy model");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("SCENE", options->scene, "scene file (TOML)")->required();
  command->add_option("--shape", options->shape, "CSV, JSON or legacy VTK polyline")
      ->type_name("FILE")
      ->required();
  command->add_option(
      "--tolerance", options->tolerance,
      "largest deviation allowed, 1% or 0.01 of the length or \"2 mm\"; exit status 1 "
      "beyond it");
  command->add_option("--measure", options->measure, "what is held against it: rms or max")
      ->check(CLI::IsMember({"rms", "max"}))
      ->capture_default_str();
  command
      ->add_option(
          "--min-seen", options->min_seen,
          "the file is a part of the rod: what it does not have is not judged, but less "
          "than this share such as 10% never passes. Without it the file is the whole rod, "
          "what is missing counts, and less than half never passes")
      ->transform(share_of_length());
  command->add_flag("--no-modulus", options->no_modulus, "leave E*/E out");
  options->shapes.add_to(*command, ChordLengths::offered);
  options->overrides.add_solvers_to(*command);
  add_output_options(*command, options->output);
  command->footer(
      "Example, with dlo in place of your simulator:\n"
      "  dlo solve data/scenes/cable.toml --model force --points 32 --format csv -o mine.csv\n"
      "  dlo check data/scenes/cable.toml --shape mine.csv --tolerance 1%");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
