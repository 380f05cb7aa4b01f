#include "released/hinge_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape.hpp"
#include "motion/frame_clock.hpp"
#include "motion/moving_scene.hpp"

namespace dlo::compare {
namespace {

void require_released(const ReleasedRod& rod) {
  require_dynamic(rod.scene);
  const Scene& scene = rod.scene;
  const bool moves = std::ranges::any_of(
      scene.grippers, [](const Gripper& gripper) { return !gripper.trajectory.empty(); });
  if (moves || !scene.obstacles.empty() || !rod.begin.obstacles.empty()) {
    throw InputError(fmt::format(
        "{}: a released rod (allowed: grippers that stand, and no obstacles)", scene.file));
  }
  if (scene.length != rod.begin.length || scene.grippers.size() != rod.begin.grippers.size()) {
    throw InputError(fmt::format(
        "{}: begin: another rod than that of {} (allowed: the same length and grippers)",
        rod.begin.file, scene.file));
  }
}

void require_hinges(const Scene& scene) {
  const bool plain = scene.sections.empty() && scene.distributed_loads.empty() &&
                     !scene.has_material_directors() && scene.stretch == Stretch::none;
  if (plain && scene.grippers.size() == 1 && scene.grippers.front().at == 0) return;
  throw InputError(fmt::format(
      "{}: a moving chain of hinges (allowed: a straight, round rod of one section that one "
      "gripper holds at s = 0)",
      scene.file));
}

/// The chain of hinges and its state.
class Hinges {
 public:
  Hinges(const Scene& scene, const energy_model::StartingShape& start, Eigen::Index segments)
      : clamp_(scene.grippers.front().direction),
        stiffness_(scene.bending_stiffness()),
        h_(scene.length / static_cast<double>(segments)),
        mass_(Eigen::VectorXd::Zero(segments + 1)),
        dead_loads_(Eigen::Matrix3Xd::Zero(3, segments + 1)),
        points_(3, segments + 1),
        force_(3, segments + 1) {
    const double density = scene.mass_per_length();
    for (Eigen::Index i = 0; i <= segments; ++i) {
      mass_(i) = density * h_ * (i == 0 || i == segments ? 0.5 : 1.0);
      dead_loads_.col(i) = mass_(i) * scene.gravity;
    }
    for (const PointLoad& load : scene.loads) {
      const double x = load.at / h_;
      const auto i = std::min(static_cast<Eigen::Index>(x), segments - 1);
      const double share = x - static_cast<double>(i);
      mass_(i) += (1 - share) * load.mass;
      mass_(i + 1) += share * load.mass;
      dead_loads_.col(i) += (1 - share) * load.force;
      dead_loads_.col(i + 1) += share * load.force;
    }
    std::vector<double> middles(static_cast<std::size_t>(segments));
    for (std::size_t i = 0; i < middles.size(); ++i) {
      middles[i] = (static_cast<double>(i) + 0.5) * h_;
    }
    const Eigen::Matrix3Xd along = start(middles).tangents;
    points_.col(0) = scene.grippers.front().position;
    for (Eigen::Index i = 0; i < segments; ++i) {
      points_.col(i + 1) = points_.col(i) + h_ * along.col(i);
    }
    before_ = points_;
    multipliers_ = Eigen::VectorXd::Zero(segments);
  }

  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }

  /// Makes a step of Verlet's method. @return false if the constraints did not converge
  [[nodiscard]] bool step(double time) {
    const Eigen::Matrix3Xd along =
        points_.rightCols(mass_.size() - 1) - points_.leftCols(mass_.size() - 1);
    add_forces(along / h_);
    // The first step, from rest, has half the displacement of the others.
    const double squared = time * time * (is_first_step_ ? 0.5 : 1.0);
    Eigen::Matrix3Xd next = is_first_step_ ? points_ : Eigen::Matrix3Xd(2 * points_ - before_);
    for (Eigen::Index i = 1; i < next.cols(); ++i)
      next.col(i) += squared / mass_(i) * force_.col(i);
    if (!satisfy_length_constraints(along, squared, next)) return false;
    before_.swap(points_);
    points_.swap(next);
    is_first_step_ = false;
    return true;
  }

