#include "motion/motion_start.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "dlo/compare/shape.hpp"

namespace dlo::compare {
namespace {

/// Number of points at which a start is tabulated: the error of linear interpolation is then 1e-4
/// of a half wave.
constexpr Eigen::Index table_points = 129;

/// Values of Legendre's polynomials and their derivatives at x in [-1, 1].
struct LegendreRow {
  Eigen::RowVectorXd values, slopes;

  LegendreRow(double x, Eigen::Index degree) : values(degree + 1), slopes(degree + 1) {
    values[0] = 1;
    slopes[0] = 0;
    for (Eigen::Index k = 1; k <= degree; ++k) {
      const auto n = static_cast<double>(k);
      const double before = k > 1 ? values[k - 2] : 0;
      const double slope_before = k > 1 ? slopes[k - 2] : 0;
      values[k] = ((2 * n - 1) * x * values[k - 1] - (n - 1) * before) / n;
      slopes[k] = (2 * n - 1) * values[k - 1] + slope_before;
    }
  }
};

/// A motion as sum of products of Legendre's polynomials of arc length and powers of time, fitted
/// by least squares.
class SmoothMotion {
 public:
  SmoothMotion(double length, double begin, double duration, Eigen::Index degree,
               Eigen::Index powers)
      : length_(length), begin_(begin), duration_(duration), degree_(degree), powers_(powers) {}

  void add_point(double s, double time, const Eigen::Vector3d& at, double weight) {
    add(LegendreRow(share(s), degree_).values, time, at, weight);
  }
  /// Adds a direction. Its row is multiplied by the rod length, so that it has the same weight as a
  /// position.
  void add_direction(double s, double time, const Eigen::Vector3d& along, double weight) {
    add(LegendreRow(share(s), degree_).slopes * (2 / length_), time, along, weight * length_);
  }
  void solve() {
    Eigen::MatrixXd matrix(std::ssize(rows_), rows_.front().size());
    Eigen::MatrixXd right(std::ssize(rows_), 3);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      matrix.row(i) = rows_[static_cast<std::size_t>(i)];
      right.row(i) = right_hand_sides_[static_cast<std::size_t>(i)];
    }
    coefficients_ = matrix.completeOrthogonalDecomposition().solve(right);
    const auto freedom =
        std::max<double>(1, static_cast<double>(matrix.rows() - coefficients_.rows()));
    noise_ = std::sqrt((matrix * coefficients_ - right).squaredNorm() / (3 * freedom));
  }
  /// Returns the standard deviation of a coordinate from the fit [m].
  [[nodiscard]] double noise() const { return noise_; }
  [[nodiscard]] Eigen::Vector3d tangent(double s) const {
    const Eigen::RowVectorXd slopes = LegendreRow(share(s), degree_).slopes;
    return (slopes * coefficients_.topRows(degree_ + 1)).transpose().normalized();
  }
  [[nodiscard]] Eigen::Vector3d velocity(double s) const {
    if (powers_ == 0) return Eigen::Vector3d::Zero();
    const Eigen::RowVectorXd values = LegendreRow(share(s), degree_).values;
    return (values * coefficients_.middleRows(degree_ + 1, degree_ + 1)).transpose() / duration_;
  }

 private:
  [[nodiscard]] double share(double s) const { return 2 * s / length_ - 1; }
  void add(const Eigen::RowVectorXd& along, double time, const Eigen::Vector3d& right,
           double weight) {
    Eigen::RowVectorXd row((degree_ + 1) * (powers_ + 1));
    for (Eigen::Index p = 0; p <= powers_; ++p) {
      row.segment(p * (degree_ + 1), degree_ + 1) =
          weight * std::pow((time - begin_) / duration_, static_cast<double>(p)) * along;
    }
    rows_.push_back(std::move(row));
    right_hand_sides_.emplace_back(weight * right.transpose());
  }

