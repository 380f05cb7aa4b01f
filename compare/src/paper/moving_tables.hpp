#pragma once

#include <optional>
#include <string>
#include <vector>

#include "paper/moving_reference.hpp"

namespace dlo::compare {

/// A row of Tables 2 to 4 as printed.
struct PrintedMovingRow {
  std::string table;         ///< "2", "3" or "4"
  std::string label;         ///< as the paper names the row
  long steps = 0;            ///< of all kinds
  long damped_steps = 0;     ///< c_s != 1; of Tables 3 and 4 the text says that it was none
  long limited_steps = 0;    ///< d_m > l_s
  double average_force = 0;  ///< [N]
};

/// An experiment as run, beside its printed row.
struct MovingRow {
  MovingExperiment experiment;              ///< what was run
  std::optional<PrintedMovingRow> printed;  ///< none of variants without a row
  MovingRun run;                            ///< what came out
  std::optional<MovingError> error;  ///< against the moving energy model; none: not looked at
};

/// How near runs come to the printed rows.
struct MovingDistance {
  /// exp of the RMS of ln(computed / printed) of the average forces: 1 is equal, 2 is off by two.
  /// Infinite if a run diverged or was given up.
  double force_factor = 0;
  /// Counters (steps beyond the nominal ones, c_s != 1, d_m > l_s) within 10 % of the print, where
  /// a printed 0 has to be a 0.
  int counters_near = 0;
  int counters = 0;  ///< how many of them are printed
};

/// Counted over the rows that are printed.
[[nodiscard]] MovingDistance moving_distance(const std::vector<MovingRow>& rows);

/// Rows for choices that differ in one thing from the defaults.
struct MovingScanEntry {
  std::string varied;           ///< "none" for the defaults
  MovingChoices choices;        ///< that these rows were run with
  std::vector<MovingRow> rows;  ///< one per experiment
  MovingDistance distance;      ///< of these rows from the print
};

/// Tables 2 to 4, and how they depend on what the paper leaves open.
struct MovingReport {
  MovingChoices choices;              ///< of `rows`
  std::vector<MovingRow> rows;        ///< one per experiment
  MovingDistance distance;            ///< of `rows` from the print
  double reference_energy_error = 0;  ///< largest of the moving energy model, of its largest energy
  std::vector<MovingScanEntry> scan;  ///< rows of Tables 2 and 4
  std::vector<MovingScanEntry> table_3_scan;  ///< rows of Table 3 against the distance
  std::vector<std::string> findings;  ///< what can be reproduced, what cannot, what was filled in
};

/// Every experiment of Section III, not yet run: the printed rows, and for each movement the
/// variants that have no row of their own.
[[nodiscard]] std::vector<MovingRow> moving_rows();

/// Runs them with the default choices, and the printed ones with each choice varied.
[[nodiscard]] MovingReport moving_report();

}  // namespace dlo::compare
