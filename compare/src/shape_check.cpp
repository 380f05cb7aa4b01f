#include "dlo/compare/shape_check.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "aligner.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "states.hpp"

namespace dlo::compare {
namespace {

/// Points with which E*/E is fitted; of more, every so many-th.
constexpr Eigen::Index most_modulus_points = 500;

MeasuredShape thinned(const MeasuredShape& shape) {
  const Eigen::Index count = shape.points.cols();
  const Eigen::Index every = (count + most_modulus_points - 1) / most_modulus_points;
  if (every == 1) return shape;
  MeasuredShape result;
  result.file = shape.file;
  const Eigen::Index kept = (count - 1) / every + 1;
  result.points.resize(3, kept);
  for (Eigen::Index i = 0; i < kept; ++i) {
    // The last point stays, for the polyline keeps its length.
    const Eigen::Index from = i + 1 == kept ? count - 1 : i * every;
    result.points.col(i) = shape.points.col(from);
    if (!shape.arc_length.empty()) {
      result.arc_length.push_back(shape.arc_length[static_cast<std::size_t>(from)]);
    }
  }
  return result;
}

/// RMS distance of points from the line that comes nearest to them.
double distance_from_line(const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d moments =
      centred * centred.transpose() / static_cast<double>(points.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[0] + eigen.eigenvalues()[1]));
}

std::optional<Eigen::Index> free_tip(const Scene& scene, const std::vector<double>& s) {
  const auto is_free = [&](double at) {
    return std::none_of(scene.grippers.begin(), scene.grippers.end(),
                        [at](const Gripper& gripper) { return gripper.at == at; });
  };
  const double near = 1e-9 * scene.length;
  if (is_free(scene.length) && s.back() >= scene.length - near) {
    return static_cast<Eigen::Index>(s.size()) - 1;
  }
  if (is_free(0) && s.front() <= near) return 0;
  return std::nullopt;
}

Deviation measured_deviation(const Scene& scene, const Alignment& alignment,
                             const Reference& reference, const Shape& on_reference,
                             double movement) {
  const std::optional<Eigen::Index> tip = free_tip(scene, alignment.shape.arc_length);
  Deviation result;
  if (alignment.arc_lengths != ArcLengths::nearest) {
    result = deviation(alignment.shape, reference, std::nullopt, tip);
  } else {
    const Eigen::Matrix3Xd gaps = alignment.shape.points - on_reference.points;
    Eigen::Index worst = 0;
    result.max_m = std::sqrt(gaps.colwise().squaredNorm().maxCoeff(&worst));
    result.max_at_m = alignment.shape.arc_length[static_cast<std::size_t>(worst)];
    result.tip_m = tip ? gaps.col(*tip).norm() : NAN;
    result.angle_rms_rad = NAN;
    result.curvature_rms_per_m = NAN;
  }
  result.rms_m = alignment.rms_m;
  result.rms_over_length = result.rms_m / scene.length;
  result.rms_over_movement = movement > 1e-9 * scene.length ? result.rms_m / movement : NAN;
  return result;
}

}  // namespace

Eigen::Vector3d up_of(const Scene& scene, PoseFreedom pose) {
  if (pose != PoseFreedom::upright) return Eigen::Vector3d::UnitY();
  if (!(scene.gravity.norm() > 0)) {
    throw InputError(fmt::format(
        "{}: no gravity, so no frame is upright (allowed: translation, rigid)", scene.file));
  }
  return -scene.gravity.normalized();
}

ShapeJudgement judge(const ShapeCheck& check, const ShapeTolerance& tolerance) {
  ShapeJudgement result;
  result.judged_m = tolerance.largest ? check.deviation.max_m : check.deviation.rms_m;
  const bool near = result.judged_m <= tolerance.allowed_m;
  const bool seen = check.seen_share >= tolerance.least_seen_share;
  result.pass = near && seen;
  result.reason = fmt::format(
      "{} {:.4g} mm, allowed {:.4g} mm = {:.4g} % of l", tolerance.largest ? "largest" : "RMS",
      result.judged_m * 1e3, tolerance.allowed_m * 1e3, tolerance.allowed_m / check.length_m * 100);
  if (seen) return result;
  const std::string unseen = fmt::format("only {:.4g} % of the rod is seen, needed {:.4g} %",
                                         check.seen_share * 100, tolerance.least_seen_share * 100);
  result.reason = near ? unseen : result.reason + "; " + unseen;
  return result;
}

