#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/scene.hpp"
#include "least_squares/fitted_rods.hpp"
#include "least_squares/material_point.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// Measured shapes against the energy model's, for any modulus and density.
///
/// A rod held once is solved anew at each material. Between several grippers each equilibrium is
/// followed from that of the nearest material solved so far (EnergyOptions::start), for a search
/// costs a hundred times as much; a search is made at the first material, where following fails,
/// and where search_at() asks for it, at most `most_searches` times per scene.
class ShapeMisfit {
 public:
  ShapeMisfit(const std::vector<Scene>& scenes, MeasuredShapes& measured);

  /// Sum of squared distances [m^2], computed once for each material; infinite where the energy
  /// model finds no shape.
  /// @throws ConvergenceError if the time limit is over
  double operator()(const MaterialPoint& material);

  /// Searches for equilibria at a material instead of following: between grippers as at the first
  /// material, and everywhere from a shape's own points (energy_model::energy_near). True if a
  /// shape is another one and lies nearer to its points; all that was known of other materials is
  /// then forgotten, and a rod that is held once is followed from that shape from then on.
  bool search_at(const MaterialPoint& material);

  /// The equilibria at a material where there is a shape.
  [[nodiscard]] FittedRods::Rods rods(const MaterialPoint& material);

  /// A material whose shapes may, for all that is known, come as near as `level` [m^2], though its
  /// equilibrium on rigid obstacles was not verified.
  struct Unverified {
    MaterialPoint material;
    std::size_t scene = 0;
    double penetration = 0;  // [m]
    std::string message;     // of the solver
  };
  [[nodiscard]] const Unverified* unverified_below(double level) const;

 private:
  struct Solved {
    MaterialPoint material;
    std::size_t scene;
    energy_model::Equilibrium equilibrium;
    double penetration = 0;  // [m], of a shape that is not verified
  };

  [[nodiscard]] std::shared_ptr<const Solved> solved(std::size_t i, const MaterialPoint& material);
  [[nodiscard]] std::shared_ptr<Solved> solve(std::size_t i, const MaterialPoint& material,
                                              const energy_model::Equilibrium* start);
  /// Of the lowest equilibrium and the one near the points, what lies nearer to these than `now`
  /// by more than rounding; null: neither.
  [[nodiscard]] std::shared_ptr<const Solved> nearer(std::size_t i, const MaterialPoint& material,
                                                     const std::shared_ptr<const Solved>& now);
  [[nodiscard]] const Solved* nearest(std::size_t i, const MaterialPoint& material) const;

  const std::vector<Scene>& scenes_;
  MeasuredShapes& measured_;
  std::vector<int> searches_;
  std::vector<bool> follows_;  // each scene: from the shape at the nearest material
  std::map<MaterialPoint, double> values_;
  std::deque<std::shared_ptr<const Solved>> kept_;
  std::vector<std::size_t> first_like_;               // of each scene: the first that equals it
  std::deque<std::shared_ptr<const Solved>> shared_;  // of scenes that are not followed
  std::vector<std::pair<Unverified, double>> unverified_;  // and their sums of squares [m^2]
};

}  // namespace dlo::compare
