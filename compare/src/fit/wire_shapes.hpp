#pragma once

#include <optional>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "fit/measured_shapes.hpp"
#include "fit/wire_numbers.hpp"

namespace dlo::compare {

/// Measured shapes against the energy model's, for any values of a wire's numbers. Each equilibrium
/// is followed from the last one.
class WireShapes {
 public:
  WireShapes(const std::vector<Scene>& scenes, MeasuredShapes& measured,
             const MaterialFitOptions& options, const std::vector<WireNumber>& numbers);

  /// Whether the derivatives by the numbers are wanted, or only those by the frames.
  enum class Columns { frames, all };
  /// Residuals of all shapes, none if one has no equilibrium there.
  /// @param values  of the numbers
  /// @throws ConvergenceError if the time limit is over
  [[nodiscard]] std::optional<std::vector<ResidualSeries>> residuals(const Eigen::VectorXd& values,
                                                                     Columns columns);

  /// An equilibrium of each shape to go on from; none: search.
  using Rods = std::vector<std::optional<energy_model::Equilibrium>>;
  void go_on_from(Rods rods);
  /// Those of the last values.
  [[nodiscard]] const Rods& rods() const { return last_; }

  /// Rods at some values, and their sums of squared distances from the shapes [m^2].
  struct State {
    Rods rods;
    std::vector<double> squares;  // infinite without a rod
  };
  /// Goes there, as residuals() does.
  [[nodiscard]] State state(const Eigen::VectorXd& values);

  /// A shape's scene at some values.
  [[nodiscard]] Scene scene(std::size_t shape, const Eigen::VectorXd& values) const;

  /// How the shapes lie at values where all have an equilibrium.
  [[nodiscard]] std::vector<Alignment> alignments(const Eigen::VectorXd& values);

 private:
  [[nodiscard]] std::optional<energy_model::Equilibrium> solve(std::size_t shape,
                                                               const Eigen::VectorXd& values);
  [[nodiscard]] std::optional<std::vector<Movement>> movements(std::size_t shape,
                                                               const Eigen::VectorXd& values,
                                                               const Eigen::Matrix3Xd& here,
                                                               const std::vector<double>& s);

  std::vector<Scene> scenes_;
  MeasuredShapes& measured_;
  const std::vector<WireNumber>& numbers_;
  Rods last_;
};

}  // namespace dlo::compare