ShapeCheck check_shape(const Scene& scene, const MeasuredShape& shape,
                       const ShapeCheckOptions& options) {
  const Scene near = without_far_obstacles(scene).scene;
  const AlignOptions align_options{
      .pose = options.pose, .arc_lengths = options.arc_lengths, .up = up_of(scene, options.pose)};
  const Aligner aligner(shape, scene.length, align_options);
  const energy_model::Equilibrium lowest = solve_reference(near, Model::energy, options.solve);
  const std::vector<energy_model::Equilibrium> states = all_states(near, lowest, options.solve);
  std::vector<Alignment> alignments;
  std::vector<double> from_shape;
  std::size_t nearest = 0;
  for (const energy_model::Equilibrium& state : states) {
    alignments.push_back(aligner.align(Curve(state.sample, scene.length)));
    from_shape.push_back(alignments.back().rms_m);
    // The lowest of all is stable and comes first.
    const bool nearer = from_shape.back() < from_shape[nearest];
    if (energy_model::succeeded(state.status) && nearer) nearest = alignments.size() - 1;
  }
  const energy_model::Equilibrium& energy = states[nearest];
  ShapeCheck result;
  result.scene = scene.name;
  result.file = shape.file;
  result.gamma = scene.gamma();
  result.length_m = scene.length;
  result.alignment = std::move(alignments[nearest]);
  result.state = describe_state(scene, states, nearest, from_shape);
  const Alignment& alignment = result.alignment;
  const std::vector<double>& s = alignment.shape.arc_length;
  result.reference = {s, energy.sample(s).points};
  const std::optional<Eigen::Matrix3Xd> straight = straight_rod(scene, s);
  result.movement_m = straight ? rms(s, *straight - result.reference.points) : NAN;
  result.deviation =
      measured_deviation(scene, alignment, energy.sample, result.reference, result.movement_m);

  Eigen::Index worst = 0;
  (alignment.shape.points - result.reference.points).colwise().squaredNorm().maxCoeff(&worst);
  result.worst_position = alignment.shape.points.col(worst);
  const bool file_falls = alignment.arc_lengths == ArcLengths::file &&
                          shape.arc_length.front() > shape.arc_length.back();
  const bool backwards = alignment.reversed != file_falls;
  result.worst_point = 1 + (backwards ? shape.points.cols() - 1 - worst : worst);
  for (std::size_t i = 0; i + 1 < s.size(); ++i) {
    if (!(s[i + 1] - s[i] > result.largest_gap_m)) continue;
    result.largest_gap_m = s[i + 1] - s[i];
    result.largest_gap_at_m = s[i];
  }
  const Eigen::Index segments = shape.points.cols() - 1;
  result.polyline_length_m =
      (shape.points.rightCols(segments) - shape.points.leftCols(segments)).colwise().norm().sum();
  result.seen_share = (s.back() - s.front()) / scene.length;
  result.direction_is_clear = alignment.other_rms_m > 1.05 * alignment.rms_m;
  const double offset = distance_from_line(alignment.shape.points);
  result.turn_is_clear = options.pose != PoseFreedom::rigid ||
                         offset > std::max(3 * alignment.rms_m, 1e-6 * scene.length);

  const Aligner thin(thinned(shape), scene.length, align_options);
  const ShapeDistance distance = [&](const energy_model::Equilibrium& reference) {
    return thin.align(Curve(reference.sample, scene.length)).rms_m;
  };
  result.effective_modulus =
      fit_effective_modulus(near, distance, result.state.only_lowest() ? nullptr : &energy);
  result.modulus = result.effective_modulus.ratio * scene.material.youngs_modulus;
  return result;
}

}  // namespace dlo::compare
