#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"
#include "least_squares/error_correlation.hpp"
#include "shape/aligner.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {

/// Points that lie in a plane to rounding: their third coordinate was not measured.
[[nodiscard]] bool lies_in_a_plane(const Eigen::Matrix3Xd& points);

/// What points that lie in a plane say of the third coordinate.
enum class FlatShapes {
  unmeasured,  ///< nothing: it is a photograph
  confined,    ///< nothing either, and a rod of a scene with a plane is confined to that
  measured,    ///< that it is nought
};

/// How shapes lie, and how far the rods that they are held against may be looked for.
struct MeasuredOptions {
  PoseFreedom pose = PoseFreedom::known;  ///< what is unknown of their frames
  ArcLengths arc_lengths = ArcLengths::automatic;
  PointWeights weights = PointWeights::equal;
  SolveOptions solve;  ///< limits; the time is that of each shape
  FlatShapes flat = FlatShapes::unmeasured;
};

/// How a fitted number moves the rod's points where the measured ones are [m per its unit], 3 x M,
/// and its column.
using Movement = std::pair<Eigen::Index, Eigen::Matrix3Xd>;

/// Measured shapes against rods, each shape against those of its own scene: the residuals of every
/// fit, and the energy model's solutions that it needs, within one time limit.
class MeasuredShapes {
 public:
  /// @param timer  from when on the time limit is
  /// @throws InputError as align()
  MeasuredShapes(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                 const MeasuredOptions& options, const Timer& timer);

  [[nodiscard]] std::size_t size() const { return shapes_.size(); }
  /// A shape of which only two coordinates are measured.
  [[nodiscard]] bool is_flat(std::size_t shape) const { return shapes_[shape].flat; }
  /// Points of all shapes.
  [[nodiscard]] Eigen::Index points() const;
  /// Numbers measured of all shapes, less those that place them.
  [[nodiscard]] int numbers() const;
  /// Numbers that place the shapes.
  [[nodiscard]] int frame_numbers() const;
  /// Columns of a design before those of the fitted numbers: each shape's frame.
  [[nodiscard]] Eigen::Index frame_columns() const { return frame_columns_; }

  /// The solution of a shape's scene as it was changed, by the scene's reference_model().
  /// @param start  an equilibrium to follow; null: search
  /// @throws ConvergenceError if the time limit is over
  /// @throws InputError if the scene is none that the model has
  [[nodiscard]] energy_model::Equilibrium solve(std::size_t shape, const Scene& scene,
                                                const energy_model::Equilibrium* start);
  /// The equilibrium that a local search from the shape's own points leads to
  /// (energy_model::energy_near), whatever its status; not_run if the rod stretches.
  /// @param like  an equilibrium on which the shape is laid where its frame is not known
  /// @throws as solve()
  [[nodiscard]] energy_model::Equilibrium solve_near(std::size_t shape, const Scene& scene,
                                                     const energy_model::Equilibrium& like);
  /// How far a rod that was confined leaves its plane where nothing confines it [m].
  [[nodiscard]] double way_out_of_plane(std::size_t shape, const Scene& scene,
                                        const energy_model::Equilibrium& rod);

  /// A rod as a curve that shapes are laid on.
  [[nodiscard]] Curve curve(std::size_t shape, const energy_model::Equilibrium& rod) const {
    return {rod.sample, shapes_[shape].length};
  }
  /// How a shape lies on a rod.
  [[nodiscard]] Alignment alignment(std::size_t shape, const energy_model::Equilibrium& rod) const {
    return shapes_[shape].aligner.align(curve(shape, rod));
  }
  /// Sum of a shape's squared distances from a rod, weighted [m^2].
  [[nodiscard]] double squares(std::size_t shape, const energy_model::Equilibrium& rod) const;

  /// Residuals of a shape as it lies on a rod, points less rod, with the columns of its own frame's
  /// coordinates and of the fitted numbers; the others are zero. With given arc lengths a series
  /// for each coordinate, else for each of the directions across the rod; none out of the plane of
  /// a shape that lies in one.
  /// @param movements  by the fitted numbers, in columns after the frames';  @param numbers  fitted
  [[nodiscard]] std::vector<ResidualSeries> residuals(std::size_t shape, const Curve& curve,
                                                      const Alignment& alignment,
                                                      const std::vector<Movement>& movements,
                                                      Eigen::Index numbers) const;

  /// Number of solves that ended at SolveOptions::max_evaluations.
  [[nodiscard]] long limited_solves() const { return limited_solves_; }
  /// Equilibria solved so far.
  [[nodiscard]] long solves() const { return solves_; }
  /// Of the energy model's objective, for these.
  [[nodiscard]] long evaluations() const { return evaluations_; }

 private:
  [[nodiscard]] bool is_confined(std::size_t shape, const Scene& scene) const;
  /// Time that the next equilibrium may take [s]. @throws ConvergenceError if there is none left
  [[nodiscard]] double time_left() const;
  [[nodiscard]] energy_model::Equilibrium solve_stretched(const Scene& scene,
                                                          const energy_model::Equilibrium* start);
  energy_model::Equilibrium solve(const energy_model::Problem& problem, const std::string& file,
                                  const energy_model::Equilibrium* start);

  /// Roots of the points' weights, whose mean is 1.
  [[nodiscard]] Eigen::VectorXd root_weights(const std::vector<double>& s,
                                             const Eigen::Matrix3Xd& points) const;

  struct OneShape {
    MeasuredShape file;
    Aligner aligner;
    double length;         // of its rod [m]
    bool flat;             // only two coordinates are measured
    Eigen::Vector3d up;    // as in AlignOptions
    Eigen::Index columns;  // before its frame's first
  };

  MeasuredOptions options_;
  std::vector<OneShape> shapes_;
  Eigen::Index frame_columns_ = 0;
  long solves_ = 0;
  long evaluations_ = 0;
  long limited_solves_ = 0;
  Timer timer_;
};

}  // namespace dlo::compare
