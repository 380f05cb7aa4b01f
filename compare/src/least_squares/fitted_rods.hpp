#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// A number that is fitted to measured shapes.
struct Unknown {
  double stride = 0;                 ///< of differences, in its unit; 0: it is in no shape
  std::optional<std::size_t> shape;  ///< whose own it is; none: it is of all
  /// Standard deviation about zero without the shapes; infinite: nothing is known.
  double known_before = std::numeric_limits<double>::infinity();
  double longest_step = std::numeric_limits<double>::infinity();  ///< beyond it nothing is linear
};

/// The energy model's rods of measured shapes' scenes, for any values of the numbers that are
/// fitted. Each equilibrium is followed from the last one.
class FittedRods {
 public:
  /// A shape's scene at some values.
  using SceneAt = std::function<Scene(std::size_t shape, const Eigen::VectorXd& values)>;

  FittedRods(MeasuredShapes& measured, SceneAt scene, std::vector<Unknown> unknowns)
      : measured_(measured),
        scene_(std::move(scene)),
        unknowns_(std::move(unknowns)),
        last_(measured.size()) {}

  [[nodiscard]] const std::vector<Unknown>& unknowns() const { return unknowns_; }
  [[nodiscard]] const MeasuredShapes& measured() const { return measured_; }

  /// Whether the derivatives by the numbers are wanted, or only those by the frames.
  enum class Columns { frames, all };
  /// Residuals of all shapes, none if one has no equilibrium there.
  /// @throws ConvergenceError if the time limit is over
  [[nodiscard]] std::optional<std::vector<ResidualSeries>> residuals(const Eigen::VectorXd& values,
                                                                     Columns columns);

  /// An equilibrium of each shape to go on from; none: search.
  using Rods = std::vector<std::optional<energy_model::Equilibrium>>;
  void go_on_from(Rods rods) { last_ = std::move(rods); }
  /// From searches.
  void search_next() { last_ = Rods(measured_.size()); }
  /// Those of the last values.
  [[nodiscard]] const Rods& rods() const { return last_; }

  /// Rods at some values, and their sums of squared distances from the shapes [m^2].
  struct State {
    Rods rods;
    std::vector<double> squares;  // infinite without a rod
  };
  /// Goes there, as residuals() does.
  [[nodiscard]] State state(const Eigen::VectorXd& values);

  /// How the shapes lie at values where all have an equilibrium.
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

/// Rods at equal arc lengths, up to the first that there is not.
[[nodiscard]] std::vector<Shape> sampled(const FittedRods::Rods& rods,
                                         const std::vector<Scene>& scenes, int samples);

}  // namespace dlo::compare