 private:
  /// Sums the forces of weight, loads and springs. @param units  directions of the segments
  void add_forces(const Eigen::Matrix3Xd& units) {
    force_ = dead_loads_;
    if (clamp_) add_spring(*clamp_, units.col(0), 2 * stiffness_ / h_, 0);
    for (Eigen::Index i = 1; i < units.cols(); ++i) {
      add_spring(units.col(i - 1), units.col(i), stiffness_ / h_, i);
    }
  }

  /// Adds the forces of the hinge at a point, with the directions before and after it.
  void add_spring(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double k, Eigen::Index i) {
    const double cosine = a.dot(b);
    const double sine = a.cross(b).norm();
    const double ratio = sine > 0 ? std::atan2(sine, cosine) / sine : 1.0;
    const Eigen::Vector3d after = k * ratio / h_ * (a - cosine * b);
    force_.col(i + 1) += after;
    force_.col(i) -= after;
    if (i == 0) return;
    const Eigen::Vector3d before = k * ratio / h_ * (b - cosine * a);
    force_.col(i) += before;
    force_.col(i - 1) -= before;
  }

  /// Satisfies the constraints of length by Newton's method for the multipliers, whose matrix is
  /// tridiagonal.
  bool satisfy_length_constraints(const Eigen::Matrix3Xd& along, double squared,
                                  Eigen::Matrix3Xd& next) {
    constexpr int most = 20;
    const Eigen::Index n = along.cols();
    // Relative to h^2: rounding. Points at a distance of n h are accurate to half an epsilon of
    // that.
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const double allowed = std::max(1e-13, 4 * epsilon * static_cast<double>(n));
    Eigen::VectorXd& l = multipliers_;
    const auto inverse = [&](Eigen::Index i) { return i == 0 ? 0.0 : squared / mass_(i); };
    apply(along, l, squared, next);
    Eigen::VectorXd right(n), lower(n), middle(n), upper(n);
    for (int iteration = 0; iteration < most; ++iteration) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::Vector3d d = next.col(j + 1) - next.col(j);
        right(j) = h_ * h_ - d.squaredNorm();
        middle(j) = -2 * d.dot(along.col(j)) * (inverse(j) + inverse(j + 1));
        lower(j) = j == 0 ? 0.0 : 2 * d.dot(along.col(j - 1)) * inverse(j);
        upper(j) = j + 1 == n ? 0.0 : 2 * d.dot(along.col(j + 1)) * inverse(j + 1);
      }
      if (!right.allFinite()) return false;
      if (right.lpNorm<Eigen::Infinity>() <= allowed * h_ * h_) return true;
      for (Eigen::Index j = 1; j < n; ++j) {
        const double factor = lower(j) / middle(j - 1);
        middle(j) -= factor * upper(j - 1);
        right(j) -= factor * right(j - 1);
      }
      for (Eigen::Index j = n - 1; j >= 0; --j) {
        if (j + 1 < n) right(j) -= upper(j) * right(j + 1);
        right(j) /= middle(j);
      }
      l += right;
      apply(along, right, squared, next);
    }
    return false;
  }

  /// Applies the tensions of the segments, divided by h, to their points.
  void apply(const Eigen::Matrix3Xd& along, const Eigen::VectorXd& tensions, double squared,
             Eigen::Matrix3Xd& next) const {
    for (Eigen::Index j = 0; j < along.cols(); ++j) {
      if (j > 0) next.col(j) += squared / mass_(j) * tensions(j) * along.col(j);
      next.col(j + 1) -= squared / mass_(j + 1) * tensions(j) * along.col(j);
    }
  }

  std::optional<Eigen::Vector3d> clamp_;
  double stiffness_;
  double h_;
  Eigen::VectorXd mass_;
  Eigen::Matrix3Xd dead_loads_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd before_;
  Eigen::Matrix3Xd force_;
  Eigen::VectorXd multipliers_;
  bool is_first_step_ = true;
};

}  // namespace

double largest_distance(const std::vector<Eigen::Matrix3Xd>& a,
                        const std::vector<Eigen::Matrix3Xd>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, (a[i] - b[i]).colwise().norm().maxCoeff());
  }
  return most;
}

