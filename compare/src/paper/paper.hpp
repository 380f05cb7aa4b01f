#pragma once

#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/progress.hpp"
#include "paper/modulus_history.hpp"
#include "paper/printed_tables.hpp"

namespace dlo::compare {

/// One orientation of Figs. 12 and 13, with one choice of the points' weight.
struct PaperCase {
  Comparison rest;                               ///< at rest, c_c as the paper used it
  std::vector<ModulusAtTime> creep;              ///< on the way to rest, by time
  PaperWeight weight = PaperWeight::of_the_rod;  ///< of every point

  /// Simulated time at which E*/E passes the paper's 1/3, see time_at_ratio [s].
  [[nodiscard]] double time_at_one_third() const { return time_at_ratio(creep, 1. / 3); }
};

/// E*/E at rest for other loads, points, laws, rules and bookkeeping.
struct ModulusVariant {
  std::string what;             ///< what is varied, and to what
  ForceModelSettings settings;  ///< of the force model
  double load_factor = 1;       ///< on gravity
  double gamma = 0;             ///< w l^3 / (EI) [-]
  EffectiveModulus modulus;     ///< at rest
  double rms_over_length = 0;   ///< against the energy model at E
};

/// What dlo paper prints of shapes and tables.
struct PaperReport {
  std::vector<TableRow> tables;          ///< Tables 1 and 5
  std::vector<PaperCase> cases;          ///< Figs. 12 and 13
  std::vector<ModulusVariant> variants;  ///< away from the paper's own choices
  std::vector<std::string> assumptions;  ///< what the paper leaves open and how it was filled in
  double c_c = 0;                        ///< used for the cases [N]
  double c_F = 0;                        ///< used on the way to rest [m/N]
  double steps_per_second = 0;           ///< of simulated time [1/s]
};

/// The paper's comparison on its own rod. @param progress  called with what is being done
/// @throws ConvergenceError
[[nodiscard]] PaperReport paper_report(const Stages& progress = {});

}  // namespace dlo::compare
