#pragma once

#include <optional>
#include <string>
#include <vector>

#include "paper/moving.hpp"

namespace dlo::compare {

/// Printed row of Tables 2 to 4.
struct PrintedMovingRow {
  std::string table;         ///< "2", "3" or "4"
  std::string label;         ///< as the paper names the row
  long steps = 0;            ///< steps of all kinds
  long damped_steps = 0;     ///< steps with c_s != 1; 0 in Tables 3 and 4, as the text states
  long limited_steps = 0;    ///< steps with d_m > l_s
  double average_force = 0;  ///< average force of the gripper [N]
};

/// Experiment with its result and its printed row.
struct MovingRow {
  MovingExperiment experiment;
  std::optional<PrintedMovingRow> printed;  ///< empty for variants without a printed row
  MovingRun run;
  /// Distance from the dynamic energy model; empty if not computed.
  std::optional<MovingError> error;
};

/// Agreement of runs with the printed rows.
struct MovingAgreement {
  /// exp of the RMS of ln(computed / printed) of the average forces: 1 means equal, 2 a typical
  /// factor of two. Infinite if a run diverged or was stopped; NaN without printed rows.
  double force_factor = 0;
  /// Number of counters (steps beyond the nominal ones, c_s != 1, d_m > l_s) within 10 % of the
  /// printed value; a printed 0 requires 0.
  int matching_counters = 0;
  int counters = 0;  ///< number of printed counters
};

/// Compares the rows that have a printed row.
[[nodiscard]] MovingAgreement moving_agreement(const std::vector<MovingRow>& rows);

/// Rows for choices that differ from the defaults in one parameter.
struct MovingScanEntry {
  std::string varied;           ///< the varied parameter, "nothing" for the defaults
  MovingAssumptions choices;    ///< parameters with which the rows were computed
  std::vector<MovingRow> rows;  ///< one per experiment
  MovingAgreement distance;     ///< agreement of the rows with the printed ones
};

/// Tables 2 to 4, and their dependence on parameters that the paper does not print.
struct MovingReport {
  MovingAssumptions choices;    ///< the choices of `rows`
  std::vector<MovingRow> rows;  ///< one per experiment
  MovingAgreement distance;     ///< agreement of `rows` with the printed rows
  /// Largest energy error of the dynamic energy model, divided by its largest energy.
  double reference_energy_error = 0;
  std::vector<MovingScanEntry> scan;          ///< rows of Tables 2 and 4
  std::vector<MovingScanEntry> table_3_scan;  ///< rows of Table 3 for several distances
  std::vector<std::string> findings;  ///< what can be reproduced, what cannot, and what was assumed
};

/// Returns every experiment of Section III, not yet run: the printed rows, and for each movement
/// the variants that have no printed row.
[[nodiscard]] std::vector<MovingRow> moving_rows();

/// Runs moving_rows() with the default choices, and the printed rows with each choice varied, in
/// Table 3 only the distance.
[[nodiscard]] MovingReport moving_report();

}  // namespace dlo::compare
