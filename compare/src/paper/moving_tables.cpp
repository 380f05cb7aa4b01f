#include "paper/moving_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include "paper/printed_tables.hpp"

namespace dlo::compare {
namespace {

/// Returns the experiment of a row from its table and label.
MovingExperiment experiment_of(const std::string& table, const std::string& label) {
  const auto says = [&](const char* word) { return label.find(word) != std::string::npos; };
  MovingExperiment experiment;
  if (table == "3") experiment.movement = Movement::accelerated;
  if (table == "4") experiment.movement = Movement::uniform;
  experiment.horizontal = says("hor");
  if (says("dynamic")) experiment.variant = MovingVariant::dynamic;
  if (says("no rel. limit")) experiment.variant = MovingVariant::dynamic_absolute;
  return experiment;
}

std::vector<MovingRow> read_printed_rows() {
  std::vector<MovingRow> rows;
  for (const std::string table : {"2", "4", "3"}) {
    for (const toml::node& node : *printed_tables()["table_" + table].as_array()) {
      const toml::table& entry = *node.as_table();
      const auto count = [&](const char* key) { return entry[key].value<long>().value(); };
      const std::string label = entry[table == "2" ? "model" : "mode"].value<std::string>().value();
      rows.push_back({.experiment = experiment_of(table, label),
                      .printed = PrintedMovingRow{
                          .table = table,
                          .label = label,
                          .steps = count("steps"),
                          .damped_steps = count("c_s_not_1"),
                          .limited_steps = count("d_m_above_l_s"),
                          .average_force = entry["average_force"].value<double>().value()}});
    }
  }
  return rows;
}

bool is_near_printed(long computed, long printed) {
  return 10 * std::abs(computed - printed) <= printed;
}

/// Runs experiments and stores the results. Each combination of an experiment and the choices that
/// affect it is run only once.
class Runs {
 public:
  void fill(std::vector<MovingRow>& rows, const MovingAssumptions& choices) {
    for (MovingRow& row : rows) row.run = run(row.experiment, choices);
  }

 private:
  struct CachedRun {
    MovingExperiment experiment;
    MovingAssumptions choices;
    MovingRun run;
  };

  MovingRun run(const MovingExperiment& experiment, MovingAssumptions choices) {
    const MovingAssumptions unused;
    const force_model::StepPolicy policy = moving_step_options(experiment.variant, choices).policy;
    if (experiment.movement != Movement::rotation) choices.angle = unused.angle;
    if (experiment.movement == Movement::rotation) choices.distance = unused.distance;
    if (!policy.momentum) choices.c_h = unused.c_h;
    if (!policy.damping) choices.c_s_change = unused.c_s_change;
    for (const CachedRun& done : cached_runs_) {
      if (done.experiment == experiment && done.choices == choices) return done.run;
    }
    cached_runs_.push_back({experiment, choices, run_moving_experiment(experiment, choices)});
    return cached_runs_.back().run;
  }

