#pragma once

#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "fit/shape_misfit.hpp"
#include "least_squares/error_correlation.hpp"
#include "least_squares/log_profile.hpp"
#include "least_squares/material_point.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// Shapes and the rods of any E and, where both can be told, any density: the sum of their squared
/// distances over the logarithms of these.
class MaterialProfiles {
 public:
  /// What is given outlives this.
  /// @throws InputError if there are fewer numbers measured than found
  MaterialProfiles(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                   const MaterialFitOptions& options);

  [[nodiscard]] const std::vector<Scene>& scenes() const { return scenes_; }
  [[nodiscard]] const std::vector<MeasuredShape>& shapes() const { return shapes_; }
  [[nodiscard]] const MaterialFitOptions& options() const { return options_; }
  [[nodiscard]] MeasuredShapes& measured() { return measured_; }
  /// Whether E has an effect.
  [[nodiscard]] bool is_forced() const { return forced_; }
  /// Whether the density is found beside E.
  [[nodiscard]] bool has_density() const { return both_; }
  [[nodiscard]] int unknowns() const { return both_ ? 2 : 1; }
  /// Degrees, of the residuals.
  [[nodiscard]] int freedom() const { return measured_.numbers() - unknowns(); }
  [[nodiscard]] double points() const { return static_cast<double>(measured_.points()); }

  /// The sum of squares over E, with the density at its own best.
  struct Search {
    LogProfile over_modulus;
    MaterialPoint best;
  };
  /// Over all E, and of what other states are found at its best.
  /// @throws ConvergenceError if the energy model has a shape at no modulus
  [[nodiscard]] Search search();

  /// The same over the density, with E at its own best.
  [[nodiscard]] LogProfile over_density();

  /// Sum of squares [m^2].
  [[nodiscard]] double squares(const MaterialPoint& material) { return misfit_(material); }
  /// With the density at its own best [m^2].
  [[nodiscard]] double least_squares(double log_modulus) { return density_at(log_modulus).value; }

  /// The equilibria at a material, and residuals with their derivatives by the frames, by log E
  /// and, if both are fitted, by the logarithm of the density; none if a shape is missing beside
  /// it.
  [[nodiscard]] FittedRods::Rods rods(const MaterialPoint& material) {
    return misfit_.rods(material);
  }
  [[nodiscard]] std::vector<ResidualSeries> residuals(const MaterialPoint& material);

  /// @param highest  sum of squares that may still fit [m^2]
  /// @throws ConvergenceError if a rod that may fit is not verified on its obstacles
  void refuse_unverified(double highest) const;

 private:
  [[nodiscard]] Minimum density_at(double log_modulus);
  [[nodiscard]] Search profile();

  const std::vector<Scene>& scenes_;
  const std::vector<MeasuredShape>& shapes_;
  const MaterialFitOptions& options_;
  MeasuredShapes measured_;
  ShapeMisfit misfit_;
  bool forced_;
  bool both_;
  double low_, high_;  // of log E
};

}  // namespace dlo::compare
