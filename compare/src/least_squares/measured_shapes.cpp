#include "least_squares/measured_shapes.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <stdexcept>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "polygon/energy_problems.hpp"
#include "shape/curve.hpp"
#include "shape/shape_measure.hpp"

namespace dlo::compare {
namespace {

/// Distance from a plane, divided by the length, up to which a rod lies in the plane except for
/// rounding.
constexpr double in_plane = 1e-8;

/// Returns the number of measured coordinates of a shape.
int measured_coordinates(const Aligner& aligner, bool flat) {
  const int per_point = (aligner.arc_lengths() == ArcLengths::nearest ? 2 : 3) - (flat ? 1 : 0);
  return per_point * static_cast<int>(aligner.points());
}

constexpr int plane_samples = 201;

/// Whether energy_model::Problem::confined_to_plane applies to a scene; a scene whose clamps twist
/// the rod has no plane.
bool can_be_confined(const Scene& scene) { return scene.planar() && scene.obstacles.empty(); }

/// Returns the number of unknown coordinates of a shape's frame.
int numbers_of_frame(bool flat, PoseFreedom pose) {
  constexpr int frame[] = {0, 3, 4, 6};
  constexpr int flat_frame[] = {0, 2, 2, 3};
  return (flat ? flat_frame : frame)[static_cast<std::size_t>(pose)];
}

/// Returns the principal directions of points, the one of least extent first.
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> extents(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centred * centred.transpose());
}

/// Returns the directions in which a point's residual is observed, as columns.
std::vector<Eigen::Matrix3Xd> observed_directions(const Alignment& alignment, const Curve& curve,
                                                  bool flat) {
  const std::vector<double>& s = alignment.shape.arc_length;
  const bool across = alignment.arc_lengths == ArcLengths::nearest;
  const Eigen::Matrix3d principal = extents(alignment.shape.points).eigenvectors();
  const Eigen::Vector3d out_of_plane = principal.col(0);
  std::vector<Eigen::Matrix3Xd> result;
  Eigen::Vector3d normal = out_of_plane;
  for (const double at : s) {
    if (!across) {
      result.emplace_back(flat ? Eigen::Matrix3Xd(principal.rightCols<2>())
                               : Eigen::Matrix3Xd(Eigen::Matrix3d::Identity()));
      continue;
    }
    const Eigen::Vector3d tangent = curve.tangent(at).normalized();
    if (flat) {
      result.emplace_back(out_of_plane.cross(tangent).normalized());
      continue;
    }
    // Parallel transport along the rod makes the directions of neighbours correspond.
    normal -= normal.dot(tangent) * tangent;
    if (!(normal.norm() > 1e-3)) normal = tangent.unitOrthogonal();
    normal.normalize();
    Eigen::Matrix3Xd both(3, 2);
    both << normal, tangent.cross(normal);
    result.push_back(std::move(both));
  }
  return result;
}

/// Returns the derivatives of a point by the free coordinates of its motion.
Eigen::Matrix3Xd frame_derivatives(PoseFreedom pose, const Eigen::Vector3d& arm,
                                   const Eigen::Vector3d& up) {
  const Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  if (pose == PoseFreedom::known) return shift.leftCols(0);
  if (pose == PoseFreedom::translation) return shift;
  const Eigen::Index turns = pose == PoseFreedom::upright ? 1 : 3;
  Eigen::Matrix3Xd result(3, 3 + turns);
  result.leftCols<3>() = shift;
  for (Eigen::Index k = 0; k < turns; ++k) {
    const Eigen::Vector3d axis =
        pose == PoseFreedom::upright ? up : Eigen::Vector3d(Eigen::Vector3d::Unit(k));
    result.col(3 + k) = axis.cross(arm);
  }
  return result;
}

}  // namespace

bool lies_in_a_plane(const Eigen::Matrix3Xd& points) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen = extents(points);
  return eigen.eigenvalues()[0] < 1e-15 * eigen.eigenvalues()[2];
}