  double length_, begin_, duration_;
  Eigen::Index degree_, powers_;
  std::vector<Eigen::RowVectorXd> rows_;
  std::vector<Eigen::RowVector3d> right_hand_sides_;
  Eigen::MatrixX3d coefficients_;
  double noise_ = 0;
};

/// Returns the number of leading rows that have at most start_frames times.
/// @param[out] times  these times
std::size_t leading_rows(const std::vector<MarkerPosition>& rows, std::set<double>& times) {
  std::size_t count = 0;
  for (const MarkerPosition& at : rows) {
    times.insert(at.time);
    if (std::ssize(times) > start_frames) {
      times.erase(at.time);
      break;
    }
    ++count;
  }
  return count;
}

/// Whether no interval longer than half of the rod is without a point.
bool are_dense(const std::set<double>& arc_lengths, double length) {
  constexpr double largest_marker_gap_share = 0.5;
  double before = 0;
  for (const double s : arc_lengths) {
    if (s - before > largest_marker_gap_share * length) return false;
    before = s;
  }
  return length - before <= largest_marker_gap_share * length;
}

/// Returns the equally spaced arc lengths at which a start is tabulated.
std::vector<double> table_arc_lengths(double length) {
  return equal_arc_lengths(length, table_points);
}

/// Interpolates a table linearly. @param share  fraction of the rod, 0 to 1
Eigen::Vector3d interpolated(const Eigen::Matrix3Xd& table, double share) {
  const double x = std::clamp(share, 0.0, 1.0) * static_cast<double>(table.cols() - 1);
  const auto i = std::min<Eigen::Index>(static_cast<Eigen::Index>(x), table.cols() - 2);
  const double t = x - static_cast<double>(i);
  return (1 - t) * table.col(i) + t * table.col(i + 1);
}

/// Returns a start with these unit tangents at arc lengths [m]; its points follow from them.
template <typename Tangent>
energy_model::StartingShape shape_along(Tangent tangent) {
  return [tangent = std::move(tangent)](std::span<const double> at) {
    energy_model::Samples samples;
    samples.arc_length.assign(at.begin(), at.end());
    const Eigen::Index points = std::ssize(at);
    samples.points = samples.curvature = Eigen::Matrix3Xd::Zero(3, points);
    samples.tangents.resize(3, points);
    for (Eigen::Index i = 0; i < points; ++i) {
      samples.tangents.col(i) = tangent(at[static_cast<std::size_t>(i)]);
    }
    return samples;
  };
}

/// Returns the start at the begin of a motion.
/// @param duration  of the frames [s]; 0: one frame, at rest
MotionStart start_of(const std::shared_ptr<SmoothMotion>& motion, double duration) {
  MotionStart result;
  result.noise = motion->noise();
  result.shape = shape_along([motion](double s) { return motion->tangent(s); });
  result.duration = duration;
  if (!(duration > 0)) return result;
  result.velocities = [motion](std::span<const double> at) {
    Eigen::Matrix3Xd velocities(3, std::ssize(at));
    for (Eigen::Index i = 0; i < velocities.cols(); ++i) {
      velocities.col(i) = motion->velocity(at[static_cast<std::size_t>(i)]);
    }
    return velocities;
  };
  return result;
}

}  // namespace

std::optional<MotionStart> smooth_start(const Scene& scene, const MarkerMotion& rows,
                                        double begin) {
  std::set<double> times;
  const std::size_t count = leading_rows(rows.positions, times);
  std::set<double> known;
  for (std::size_t i = 0; i < count; ++i) known.insert(rows.positions[i].arc_length);
  Eigen::Index conditions = std::ssize(known);
  for (const Gripper& gripper : scene.grippers) {
    if (known.insert(gripper.at).second) ++conditions;
    if (gripper.direction) ++conditions;
  }
  constexpr std::size_t least_count = 4;
  if (known.size() < least_count || !are_dense(known, scene.length)) return std::nullopt;
  // Polynomials through equidistant points oscillate if the degree exceeds twice the root of their
  // number.
  const auto degree = std::min<Eigen::Index>(
      conditions - 1, static_cast<Eigen::Index>(2 * std::sqrt(static_cast<double>(conditions))));
  // Half as many powers as intervals, so that the residuals contain the errors of the powers.
  const Eigen::Index powers = std::clamp<Eigen::Index>((std::ssize(times) - 1) / 2, 1, 3);
  const double duration = times.size() > 1 ? *times.rbegin() - *times.begin() : 1;
  auto motion =
      std::make_shared<SmoothMotion>(scene.length, times.size() > 1 ? begin : *times.begin(),
                                     duration, degree, times.size() > 1 ? powers : 0);
  for (std::size_t i = 0; i < count; ++i) {
    const MarkerPosition& at = rows.positions[i];
    motion->add_point(*on_rod(at.arc_length, scene.length), at.time, at.position, 1);
  }
  // Weight of a gripper's residual relative to that of a marker. The error of a marker then
  // displaces the curve at a gripper by about a thousandth of the error.
  constexpr double grip_weight = 30;
  for (const double time : times) {
    const Scene now =
        times.size() > 1 ? scene_at(scene, time, time) : scene_at(scene, begin, begin);
    for (const Gripper& gripper : now.grippers) {
      motion->add_point(gripper.at, time, gripper.position, grip_weight);
      if (gripper.direction)
        motion->add_direction(gripper.at, time, *gripper.direction, grip_weight);
    }
  }
  motion->solve();
  return start_of(motion, times.size() > 1 ? duration : 0);
}