energy_model::StartingShape released_shape(const ReleasedRod& rod, const SolveOptions& options) {
  require_released(rod);
  return solve_reference(rod.begin, Model::energy, options).sample;
}

ReleasedMotion release_rod(const ReleasedRod& rod, const std::vector<double>& times,
                           const std::vector<double>& arc_length, int terms) {
  const energy_model::StartingShape start = released_shape(rod);
  energy_model::MovingRod moving;
  try {
    moving.problem = frame_problem(rod.scene, {});
    moving.inertia = scene_inertia(rod.scene);
    const energy_model::Dynamics moved = energy_model::simulate(
        moving, start, times, {.terms = terms, .time_limit = SolveOptions().time_limit});
    if (moved.frames.size() < times.size()) {
      throw ConvergenceError(fmt::format("{}: stopped at {:g} s: {}", rod.scene.file,
                                         times[moved.frames.size()], moved.message));
    }
    ReleasedMotion result{.terms = moved.terms, .step_error = moved.error_estimate};
    result.frames.reserve(times.size());
    for (const energy_model::MovingFrame& frame : moved.frames) {
      result.frames.push_back(frame.sample(arc_length).points);
    }
    return result;
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", rod.scene.file, error.what()));
  }
}

std::vector<Eigen::Matrix3Xd> hinge_motion(const ReleasedRod& rod, int segments,
                                           const std::vector<double>& times,
                                           const SolveOptions& options) {
  require_hinges(rod.scene);
  Hinges hinges(rod.scene, released_shape(rod, options), segments);
  // Verlet's method is stable up to omega dt = 2. The fastest zigzag mode of a chain has omega = 4
  // / h^2 (EI / m)^(1/2), slightly more with half a mass at the tip and the clamp's spring.
  constexpr double phase = 0.7;
  const double h = rod.scene.length / segments;
  const double longest =
      phase * h * h / 4 * std::sqrt(rod.scene.mass_per_length() / rod.scene.bending_stiffness());
  const double interval = times[1] - times[0];
  const auto steps = static_cast<long>(std::ceil(interval / longest));
  std::vector<Eigen::Matrix3Xd> frames = {hinges.points()};
  const Timer timer;
  while (frames.size() < times.size()) {
    for (long i = 0; i < steps; ++i) {
      if (!(timer.seconds() < options.time_limit)) {
        throw ConvergenceError(
            fmt::format("{}: time limit of {:g} s reached after {:g} s of motion", rod.scene.file,
                        options.time_limit, times[frames.size() - 1]));
      }
      if (hinges.step(interval / static_cast<double>(steps))) continue;
      throw ConvergenceError(fmt::format("{}: a moving chain of {} hinges diverged after {:g} s",
                                         rod.scene.file, segments, times[frames.size() - 1]));
    }
    frames.push_back(hinges.points());
  }
  return frames;
}

HingeLimit hinge_limit(const ReleasedRod& rod, int segments, const std::vector<double>& times) {
  const auto at_common_points = [&](int factor) {
    std::vector<Eigen::Matrix3Xd> frames = hinge_motion(rod, factor * segments, times);
    for (Eigen::Matrix3Xd& points : frames) {
      points = Eigen::Matrix3Xd(points(Eigen::all, Eigen::seqN(0, segments + 1, factor)));
    }
    return frames;
  };
  const auto extrapolated = [](const std::vector<Eigen::Matrix3Xd>& coarse,
                               const std::vector<Eigen::Matrix3Xd>& fine, double ratio) {
    std::vector<Eigen::Matrix3Xd> limit = fine;
    for (std::size_t i = 0; i < fine.size(); ++i) limit[i] += (fine[i] - coarse[i]) / (ratio - 1);
    return limit;
  };
  const std::vector<Eigen::Matrix3Xd> middle = at_common_points(2);
  const std::vector<Eigen::Matrix3Xd> first = extrapolated(at_common_points(1), middle, 4);
  const std::vector<Eigen::Matrix3Xd> second = extrapolated(middle, at_common_points(4), 4);
  HingeLimit result{.frames = extrapolated(first, second, 16)};
  result.error = largest_distance(result.frames, second);
  return result;
}

}  // namespace dlo::compare