MeasuredShapes::MeasuredShapes(const std::vector<Scene>& scenes,
                               const std::vector<MeasuredShape>& shapes,
                               const MeasuredOptions& options, const Timer& timer)
    : options_(options), timer_(timer) {
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Eigen::Vector3d up = upward_direction(scenes[i], options_.pose);
    Aligner aligner(shapes[i], scenes[i].length,
                    {.pose = options_.pose,
                     .arc_lengths = options_.arc_lengths,
                     .weights = options_.weights,
                     .up = up});
    const Eigen::Index columns = aligner.free_coordinates();
    const bool flat = options_.flat != FlatShapes::measured && lies_in_a_plane(shapes[i].points);
    shapes_.push_back({shapes[i], std::move(aligner), scenes[i].length, flat, up, frame_columns_});
    frame_columns_ += columns;
  }
}

Eigen::Index MeasuredShapes::points() const {
  Eigen::Index sum = 0;
  for (const ShapeData& shape : shapes_) sum += shape.aligner.points();
  return sum;
}

int MeasuredShapes::numbers() const {
  int sum = 0;
  for (const ShapeData& shape : shapes_) sum += measured_coordinates(shape.aligner, shape.flat);
  return sum - frame_numbers();
}

int MeasuredShapes::frame_numbers() const {
  int sum = 0;
  for (const ShapeData& shape : shapes_) sum += numbers_of_frame(shape.flat, options_.pose);
  return sum;
}

energy_model::Equilibrium MeasuredShapes::solve(std::size_t shape, const Scene& scene,
                                                const energy_model::Equilibrium* start) {
  if (reference_model(scene) == Model::exact) return solve_stretched(scene, start);
  scene.require_potential("the energy model");
  energy_model::Problem problem = energy_problem(scene);
  problem.confined_to_plane = is_confined(shape, scene);
  return solve(problem, scene.file, start);
}

bool MeasuredShapes::is_confined(std::size_t shape, const Scene& scene) const {
  return options_.flat == FlatShapes::confined && shapes_[shape].flat && can_be_confined(scene);
}

double MeasuredShapes::out_of_plane_displacement(std::size_t shape, const Scene& scene,
                                                 const energy_model::Equilibrium& rod) {
  if (!is_confined(shape, scene)) return 0;
  energy_model::Equilibrium free = solve(energy_problem(scene), scene.file, &rod);
  // An unstable rod is a saddle in its plane, and steps from it converge back to it.
  if (!energy_model::succeeded(free.status)) {
    free = solve(energy_problem(scene), scene.file, nullptr);
  }
  if (!energy_model::succeeded(free.status)) return 0;
  const Eigen::Vector3d normal = *scene.plane_normal();
  const Eigen::Matrix3Xd points =
      free.sample(equal_arc_lengths(scene.length, plane_samples)).points;
  const Eigen::RowVectorXd out = normal.transpose() * (points.colwise() - points.col(0));
  const double distance = out.cwiseAbs().maxCoeff();
  return distance > in_plane * scene.length ? distance : 0;
}

double MeasuredShapes::time_left() const {
  const double remaining =
      options_.solve.time_limit * static_cast<double>(size()) - timer_.seconds();
  if (!(remaining > 0)) throw_time_limit();
  return remaining;
}

void MeasuredShapes::throw_time_limit() const {
  throw TimeLimitError(
      fmt::format("calibrate: not done within {:g} s{}, after {} equilibria (--time-limit)",
                  options_.solve.time_limit, size() > 1 ? " per scene" : "", solves_));
}

energy_model::Equilibrium MeasuredShapes::counted(energy_model::Equilibrium rod) {
  if (rod.status == energy_model::SolveStatus::time_limit) throw_time_limit();
  evaluations_ += rod.evaluations;
  if (rod.status == energy_model::SolveStatus::evaluation_limit) ++limited_solves_;
  return rod;
}

