#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/shape_options.hpp"

namespace dlo::cli {

/// Segments of a chain that --segments gives.
struct ChainLayout {
  int segments = 0;                     // number of equal segments
  std::vector<double> segment_lengths;  // lengths of unequal segments [m]
};

/// Arguments and options of `dlo calibrate`.
struct CalibrateOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> shapes;
  bool density = false;
  bool torsional_stiffness = false;
  std::string noise;
  int natural_curvature_terms = 0;
  std::vector<std::string> motions;
  std::string segments;  // a number, or the name of a file
  std::string clamp_angles;
  std::string clamp_positions;
  std::string clamp_rolls;
  bool same_clamps = false;
  std::string clamp_scatter;
  std::string camera_tilt;
  bool predict = false;
  std::string chosen;  // empty: the default of calibrate()
  std::vector<std::string> holdouts;
  std::optional<double> target;
  ShapeOptions shape_options;
  SceneOptions overrides;
  OutputOptions output;
  PlotOptions plot;

  void add_to(CLI::App& command);

  /// Check and convert the options. @throws compare::InputError naming the option
  [[nodiscard]] ChainLayout chain_layout() const;
  [[nodiscard]] compare::MaterialFitOptions material_options() const;

 private:
  void add_numbers_of_wire(CLI::App& command, CLI::Option* shape);
  void add_output(CLI::App& command);
};

}  // namespace dlo::cli
