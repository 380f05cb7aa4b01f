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

/// Sum of squared distances between measured shapes and the energy model's, for any modulus and
/// density.
///
/// A rod with one gripper is solved anew at each material. With several grippers each equilibrium
/// is followed from that of the nearest material solved so far (EnergyOptions::start), since a
/// search costs a hundred times as much. A search is made at the first material, where following
/// fails, and where search_at() requests it, at most `most_searches` times per scene.
class ShapeMisfit {
 public:
  ShapeMisfit(const std::vector<Scene>& scenes, MeasuredShapes& measured);

  /// Returns the sum of squared distances [m^2], computed once for each material; infinite if the
  /// energy model finds no shape.
  /// @throws ConvergenceError if the time limit is exceeded
  double operator()(const MaterialPoint& material);

  /// Searches for equilibria at a material instead of following one: with several grippers as at
  /// the first material, and always from a shape's own points (energy_model::energy_near). Returns
  /// true if an equilibrium differs and is nearer to the shape's points. All results at other
  /// materials are then discarded, and a rod with one gripper is followed from that equilibrium
  /// from then on.
  bool search_at(const MaterialPoint& material);

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
  /// Returns the equilibrium that is nearer to the points than `now` by more than rounding: the
  /// lowest one or the one near the points; null if neither is.
  [[nodiscard]] std::shared_ptr<const Solved> nearer(std::size_t i, const MaterialPoint& material,
                                                     const std::shared_ptr<const Solved>& now);
  [[nodiscard]] const Solved* nearest(std::size_t i, const MaterialPoint& material) const;

  const std::vector<Scene>& scenes_;
  MeasuredShapes& measured_;
  std::vector<int> searches_;
  std::vector<bool> follows_;  // for each scene: whether it is followed from the equilibrium at the
                               // nearest material
  std::map<MaterialPoint, double> values_;
  std::deque<std::shared_ptr<const Solved>> kept_;
  std::vector<std::size_t> first_like_;  // for each scene: index of the first scene equal to it
  std::deque<std::shared_ptr<const Solved>> shared_;       // of scenes that are not followed
  std::vector<std::pair<Unverified, double>> unverified_;  // with their sums of squares [m^2]
};

}  // namespace dlo::compare