energy_model::Equilibrium MeasuredShapes::solve_near(std::size_t shape, const Scene& scene,
                                                     const energy_model::Equilibrium& like) {
  if (reference_model(scene) == Model::exact) return {};
  MeasuredShape placed = shapes_[shape].file;
  placed.points = alignment(shape, like).pose.applied(placed.points);
  const Shape aligned = aligned_by_grippers(placed, scene, shapes_[shape].aligner.arc_lengths());
  if (aligned.arc_length.size() < 2) return {};
  energy_model::Problem problem = energy_problem(scene);
  problem.confined_to_plane = is_confined(shape, scene);
  const double remaining = time_left();
  ++solves_;
  try {
    return counted(energy_model::energy_near(problem, aligned.arc_length, aligned.points,
                                             {.terms = options_.solve.terms,
                                              .max_evaluations = options_.solve.max_evaluations,
                                              .time_limit = remaining}));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", scene.file, error.what()));
  }
}

energy_model::Equilibrium MeasuredShapes::solve_stretched(const Scene& scene,
                                                          const energy_model::Equilibrium* start) {
  SolveOptions options = options_.solve;
  options.time_limit = time_left();
  options.start = start;
  ++solves_;
  try {
    return counted(solve_reference(scene, options));
  } catch (const ConvergenceError&) {
    (void)time_left();
    return {};  // not_run
  }
}

energy_model::Equilibrium MeasuredShapes::solve(const energy_model::Problem& problem,
                                                const std::string& file,
                                                const energy_model::Equilibrium* start) {
  const double remaining = time_left();
  ++solves_;
  try {
    return counted(
        energy_model::solve_energy(problem, {.terms = options_.solve.terms,
                                             .max_evaluations = options_.solve.max_evaluations,
                                             .time_limit = remaining,
                                             .start = start}));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", file, error.what()));
  }
}

double MeasuredShapes::sum_of_squares(std::size_t shape,
                                      const energy_model::Equilibrium& rod) const {
  return alignment(shape, rod).mean_square * static_cast<double>(shapes_[shape].aligner.points());
}

Eigen::VectorXd MeasuredShapes::root_weights(const std::vector<double>& s,
                                             const Eigen::Matrix3Xd& points) const {
  if (options_.weights == PointWeights::equal) return Eigen::VectorXd::Ones(points.cols());
  return (point_weights(s, points) * static_cast<double>(points.cols())).cwiseSqrt();
}

std::vector<ResidualSeries> MeasuredShapes::residuals(std::size_t shape, const Curve& curve,
                                                      const Alignment& alignment,
                                                      const std::vector<Movement>& movements,
                                                      Eigen::Index numbers) const {
  const ShapeData& measured = shapes_[shape];
  const Eigen::Index columns = frame_columns_ + numbers;
  const std::vector<double>& s = alignment.shape.arc_length;
  const Eigen::Matrix3Xd& points = alignment.shape.points;
  const Eigen::Vector3d centre = points.rowwise().mean();
  const std::vector<Eigen::Matrix3Xd> directions =
      observed_directions(alignment, curve, measured.flat);
  std::vector<ResidualSeries> result(static_cast<std::size_t>(directions.front().cols()),
                                     {shape, s, Eigen::VectorXd::Zero(points.cols()),
                                      Eigen::MatrixXd::Zero(points.cols(), columns)});
  const Eigen::VectorXd scale = root_weights(s, points);
  for (Eigen::Index row = 0; row < points.cols(); ++row) {
    const auto at = static_cast<std::size_t>(row);
    Eigen::Matrix3Xd derivatives = Eigen::Matrix3Xd::Zero(3, columns);
    const Eigen::Matrix3Xd of_frame =
        frame_derivatives(options_.pose, (points.col(row) - centre) / curve.length(), measured.up);
    derivatives.middleCols(measured.columns, of_frame.cols()) = of_frame;
    for (const auto& [column, velocity] : movements) derivatives.col(column) = velocity.col(row);
    const Eigen::Vector3d gap = points.col(row) - curve.point(s[at]);
    const Eigen::VectorXd values = directions[at].transpose() * gap;
    const Eigen::MatrixXd slopes = directions[at].transpose() * derivatives;
    for (std::size_t k = 0; k < result.size(); ++k) {
      result[k].residual[row] = scale[row] * values[static_cast<Eigen::Index>(k)];
      result[k].design.row(row) = scale[row] * slopes.row(static_cast<Eigen::Index>(k));
    }
  }
  return result;
}

}  // namespace dlo::compare
