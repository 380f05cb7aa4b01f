#pragma once

#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "paper/printed_tables.hpp"

namespace dlo::compare {

/// Steps per simulated second [1/s]: Table 2's 112000 nominal steps in 28 s.
inline constexpr double paper_steps_per_second = 4000;
/// Simulated time of the last sample of a history [s].
inline constexpr double last_history_time = 200;

/// E*/E of a shape that has not yet come to rest.
struct ModulusAtTime {
  double time_s = 0;           ///< simulated time, at paper_steps_per_second [s]
  long steps = 0;              ///< number of steps up to that time
  EffectiveModulus modulus;    ///< fitted modulus at that time
  double rms_over_length = 0;  ///< RMS distance from the energy model at E, divided by the length
  /// RMS distance from the force model's own rest shape, divided by the length.
  double rest_distance_over_length = 0;
};

/// One orientation of Figs. 12 and 13, with one choice of the weight of the points.
struct PaperCase {
  Comparison rest;                             ///< comparison at rest, with the paper's c_c
  std::vector<ModulusAtTime> creep;            ///< samples on the way to rest, at fixed times
  PaperWeight weight = PaperWeight::from_rod;  ///< weight of every point

  /// Returns the simulated time at which E*/E decreases below the paper's 1/3, interpolated between
  /// the samples by a power law; NaN if it does not do so between two samples [s].
  [[nodiscard]] double time_at_one_third() const;
};

/// E*/E at rest for another load, number of points, law, stiffness rule or convention.
struct ModulusVariant {
  std::string varied;           ///< the varied setting and its value
  ForceModelSettings settings;  ///< settings of the force model
  double load_factor = 1;       ///< factor on gravity
  double gamma = 0;             ///< w l^3 / (EI) [-]
  EffectiveModulus modulus;     ///< fitted modulus at rest
  double rms_over_length = 0;   ///< RMS distance from the energy model at E, divided by the length
};

/// Results of dlo paper on shapes and tables.
struct PaperReport {
  std::vector<TableRow> tables;          ///< Tables 1 and 5
  std::vector<PaperCase> cases;          ///< Figs. 12 and 13
  std::vector<ModulusVariant> variants;  ///< settings other than the paper's own
  /// Details that the paper does not state, each with the assumption that was made instead.
  std::vector<std::string> assumptions;
  double c_c = 0;               ///< c_c of the cases [N]
  double c_F = 0;               ///< c_F of the runs before rest [m/N]
  double steps_per_second = 0;  ///< steps per second of simulated time [1/s]
};

/// Compares both models on the paper's own rod. @param progress  called with the name of the
/// current stage
/// @throws ConvergenceError
[[nodiscard]] PaperReport paper_report(const Stages& progress = {});

}  // namespace dlo::compare
