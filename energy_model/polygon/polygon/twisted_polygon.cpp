#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {
namespace {

/// Size of the first and of the longest continuation step: change of the largest twist angle [rad].
constexpr double first_twist_step = 0.25;
constexpr double longest_twist_step = 1;
/// Displacement of a point, divided by the length, above which a step is repeated with a smaller
/// size. A step of at most `twist_step_at_jump` is accepted: a shape that still moves as far has
/// jumped to another branch.
constexpr double longest_movement = 0.05;
constexpr double twist_step_at_jump = 0.02;
constexpr double least_twist_step = 1e-4;

/// Intermediate problems between no twist and the prescribed twist.
class TwistHomotopy {
 public:
  TwistHomotopy(PolygonProblem problem, const Eigen::Matrix3Xd& start) : last_(std::move(problem)) {
    for (PolygonTwist& twist : last_.twists) {
      twist.angle = polygon_twist_angle(twist, start);
      angles_.push_back(twist.angle);
      longest_ = std::max(longest_, std::abs(twist.angle));
    }
  }

  /// Returns the largest twist angle of the start under the full twist [rad].
  [[nodiscard]] double largest_twist_angle() const { return longest_; }

  /// Returns the problem at an intermediate twist.
  /// @param to    share of the full twist, 0 .. 1
  /// @param now   twist angles of a shape at the share `from` [rad]
  [[nodiscard]] PolygonProblem at(double to, const std::vector<double>& now, double from) const {
    PolygonProblem problem = last_;
    // Rotation of the first frame of a twist, which may be the last frame of another.
    double turned = 0;
    for (std::size_t k = 0; k < problem.twists.size(); ++k) {
      PolygonTwist& twist = problem.twists[k];
      const bool follows = k > 0 && problem.twists[k - 1].last_segment == twist.first_segment;
      if (!follows) turned = 0;
      twist.first_d1 = inverse_rotation(twist.first_segment, (1 - to) * turned) * twist.first_d1;
      turned += angles_[k];
      twist.last_d1 = inverse_rotation(twist.last_segment, (1 - to) * turned) * twist.last_d1;
      twist.angle = now[k] + (to - from) * angles_[k];
    }
    return problem;
  }

 private:
  /// Returns the rotation about a held segment by minus an angle.
  [[nodiscard]] Eigen::AngleAxisd inverse_rotation(Eigen::Index segment, double angle) const {
    Eigen::Vector3d along = Eigen::Vector3d::Zero();
    for (const HeldPoint& held : last_.held) {
      if (held.point == segment) along -= held.position;
      if (held.point == segment + 1) along += held.position;
    }
    return {-angle, along.normalized()};
  }

  PolygonProblem last_;
  std::vector<double> angles_;
  double longest_ = 0;
};

}  // namespace

PolygonResult twist_polygon(const PolygonProblem& problem, const Points& start,
                            const PolygonOptions& options) {
  const Deadline deadline(options.time_limit);
  require_polygon(problem, start, options);
  const TwistHomotopy homotopy(problem, start);
  const double length = problem.rest_lengths.sum();
  PolygonOptions step_options = options;
  step_options.in_stages = false;
  PolygonResult now;
  now.points = start;
  now.twists.assign(problem.twists.size(), 0);
  Eigen::Matrix3Xd slope;  // derivative of the points by the share of the twist; empty after a jump
  double part = 0;
  double turning = first_twist_step;
  while (part < 1) {
    const double next =
        std::min(1.0, part + turning / std::max(turning, homotopy.largest_twist_angle()));
    const PolygonProblem next_problem = homotopy.at(next, now.twists, part);
    step_options.time_limit = deadline.remaining();
    step_options.max_evaluations = options.max_evaluations - now.evaluations;
    if (step_options.time_limit <= 0 || step_options.max_evaluations < 1) {
      const bool late = step_options.time_limit <= 0;
      now.status = late ? SolveStatus::time_limit : SolveStatus::evaluation_limit;
      break;
    }
    const Eigen::Matrix3Xd from =
        slope.cols() > 0 ? Eigen::Matrix3Xd(now.points + (next - part) * slope) : now.points;
    PolygonResult found = solve_polygon(next_problem, from, step_options);
    const double moved = (found.points - now.points).colwise().norm().maxCoeff() / length;
    now.evaluations += found.evaluations;
    const bool jumped = !(moved <= longest_movement);
    slope.resize(3, 0);
    if (succeeded(found.status) && (!jumped || turning <= twist_step_at_jump)) {
      if (!jumped) slope = (found.points - now.points) / (next - part);
      found.evaluations = now.evaluations;
      now = std::move(found);
      part = next;
      turning = std::min(longest_twist_step, 1.5 * turning);
    } else if (turning > least_twist_step) {
      turning /= 3;
    } else {
      now.status = found.status;
      break;
    }
  }
  if (part < 1) {
    now.message = std::string(to_string(now.status)) + " after " + std::to_string(part) +
                  " of the twist was applied";
  }
  now.seconds = deadline.spent();
  return now;
}

}  // namespace dlo::energy_model
