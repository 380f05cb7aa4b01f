#pragma once

#include <cmath>
#include <compare>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// Logarithms of the factors on the scenes' modulus and density.
struct MaterialPoint {
  double log_modulus = 0;
  double log_density = 0;
  auto operator<=>(const MaterialPoint&) const = default;
};

/// Returns the scene with its modulus and density scaled.
[[nodiscard]] inline Scene scene_with_material(Scene scene, const MaterialPoint& material) {
  scene.scale_modulus(std::exp(material.log_modulus));
  scene.scale_density(std::exp(material.log_density));
  return scene;
}

/// A number that is fitted to measured shapes.
struct Unknown {
  double difference_step =
      0;  ///< stride of differences, in the number's unit; 0: no shape depends on it
  std::optional<std::size_t> shape;  ///< index of the only shape that has it; empty: all have
  /// Prior standard deviation about zero; infinite: no prior.
  double prior_deviation = std::numeric_limits<double>::infinity();
  double longest_step = std::numeric_limits<double>::infinity();  ///< longest step for which the
                                                                  ///< fit is nearly linear
};

/// The energy model's rods for the scenes of measured shapes, at any values of the fitted numbers.
/// A solve starts from the shape's last equilibrium; without one, or if that fails, it is a search.
class FittedRods {
 public:
  /// Returns the scene of a shape at some values of the numbers.
  using SceneAt = std::function<Scene(std::size_t shape, const Eigen::VectorXd& values)>;

  FittedRods(MeasuredShapes& measured, SceneAt scene, std::vector<Unknown> unknowns)
      : measured_(measured),
        scene_(std::move(scene)),
        unknowns_(std::move(unknowns)),
        last_(measured.size()) {}

  [[nodiscard]] const std::vector<Unknown>& unknowns() const { return unknowns_; }
  [[nodiscard]] const MeasuredShapes& measured() const { return measured_; }

  /// Columns of the design to compute: derivatives by the frames only, or by the numbers too.
  enum class Columns { frames, all };
  /// Returns the residuals of all shapes, std::nullopt if a shape has no equilibrium there or, with
  /// Columns::all, at both steps of a number, to either side.
  /// @throws ConvergenceError if the time limit is exceeded
  [[nodiscard]] std::optional<std::vector<ResidualSeries>> residuals(const Eigen::VectorXd& values,
                                                                     Columns columns);

  /// An equilibrium for each shape from which the next solve starts; empty: search.
  using Rods = std::vector<std::optional<energy_model::Equilibrium>>;
  void set_initial_rods(Rods rods) { last_ = std::move(rods); }
  /// Makes the next solve of each shape a search.
  void clear_initial_rods() { last_ = Rods(measured_.size()); }
  /// Returns the rods at the last values.
  [[nodiscard]] const Rods& rods() const { return last_; }

  /// Rods at some values, and the sum of squared distances of each shape from its rod [m^2].
  struct State {
    Rods rods;
    std::vector<double> sum_of_squares;  // infinite without a rod
  };
  /// Solves all shapes at some values and keeps the rods as residuals() does.
  [[nodiscard]] State state(const Eigen::VectorXd& values);

  /// Returns the alignment of each shape at values at which all have an equilibrium.
  [[nodiscard]] std::vector<Alignment> alignments(const Eigen::VectorXd& values);

 private:
  [[nodiscard]] std::optional<energy_model::Equilibrium> solve(std::size_t shape,
                                                               const Eigen::VectorXd& values);
  [[nodiscard]] std::optional<std::vector<Movement>> movements(std::size_t shape,
                                                               const Eigen::VectorXd& values,
                                                               const Curve& here,
                                                               const std::vector<double>& s);

  MeasuredShapes& measured_;
  SceneAt scene_;
  std::vector<Unknown> unknowns_;
  Rods last_;
};

/// Returns rods sampled at equal arc lengths, up to the first one that does not exist.
[[nodiscard]] std::vector<Shape> sampled(const FittedRods::Rods& rods,
                                         const std::vector<Scene>& scenes, int samples);

}  // namespace dlo::compare
