#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "least_squares/error_correlation.hpp"
#include "least_squares/fitted_rods.hpp"
#include "least_squares/log_profile.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// Sum of squared distances between measured shapes and the energy model's, for any modulus and
/// density.
///
/// A rod with one gripper is solved anew at each material. With several grippers each equilibrium
/// is followed from that of the nearest material solved so far (EnergyOptions::start), since a
/// search costs a hundred times as much. A search is made at the first material, where following
/// fails, and where find_nearer_equilibria() requests it, at most `most_searches` times per scene.
class ShapeMisfit {
 public:
  ShapeMisfit(const std::vector<Scene>& scenes, MeasuredShapes& measured);

  /// Returns the sum of squared distances [m^2], computed once for each material; infinite if the
  /// energy model finds no shape.
  /// @throws ConvergenceError if the time limit is exceeded
  double operator()(const MaterialPoint& material);

  /// Searches for equilibria at a material instead of following one: with several grippers as at
  /// the first material, and, where an equilibrium is known, also from the shape's own points
  /// (energy_model::energy_near). Returns true if an equilibrium differs and is nearer to the
  /// shape's points. All results at other materials are then discarded, and a rod with one gripper
  /// is followed from that equilibrium from then on.
  bool find_nearer_equilibria(const MaterialPoint& material);

  /// Returns the equilibria at a material; empty where there is none.
  [[nodiscard]] FittedRods::Rods rods(const MaterialPoint& material);

  /// A material whose shapes may have a sum of squares up to `level` [m^2], although its
  /// equilibrium on rigid obstacles was not verified.
  struct Unverified {
    MaterialPoint material;
    std::size_t scene = 0;
    double penetration = 0;  // [m]
    std::string message;     // message of the solver
  };
  [[nodiscard]] const Unverified* unverified_below(double level) const;

 private:
  struct Solved {
    MaterialPoint material;
    std::size_t scene;
    energy_model::Equilibrium equilibrium;
    double penetration = 0;  // depth of a shape that is not verified [m]
  };

  [[nodiscard]] std::shared_ptr<const Solved> solved(std::size_t i, const MaterialPoint& material);
  [[nodiscard]] std::shared_ptr<Solved> solve(std::size_t i, const MaterialPoint& material,
                                              const energy_model::Equilibrium* start);
  /// Returns the equilibrium whose sum of squares is smaller than that of `now`, if any, by over
  /// 1 %: the lowest one or the one near the points; null if neither is.
  [[nodiscard]] std::shared_ptr<const Solved> nearer_equilibrium(
      std::size_t i, const MaterialPoint& material, const std::shared_ptr<const Solved>& now);
  [[nodiscard]] std::shared_ptr<const Solved> nearest(std::size_t i,
                                                      const MaterialPoint& material) const;

  const std::vector<Scene>& scenes_;
  MeasuredShapes& measured_;
  std::vector<int> searches_;
  std::vector<bool> is_followed_;  // for each scene: whether it is followed from the equilibrium at
                                   // the nearest material
  std::map<MaterialPoint, double> values_;
  std::deque<std::shared_ptr<const Solved>> kept_;
  std::vector<std::size_t> first_equal_scene_;  // index of the first scene equal to each scene
  std::deque<std::shared_ptr<const Solved>>
      shared_solutions_;  // solutions of scenes that are not followed
  // Unverified shapes with their sums of squares [m^2].
  std::vector<std::pair<Unverified, double>> unverified_;
};

/// Sum of squared distances between shapes and rods, as a function of the logarithms of E and, if
/// both are identifiable, the density.
class MaterialProfiles {
 public:
  /// All references must outlive this.
  /// @throws InputError if fewer numbers are measured than fitted or, without given noise, as many
  MaterialProfiles(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                   const MaterialFitOptions& options);

  [[nodiscard]] const std::vector<Scene>& scenes() const { return scenes_; }
  [[nodiscard]] const std::vector<MeasuredShape>& shapes() const { return shapes_; }
  [[nodiscard]] const MaterialFitOptions& options() const { return options_; }
  [[nodiscard]] MeasuredShapes& measured() { return measured_; }
  /// Whether E has an effect on the shapes.
  [[nodiscard]] bool has_external_force() const { return has_external_force_; }
  /// Whether the density is fitted besides E.
  [[nodiscard]] bool has_density() const { return fits_density_; }
  [[nodiscard]] int unknowns() const { return fits_density_ ? 2 : 1; }
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
  [[nodiscard]] double sum_of_squares(const MaterialPoint& material) { return misfit_(material); }
  /// Returns the sum of squares with the best density [m^2].
  [[nodiscard]] double least_squares(double log_modulus) { return density_at(log_modulus).value; }

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
  bool has_external_force_;
  bool fits_density_;
  double low_, high_;  // range of log E
};

/// Errors of the points about the rods of the best material, and the sums of squares up to which
/// other materials fit. The index of a number is 0 for E and 1 for the density.
class MaterialErrors {
 public:
  /// @param least  sum of squares at the best material [m^2]
  MaterialErrors(MaterialProfiles& material, const MaterialPoint& best, double least);

  /// Writes noise, correlation and scatter of the errors into the fit.
  void write_to(MaterialFit& fit) const;

  /// Returns the sum of squares at the ends of a number's interval [m^2].
  [[nodiscard]] double level(std::size_t number) const;

  /// Returns the sum of squares up to which another local minimum is an equally good explanation
  /// [m^2]. Its frames differ too, so it is rejected only outside the joint region of all fitted
  /// numbers: if the probability of so large a sum of squares is below 1e-3 (F distribution;
  /// chi-squared distribution for given noise).
  [[nodiscard]] double rival_minimum_level(std::size_t number) const;

 private:
  void set_correlation_effects(const ErrorCovariance& covariance,
                               const std::vector<ResidualSeries>& series, Eigen::Index frames);
  [[nodiscard]] double quantile(std::size_t number) const;
  [[nodiscard]] double excess(std::size_t number) const;

  const MaterialFitOptions& options_;
  double least_;
  double freedom_;  // degrees of freedom, of independent errors
  double fitted_;   // number of fitted numbers, frames included
  std::vector<CorrelationEffect> effects_;
  double variance_ = 0;  // variance of one coordinate, for independent errors [m^2]
  double noise_m_ = 0;
  bool tested_ = false;  // whether correlation of errors was tested
  std::optional<CorrelatedErrors> correlation_;
  std::optional<ScatterBetweenShapes> scatter_;
};

}  // namespace dlo::compare
