#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/alignment.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"
#include "least_squares/error_correlation.hpp"
#include "shape/aligner.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {

/// Whether points lie in a plane up to rounding, so that their third coordinate was not measured.
[[nodiscard]] bool lies_in_a_plane(const Eigen::Matrix3Xd& points);

/// Meaning of the third coordinate of points that lie in a plane.
enum class FlatShapes {
  unmeasured,  ///< it is unknown: the shape is a photograph
  /// It is unknown, and the rod of a planar scene without obstacles is confined to the scene's
  /// plane.
  confined,
  measured,  ///< it was measured as zero
};

/// Options of the alignment of shapes, and limits of the solves of their rods.
struct MeasuredOptions {
  PoseFreedom pose = PoseFreedom::known;  ///< unknown coordinates of the shapes' frames
  ArcLengths arc_lengths = ArcLengths::automatic;
  PointWeights weights = PointWeights::equal;
  SolveOptions solve;  ///< limits; the time limit times the number of shapes is that of the fit
  FlatShapes flat = FlatShapes::unmeasured;
};

/// Column of a fitted number in the design, after the frames', and the derivative by the number of
/// the rod's points at the measured arc lengths [m per unit of the number], 3 x M.
using Movement = std::pair<Eigen::Index, Eigen::Matrix3Xd>;

/// The time limit of a fit is reached. A fit without a part that time left out would claim more
/// than is known, so such an error passes where a fit without an equilibrium is left out.
class TimeLimitError : public ConvergenceError {
  using ConvergenceError::ConvergenceError;
};

/// Measured shapes and the rods of their scenes: computes the residuals of every fit, and the
/// energy model's solutions for them, within one time limit.
class MeasuredShapes {
 public:
  /// @param timer  started when the time limit begins
  /// @throws InputError in the cases of align() and upward_direction()
  MeasuredShapes(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                 const MeasuredOptions& options, const Timer& timer);

  [[nodiscard]] std::size_t size() const { return shapes_.size(); }
  /// Whether only two coordinates of a shape are measured.
  [[nodiscard]] bool is_flat(std::size_t shape) const { return shapes_[shape].flat; }
  /// Returns the number of points of all shapes.
  [[nodiscard]] Eigen::Index points() const;
  /// Returns the number of measured coordinates of all shapes, minus the unknowns of their frames.
  [[nodiscard]] int numbers() const;
  /// Returns the number of unknown coordinates of the shapes' frames.
  [[nodiscard]] int frame_numbers() const;
  /// Returns the number of columns of a design before those of the fitted numbers: the coordinates
  /// of each shape's frame.
  [[nodiscard]] Eigen::Index frame_columns() const { return frame_columns_; }

  /// Solves a modified scene of a shape by the scene's reference_model(). The result's status
  /// states whether it converged.
  /// @param start  an equilibrium to start from; null: search
  /// @throws TimeLimitError
  /// @throws InputError if the model does not support the scene
  [[nodiscard]] energy_model::Equilibrium solve(std::size_t shape, const Scene& scene,
                                                const energy_model::Equilibrium* start);
  /// Returns the equilibrium that a local search from the shape's own points finds
  /// (energy_model::energy_near), whatever its status; not_run if the rod stretches or
  /// fewer than two points have different arc lengths.
  /// @param like  an equilibrium with which the shape is aligned if its frame is unknown
  /// @throws in the cases of solve()
  [[nodiscard]] energy_model::Equilibrium solve_near(std::size_t shape, const Scene& scene,
                                                     const energy_model::Equilibrium& like);
  /// Returns how far a rod that was confined leaves its plane without the confinement [m]; 0 if it
  /// does not, or if no such shape is found.
  [[nodiscard]] double out_of_plane_displacement(std::size_t shape, const Scene& scene,
                                                 const energy_model::Equilibrium& rod);

  /// Returns a rod as a curve with which shapes are aligned.
  [[nodiscard]] Curve curve(std::size_t shape, const energy_model::Equilibrium& rod) const {
    return {rod.sample, shapes_[shape].length};
  }
  [[nodiscard]] Alignment alignment(std::size_t shape, const energy_model::Equilibrium& rod) const {
    return shapes_[shape].aligner.align(curve(shape, rod));
  }
  /// Returns the sum of a shape's squared distances from a rod [m^2].
  [[nodiscard]] double sum_of_squares(std::size_t shape,
                                      const energy_model::Equilibrium& rod) const;

  /// Returns the residuals of an aligned shape, points minus rod times root_weights(). The design
  /// has the derivatives of the points by the coordinates of its own frame, and of the rod by the
  /// fitted numbers; other columns are zero. There is one series per coordinate with given arc
  /// lengths, else one per direction across the rod; none out of the plane if is_flat().
  /// @param movements  by the fitted numbers, in columns after the frames'
  /// @param numbers  number of fitted numbers
  [[nodiscard]] std::vector<ResidualSeries> residuals(std::size_t shape, const Curve& curve,
                                                      const Alignment& alignment,
                                                      const std::vector<Movement>& movements,
                                                      Eigen::Index numbers) const;

  /// Returns the number of calls of solve() that the energy model ended at its max_evaluations.
  [[nodiscard]] long limited_solves() const { return limited_solves_; }
  /// Returns the number of equilibria solved so far.
  [[nodiscard]] long solves() const { return solves_; }
  /// Returns the number of evaluations of the energy in these solves.
  [[nodiscard]] long evaluations() const { return evaluations_; }

 private:
  [[nodiscard]] bool is_confined(std::size_t shape, const Scene& scene) const;
  /// Returns the time limit of the next solve [s]. @throws TimeLimitError if no time is left
  [[nodiscard]] double time_left() const;
  [[noreturn]] void throw_time_limit() const;
  /// Adds a solve to the counts of evaluations. @throws TimeLimitError if time ended it
  energy_model::Equilibrium counted(energy_model::Equilibrium rod);
  [[nodiscard]] energy_model::Equilibrium solve_stretched(const Scene& scene,
                                                          const energy_model::Equilibrium* start);
  energy_model::Equilibrium solve(const energy_model::Problem& problem, const std::string& file,
                                  const energy_model::Equilibrium* start);

  /// Returns the roots of the points' weights, whose mean is 1.
  [[nodiscard]] Eigen::VectorXd root_weights(const std::vector<double>& s,
                                             const Eigen::Matrix3Xd& points) const;

  struct ShapeData {
    MeasuredShape file;
    Aligner aligner;
    double length;         // length of its rod [m]
    bool flat;             // only two coordinates are measured
    Eigen::Vector3d up;    // as in AlignOptions
    Eigen::Index columns;  // index of the first column of its frame
  };

  MeasuredOptions options_;
  std::vector<ShapeData> shapes_;
  Eigen::Index frame_columns_ = 0;
  long solves_ = 0;
  long evaluations_ = 0;
  long limited_solves_ = 0;
  Timer timer_;
};

}  // namespace dlo::compare