StartDeviation::StartDeviation(const MotionStart& base, double length, bool clamped)
    : length_(length), clamped_(clamped), noise_(base.noise), duration_(base.duration) {
  const std::vector<double> s = table_arc_lengths(length);
  tangents_ = base.shape(s).tangents;
  velocities_ = base.velocities ? base.velocities(s) : Eigen::Matrix3Xd::Zero(3, table_points);
  d1_.resize(3, table_points);
  d2_.resize(3, table_points);
  Eigen::Vector3d across = tangents_.col(0).unitOrthogonal();
  for (Eigen::Index i = 0; i < table_points; ++i) {
    const Eigen::Vector3d t = tangents_.col(i);
    across = (across - across.dot(t) * t).normalized();
    d1_.col(i) = across;
    d2_.col(i) = t.cross(across);
  }
}

Eigen::VectorXd StartDeviation::deviations() const {
  // The error of a cubic's value at the end of eleven frames is that of one of them; the error of
  // its slope is 14 to 45 times as large, divided by the duration. A half wave of the rod converts
  // it to an angle.
  constexpr double end_value_error_factor = 2;
  constexpr double end_slope_error_factor = 20;
  constexpr double least_noise = 1e-6;
  const double error = std::max(noise_, least_noise * length_) / length_;
  Eigen::VectorXd result(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const double waves = std::numbers::pi * static_cast<double>(i % start_modes + 1);
    const bool is_rate = i >= size() / 2;
    result[i] =
        error * waves * (is_rate ? end_slope_error_factor / duration_ : end_value_error_factor);
  }
  return result;
}

MotionStart StartDeviation::with(const Eigen::VectorXd& modes) const {
  Eigen::Matrix3Xd tangents = tangents_;
  Eigen::Matrix3Xd rates(3, table_points);
  const Eigen::Map<const Eigen::MatrixXd> by_direction(modes.data(), start_modes, 4);
  for (Eigen::Index i = 0; i < table_points; ++i) {
    const double x = 2 * static_cast<double>(i) / static_cast<double>(table_points - 1) - 1;
    Eigen::RowVectorXd values = LegendreRow(x, start_modes).values;
    // A clamp holds the tangent at s = 0.
    for (Eigen::Index k = 0; k <= start_modes && clamped_; ++k) values[k] -= k % 2 == 0 ? 1 : -1;
    const Eigen::RowVectorXd used =
        clamped_ ? values.tail(start_modes).eval() : values.head(start_modes).eval();
    const Eigen::RowVector4d along = used * by_direction;
    tangents.col(i) =
        (tangents_.col(i) + along[0] * d1_.col(i) + along[1] * d2_.col(i)).normalized();
    rates.col(i) = along[2] * d1_.col(i) + along[3] * d2_.col(i);
  }
  Eigen::Matrix3Xd velocities = velocities_;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const double step = length_ / static_cast<double>(table_points - 1);
  for (Eigen::Index i = 1; i < table_points; ++i) {
    sum += step / 2 * (rates.col(i - 1) + rates.col(i));
    velocities.col(i) += sum;
  }
  MotionStart result;
  result.shape = shape_along([tangents, length = length_](double s) -> Eigen::Vector3d {
    return interpolated(tangents, s / length).normalized();
  });
  result.velocities = [velocities, length = length_](std::span<const double> at) {
    Eigen::Matrix3Xd found(3, std::ssize(at));
    for (Eigen::Index i = 0; i < found.cols(); ++i) {
      found.col(i) = interpolated(velocities, at[static_cast<std::size_t>(i)] / length);
    }
    return found;
  };
  return result;
}

}  // namespace dlo::compare
