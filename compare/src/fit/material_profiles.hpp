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

/// Sum of squared distances between shapes and rods, as a function of the logarithms of E and, if
/// both are identifiable, the density.
class MaterialProfiles {
 public:
  /// All references must outlive this.
  /// @throws InputError if fewer numbers are measured than fitted
  MaterialProfiles(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                   const MaterialFitOptions& options);

  [[nodiscard]] const std::vector<Scene>& scenes() const { return scenes_; }
  [[nodiscard]] const std::vector<MeasuredShape>& shapes() const { return shapes_; }
  [[nodiscard]] const MaterialFitOptions& options() const { return options_; }
  [[nodiscard]] MeasuredShapes& measured() { return measured_; }
  /// Whether E has an effect on the shapes.
  [[nodiscard]] bool is_forced() const { return forced_; }
  /// Whether the density is fitted besides E.
  [[nodiscard]] bool has_density() const { return both_; }
  [[nodiscard]] int unknowns() const { return both_ ? 2 : 1; }
  /// Returns the degrees of freedom of the residuals.
  [[nodiscard]] int freedom() const { return measured_.numbers() - unknowns(); }
  [[nodiscard]] double points() const { return static_cast<double>(measured_.points()); }

  /// Profile of the sum of squares over E, each with the best density, and the best material.
  struct Search {
    LogProfile over_modulus;
    MaterialPoint best;
  };
  /// Searches all E, and other equilibria at the best one.
  /// @throws ConvergenceError if the energy model finds no shape at any E
  [[nodiscard]] Search search();

  /// Returns the profile over the density, each with the best E.
  [[nodiscard]] LogProfile over_density();

  /// Returns the sum of squares [m^2].
  [[nodiscard]] double squares(const MaterialPoint& material) { return misfit_(material); }
  /// Returns the sum of squares with the best density [m^2].
  [[nodiscard]] double least_squares(double log_modulus) { return density_at(log_modulus).value; }

  /// Returns the equilibria at a material.
  [[nodiscard]] FittedRods::Rods rods(const MaterialPoint& material) {
    return misfit_.rods(material);
  }
  /// Returns residuals at a material, with their derivatives by the frames, by log E and, if both
  /// are fitted, by the logarithm of the density; empty if a shape is missing close to the
  /// material.
  [[nodiscard]] std::vector<ResidualSeries> residuals(const MaterialPoint& material);

  /// Checks that rods that may fit are verified. @param highest  largest sum of squares that may
  /// fit [m^2]
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
  double low_, high_;  // range of log E
};

}  // namespace dlo::compare