  std::vector<CachedRun> cached_runs_;
};

struct Variation {
  std::string name;
  std::function<void(MovingAssumptions&)> change;
};

Variation make_variation(const char* name, double MovingAssumptions::*member, double value,
                         double unit = 1) {
  return {fmt::format(fmt::runtime(name), value),
          [=](MovingAssumptions& choices) { choices.*member = value * unit; }};
}

/// Variations of the choices for Tables 2 and 4. Among the forces of the grip, 0.07848 N is the one
/// from which the printed c_c and c_b follow, and 0.4905 N is Formula 14's m g at 1 % of a segment.
std::vector<Variation> variations() {
  constexpr double degree = std::numbers::pi / 180;
  return {{"nothing", [](MovingAssumptions&) {}},
          make_variation("c_F, l_s in units of {} m", &MovingAssumptions::length_unit, 1),
          make_variation("c_F, l_s in units of {} m", &MovingAssumptions::length_unit, 0.1),
          make_variation("c_F, l_s in units of {} m", &MovingAssumptions::length_unit, 0.001),
          make_variation("grip {} N at 5 % of a segment", &MovingAssumptions::grip_force, 0.07848),
          make_variation("grip {} N at 5 % of a segment", &MovingAssumptions::grip_force, 0.4905),
          make_variation("angle {} deg", &MovingAssumptions::angle, 45, degree),
          make_variation("angle {} deg", &MovingAssumptions::angle, 90, degree),
          make_variation("angle {} deg", &MovingAssumptions::angle, 135, degree),
          make_variation("angle {} deg", &MovingAssumptions::angle, 180, degree),
          make_variation("distance {} m", &MovingAssumptions::distance, 0.05),
          make_variation("distance {} m", &MovingAssumptions::distance, 0.2),
          make_variation("c_h = {}", &MovingAssumptions::c_h, 0.8),
          make_variation("c_h = {}", &MovingAssumptions::c_h, 0.9),
          make_variation("c_h = {}", &MovingAssumptions::c_h, 0.98),
          make_variation("c_s grows by {}", &MovingAssumptions::c_s_change, 1),
          make_variation("starts {} segment behind", &MovingAssumptions::start_offset, 1)};
}

std::vector<Variation> table_3_variations() {
  return {{"nothing", [](MovingAssumptions&) {}},
          make_variation("distance {} m", &MovingAssumptions::distance, 0.05),
          make_variation("distance {} m", &MovingAssumptions::distance, 0.15),
          make_variation("distance {} m", &MovingAssumptions::distance, 0.25),
          make_variation("distance {} m", &MovingAssumptions::distance, 1)};
}

std::vector<MovingScanEntry> scan(const std::vector<MovingRow>& rows,
                                  const std::vector<Variation>& over, Runs& runs) {
  std::vector<MovingScanEntry> result;
  for (const Variation& variation : over) {
    MovingScanEntry entry{.varied = variation.name, .rows = rows};
    variation.change(entry.choices);
    runs.fill(entry.rows, entry.choices);
    entry.distance = moving_agreement(entry.rows);
    result.push_back(std::move(entry));
  }
  return result;
}

/// Computes the distance of every row from the dynamic energy model, whose motion does not depend
/// on the variant.
void add_errors(MovingReport& report) {
  std::vector<std::pair<MovingExperiment, MovingReference>> references;
  for (MovingRow& row : report.rows) {
    MovingExperiment moved = row.experiment;
    moved.variant = {};
    auto known = std::find_if(references.begin(), references.end(),
                              [&](const auto& pair) { return pair.first == moved; });
    if (known == references.end()) {
      references.emplace_back(moved, moving_reference(moved, report.choices));
      known = references.end() - 1;
      report.reference_energy_error =
          std::max(report.reference_energy_error, known->second.energy_error);
    }
    row.error = moving_error(row.experiment, report.choices, known->second);
  }
}

std::string describe_point_parameters(const MovingAssumptions& choices) {
  const double c_F = table_1().c_F * choices.length_unit;
  const PointParameters dynamic = point_parameters(c_F, choices.c_h);
  const PointParameters without = point_parameters(c_F, 0);
  const auto points = static_cast<double>(table_1().points);
  const double real = table_1().mass / points;
  return fmt::format(
      "Formula 19 is Stoermer-Verlet for points of mass m* = dt^2/c_F with damping rate (1 - "
      "c_h)/dt, to rounding where no step is scaled down. With c_F in centimetres per newton m* = "
      "{:.3f} g, where the rod has {:.3f} g a point (10 points; {:.3f} g with 11): {:.2f} times as "
      "much. In metres it would be {:.4f} g, in millimetres {:.1f} g. So the dynamic's inertia is "
      "nearly physical in centimetres alone; its damping is not: {:.0f}/s with c_h = {:g}, and "
      "without dynamics {:.0f}/s, a drag of {:.3f} and {:.2f} N s/m a point.",
      1e3 * dynamic.mass, 1e3 * real, 1e3 * table_1().mass / (points + 1), dynamic.mass / real,
      1e3 * dynamic.mass * choices.length_unit, 1e3 * dynamic.mass * choices.length_unit / 1e-3,
      dynamic.damping_rate, choices.c_h, without.damping_rate, dynamic.drag, without.drag);
}

std::vector<std::string> findings(const MovingReport& report) {
  const force_model::StepOptions metres =
      moving_step_options(MovingVariant::basic, {.length_unit = 1});
  const double segment = table_1().segment();
  const double grip_stiffness = table_1().grip_force / (0.05 * segment);
  const double weight = table_1().point_weight;
  return {
      describe_point_parameters(report.choices),
      fmt::format(
          "Errors are against the moving energy model: the rod's length, 10 g, {:.4f} N of weight, "
          "EI = {:.3g} N m^2 (the moment of Table 1's c_b at its 2.5 degrees), clamped in the "
          "middle of the held segment, {:g} of critical damping by its material, from rest; every "
          "50 ms from 5.025 s on, none where the gripper starts or stops at once. Its energy "
          "balance closes to {:.0e} of the largest energy. Stiffness "
          "and damping are filled in; the law `paper` has no stiffness of its own.",
          moving_weight(), reference_bending_stiffness(), reference_damping_ratio,
          report.reference_energy_error),
      fmt::format("Read in metres, c_F = {:g} m/N is unstable: the gripper's spring alone, {:.0f} "
                  "N/m, makes c_e c_F = {:.1f} where an explicit step has to stay below 2, and l_s "
                  "= {:g} m would be {:.2f} of a segment where the text asks for 1/10 to 1/100. "
                  "Read in centimetres both are in range, and the average forces of Tables 2 and 4 "
                  "are met to a factor of {:.2f}.",
                  metres.c_F, grip_stiffness, metres.c_F * grip_stiffness, metres.l_s,
                  metres.l_s / segment, report.scan.front().distance.force_factor),
      fmt::format("The printed force is nearest to the sum of the magnitudes of the gripper's two "
                  "springs: a horizontal rod at rest has 40 w = {:.3f} N of it but a net force of "
                  "10 w = {:.4f} N (w the weight of a point), and Table 4 prints 0.38 N.",
                  40 * weight, 10 * weight),
      "Four numbers (unit, angle, distance, c_h) were chosen by hand to meet the seven average "
      "forces of Tables 2 and 4. That is agreement, not proof.",
      "The counters are not reproduced. A rod that starts within the gripper never reaches l_s. "
      "The paper prints 963 and 1081 for a hanging rod, whether it is rotated or displaced (Tables "
      "2 and 4, and 963 in Table 3). They were therefore counted before the movement began, while "
      "the rod was pulled into its gripper. A rod that starts one segment behind also has the same "
      "counts in both movements, but smaller ones. If it starts farther behind, points pass each "
      "other (Fig. 4) and the counts depend on rounding.",
      "Table 3 is not reproduced by any distance: each of its rows requires another one. It "
      "repeats the counts 112878 and 963 of Table 4 for the hanging rod, but prints another force.",
      "\"static\" in Table 2 has counts of c_s and d_m, which Formula 7 lacks: it is another "
      "stepper. As the text states, `basic` and `relative` are equal until a limit is reached.",
      "Filled in: the gripper holds the third and the fourth point, its targets move at 1 kHz; the "
      "rod starts straight along the gripper; segments of l/(N-1); Formula 4 with the signs that "
      "balance; the sideways movements begin at 5 s as the rotation does.",
  };
}

}  // namespace

MovingAgreement moving_agreement(const std::vector<MovingRow>& rows) {
  MovingAgreement distance;
  double sum_of_squares = 0;
  int printed_rows = 0;
  for (const MovingRow& row : rows) {
    if (!row.printed) continue;
    const PrintedMovingRow& printed = *row.printed;
    const MovingRun& run = row.run;
    ++printed_rows;
    const double logarithm = run.status == MovingStatus::finished
                                 ? std::log(run.average_force / printed.average_force)
                                 : std::numeric_limits<double>::infinity();
    sum_of_squares += logarithm * logarithm;
    distance.counters += 3;
    distance.matching_counters +=
        static_cast<int>(is_near_printed(run.steps - nominal_moving_steps,
                                         printed.steps - nominal_moving_steps)) +
        static_cast<int>(is_near_printed(run.damped_steps, printed.damped_steps)) +
        static_cast<int>(is_near_printed(run.limited_steps, printed.limited_steps));
  }
  distance.force_factor = std::exp(std::sqrt(sum_of_squares / printed_rows));
  return distance;
}

std::vector<MovingRow> moving_rows() {
  std::vector<MovingRow> rows = read_printed_rows();
  for (const MovingVariant variant :
       {MovingVariant::basic, MovingVariant::limited, MovingVariant::automatic}) {
    rows.push_back({.experiment = {Movement::rotation, false, variant}});
    for (const Movement movement : {Movement::uniform, Movement::accelerated}) {
      for (const bool horizontal : {true, false}) {
        rows.push_back({.experiment = {movement, horizontal, variant}});
      }
    }
  }
  return rows;
}

MovingReport moving_report() {
  MovingReport report;
  Runs runs;
  report.rows = moving_rows();
  runs.fill(report.rows, report.choices);
  report.distance = moving_agreement(report.rows);
  std::vector<MovingRow> tables_2_and_4;
  std::vector<MovingRow> table_3;
  for (const MovingRow& row : read_printed_rows()) {
    (row.printed->table == "3" ? table_3 : tables_2_and_4).push_back(row);
  }
  report.scan = scan(tables_2_and_4, variations(), runs);
  report.table_3_scan = scan(table_3, table_3_variations(), runs);
  add_errors(report);
  report.findings = findings(report);
  return report;
}

}  // namespace dlo::compare
