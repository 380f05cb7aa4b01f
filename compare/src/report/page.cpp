#include "report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "base/quote.hpp"
#include "picture/comparison_figure.hpp"
#include "polygon/step_constants.hpp"
#include "report/html.hpp"
#include "report/page_data.hpp"
#include "report/page_writer.hpp"
#include "report/provenance.hpp"
#include "report/tables.hpp"
#include "report/verdict.hpp"

namespace dlo::compare {
namespace {

/// The first screen: what has to be seen by somebody who sees nothing else.
void add_first_screen(const Report& report, PageWriter& page) {
  const std::optional<ReportSummary> summary = report_summary(report);
  if (!summary) return;
  const Comparison& worst = report.scenes[summary->worst].comparisons.front();
  const EffectiveModulus& modulus = worst.effective_modulus;
  const bool told = is_identified(modulus.optimum);
  const bool pass = summary->right == summary->count && report.failures.empty();
  std::string out = html_badge(pass, fmt::format("{} of {} right", summary->right, summary->count));
  out += fmt::format(
      "<p>The scenes' own force model is right within {} of the length (RMS) in {} of {}. Worst is "
      "{}.</p>\n<p><strong>The main reason there is {}.</strong></p>\n",
      page_percent(report.options.tolerance), summary->right, summary->count,
      escape_markup(worst.scene), escape_markup(summary->main_reason));
  out += to_html(std::vector<HtmlNumber>{
      {"RMS distance", page_percent(worst.deviation.rms_over_length), "of the length"},
      {"largest", page_number(worst.deviation.max_m * 1e3) + "\u00a0mm",
       fmt::format("at s = {:.4g} m", worst.deviation.max_at_m)},
      {"E*/E", told ? page_number(modulus.ratio) : "\u2013", told ? "at rest" : "not identified"}});
  page.screen(out, fmt::format("shapes_{}", summary->worst + 1));
}

void add_verdict(const Report& report, PageWriter& page) {
  page.section("verdict", "Verdict", PageSection::open);
  const std::vector<std::string> verdict = report_verdict(report);
  const auto failures = static_cast<std::ptrdiff_t>(report.failures.size());
  if (report.options.quick) {
    page.paragraph(
        "A quick report (--quick): a short benchmark, a coarse map, no hard cases. Without it the "
        "times and limits are surer.");
  }
  page.list(std::vector(verdict.begin(), verdict.begin() + failures), report.failures.size());
  add_first_screen(report, page);
  page.folded_list("All findings", std::vector(verdict.begin() + failures, verdict.end()));
  page.paragraph(fmt::format(
      "Every number names its law (how a joint's moment grows with its angle: paper, cubic; hooke, "
      "linear) and its bookkeeping (where the grip and the weights are: paper, first order; "
      "consistent, second order). N is the number of points, l the rod's length. Distances are at "
      "equal arc length, RMS over the rod. That {} of the length count as right is this report's "
      "choice (--tolerance).",
      page_percent(report.options.tolerance)));
  if (report.paper) {
    page.paragraph(
        "The scenes are the paper's three (Figs. 12 and 13) and two that tell more, since the "
        "paper's rod is nearly straight (Gamma = 0.18): the same rod 1.9 m long, and one metre of "
        "it "
        "pulled sideways, which no plane holds.");
  }
  page.table(scene_table(report));
}

/// Comparisons that no options of dlo compare give, one after the other.
std::string rows_without_command(const Report& report) {
  std::string names;
  for (const SceneReport& scene : report.scenes) {
    for (const Comparison& comparison : scene.comparisons) {
      if (!compare_command(scene.file, comparison).empty()) continue;
      if (!names.empty()) names += "; ";
      names += comparison.scene + ", " + setting_name(comparison.settings);
    }
  }
  return names;
}

void add_shapes(const Report& report, PageWriter& page) {
  page.section("shapes", report.paper ? "Shapes and curvature: the paper's Figs. 12 and 13"
                                      : "Shapes and curvature");
  page.paragraph(
      "Both models at rest, drawn with one scale for both axes. Besides the force model as the "
      "scene "
      "says it, unless it says just this: the same with law hooke and bookkeeping consistent.");
  page.figures("shapes");
  page.section("deviation", "How far apart");
  page.figures("deviation");
  page.table(deviation_table(report));
  std::vector<std::string> commands;
  for (const SceneReport& scene : report.scenes) {
    for (const Comparison& comparison : scene.comparisons) {
      std::string command = compare_command(scene.file, comparison);
      if (!command.empty()) commands.push_back(std::move(command));
    }
  }
  page.commands("Each row again", commands);
  const std::string no_command = rows_without_command(report);
  if (!no_command.empty()) {
    page.paragraph(
        "Rows without a command, since their scenes name numbers that only their own "
        "law or bookkeeping has: " +
        no_command + ".");
  }
  page.table(state_table(report));
  page.section("budget", "Why: the error budget");
  page.paragraph(
      "Each part is found by switching one thing. Parts are vectors along the rod: their "
      "millimetres do not add up, their shares of the total (projections, with sign) do, to 100 %. "
      "Interaction is what law and bookkeeping do together beyond the sum of both.");
  page.figures("budget");
  page.table(budget_table(report));
}

void add_motion(const Report& report, PageWriter& page) {
  if (report.motions.empty()) return;
  page.section("motion", "What moves");
  page.paragraph(fmt::format(
      "The rod is followed through the motion at rest in every frame: that is what the contacts, "
      "snaps and forces are of. The force model makes its steps on the way. Where the scene allows "
      "it the rod with its inertia is beside them, with a material damping of {} s. Errors are RMS "
      "over the length, lag included.",
      page_number(report_damping)));
  page.figures("motion");
  page.table(motion_table(report));
  std::vector<std::string> commands;
  for (const MotionReport& motion : report.motions) commands.push_back(track_command(motion));
  page.commands("Each of them again", commands);
}

/// Empty but for its headings: the script fills it from the page's data.
void add_interactive(PageWriter& page) {
  page.section("interactive", "Turn, look along, compare", PageSection::by_script);
  page.filled_by_script("viewer", "The scenes' shapes");
  page.filled_by_script("grid", "A grid of shapes");
}

void add_modulus(const Report& report, PageWriter& page) {
  page.section("modulus", report.paper ? "E*/E, and the paper's 1/3" : "E*/E");
  page.paragraph(
      "E* is the modulus at which the energy model comes nearest to the force model's shape (RMS). "
      "A law that is not Hookean leaves a residual even there.");
  page.table(modulus_table(report));
  if (!report.options.history) return page.paragraph("E*/E against time was left out.");
  page.paragraph(fmt::format(
      "On the way from straight to rest E*/E changes. These are steps as the paper made them: "
      "stepper basic, no dynamics, {}, as in Table 1's proportion, and c_c = AE/1000, unless the "
      "scene names them. 4000 steps are a simulated second (Table 2). Rods with one clamp only.",
      table_1_step_formula));
  page.figures("modulus");
  page.table(history_table(report));
  page.command(report.paper ? "The paper's poses again:" : "Again:", history_command(report));
  if (report.paper) {
    page.command("The others:",
                 report_command(report, "scenes/long_rod.toml scenes/side_load.toml"));
  }
}

void add_speed(const Report& report, PageWriter& page) {
  page.section("speed", "Speed against error");
  if (!report.benchmark) return page.paragraph("The benchmark was left out, or not computed.");
  const BenchmarkReport& benchmark = *report.benchmark;
  page.paragraph(fmt::format(
      "From straight to the shape, on one thread while nothing else of this report ran, medians of "
      "{} runs. "
      "Tracking: a frame of 1 ms behind a gripper that moves at {} m/s and rotates by v/l.",
      benchmark.options.repeats, page_number(benchmark.options.gripper_speed)));
  page.figures("speed");
  page.table(answer_table(report));
  for (const SceneBenchmark& scene : benchmark.scenes) page.table(front_table(scene));
  if (!benchmark.skipped.empty()) {
    page.folded_list(fmt::format("{} runs were skipped", benchmark.skipped.size()),
                     benchmark.skipped);
  }
  page.command("Again, as long as nothing else runs:", benchmark_command(report));
}

void add_stability(const Report& report, PageWriter& page) {
  page.section("stability", "Where the steps stop being stable");
  if (report.map) {
    page.paragraph(
        "Steps without limit or damping, from rest, disturbed by 1e-6 of the length. The predicted "
        "limit 2 (1 + c_h) / (bound of the stiffest mode) answers the paper's Formula 15.");
    page.figures("stability");
    page.table(map_table(*report.map));
    page.command("Again:", map_command(report));
  } else {
    page.paragraph("The map was left out, or not computed.");
  }
  page.section("hard-cases", "Hard cases");
  if (report.hard_cases.empty()) return page.paragraph("They were left out, or not computed.");
  const StabilityOptions options = report.options.hard_cases.value_or(StabilityOptions{});
  page.paragraph(fmt::format(
      "The paper's four steppers ({}, l_s = {} L, c_h = {}; {} steps), verlet (as many), auto and "
      "implicit (at most {}). ✓: "
      "within {} of the length of an equilibrium that no step has a part in. "
      "Creeping: still on the way, though it may look at rest. At rest: {} steps.",
      table_1_step_formula, table_1_limit_share, dynamic_share, options.max_steps,
      options.max_steps_auto, page_percent(options.tolerance), options.steps_at_rest));
  page.table(hard_case_table(report.hard_cases));
  for (const std::string& name : options.excluded) {
    page.paragraph("Not run, for the time it takes: " + name + ".");
  }
  std::vector<std::string> notes;
  for (const StabilityResult& result : report.hard_cases) {
    const bool own_note = result.outcome != Outcome::wrong && result.outcome != Outcome::refused;
    if (result.note.empty() || !own_note) continue;
    notes.push_back(fmt::format("{}, {}: {}", result.name, to_string(result.stepper), result.note));
  }
  if (!notes.empty()) {
    page.heading("Notes");
    page.list(notes);
  }
  page.command("Again, with what was not run:",
               fmt::format("dlo stability --steps-at-rest {}", options.steps_at_rest));
}

void add_provenance(const Report& report, const std::vector<PageFigure>& figures,
                    const ReportMaker& maker, const std::string& drawn_by, PageWriter& page) {
  page.section("provenance", "Provenance");
  std::vector<std::pair<std::string, std::string>> facts = {{"dlo", maker.version},
                                                            {"command", maker.command}};
  for (const auto& fact : provenance()) facts.push_back(fact);
  facts.emplace_back("figures", drawn_by.empty() ? "none: no gnuplot was found" : drawn_by);
  facts.emplace_back("time to compute", page_number(report.seconds) + " s");
  page.facts(facts);
  page.table(parameter_table(report));
  if (report.paper) {
    page.paragraph(
        "The paper gives neither the gravity constant nor the gripper's position nor the start: "
        "9.81 m/s², the origin and straight along the gripper are filled in. Its formula 4 is "
        "taken "
        "with the signs that balance. dlo paper lists all that had to be assumed.");
  }
  const auto missing = std::count_if(figures.begin(), figures.end(), [](const PageFigure& figure) {
    return !figure.failure.empty();
  });
  page.paragraph(fmt::format(
      "{} of {} figures are on this page. In its folder are the scenes, and for each figure the "
      "numbers (CSV) and the script: gnuplot FIGURE.gp draws it anew. All commands are for a shell "
      "in that folder.",
      figures.size() - static_cast<std::size_t>(missing), figures.size()));
}

}  // namespace

std::string report_page(const Report& report, const std::vector<PageFigure>& figures,
                        const ReportMaker& maker, const std::string& drawn_by) {
  PageWriter page(figures);
  add_verdict(report, page);
  add_interactive(page);
  add_shapes(report, page);
  add_motion(report, page);
  add_modulus(report, page);
  add_speed(report, page);
  add_stability(report, page);
  add_provenance(report, figures, maker, drawn_by, page);
  return page.finished(report.paper ? "The paper's rod: how far a fast model is from physics"
                                    : "How far a fast rod model is from physics",
                       page_data(report));
}

}  // namespace dlo::compare
