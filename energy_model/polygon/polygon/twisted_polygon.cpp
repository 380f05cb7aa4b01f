#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "polygon/require_polygon.hpp"

namespace dlo::energy_model {
namespace {

/// Of the largest twist in one step [rad].
constexpr double first_turning = 0.25;
constexpr double longest_turning = 1;
/// A step that moves a point by more than this share of the length is made shorter, down to
/// `turning_at_jump`: what moves as far then has jumped to another shape.
constexpr double longest_movement = 0.05;
constexpr double turning_at_jump = 0.02;
constexpr double least_turning = 1e-4;

/// Problems on the way from no twist to all of it.
class TwistedWay {
 public:
  TwistedWay(PolygonProblem problem, const Eigen::Matrix3Xd& start) : last_(std::move(problem)) {
    for (PolygonTwist& twist : last_.twists) {
      twist.angle = polygon_twist_angle(twist, start);
      angles_.push_back(twist.angle);
      longest_ = std::max(longest_, std::abs(twist.angle));
    }
  }

  /// The largest twist of the start, all of it on [rad].
  [[nodiscard]] double length() const { return longest_; }

  /// @param to    part of the way, 0 .. 1
  /// @param now   twists that a shape has at the part `from`
  [[nodiscard]] PolygonProblem at(double to, const std::vector<double>& now, double from) const {
    PolygonProblem problem = last_;
    double turned = 0;  // of the first frame of a twist, which may be the last of another
    for (std::size_t k = 0; k < problem.twists.size(); ++k) {
      PolygonTwist& twist = problem.twists[k];
      const bool follows = k > 0 && problem.twists[k - 1].last_segment == twist.first_segment;
      if (!follows) turned = 0;
      twist.first_d1 = turned_back(twist.first_segment, (1 - to) * turned) * twist.first_d1;
      turned += angles_[k];
      twist.last_d1 = turned_back(twist.last_segment, (1 - to) * turned) * twist.last_d1;
      twist.angle = now[k] + (to - from) * angles_[k];
    }
    return problem;
  }

 private:
  /// About a held segment.
  [[nodiscard]] Eigen::AngleAxisd turned_back(Eigen::Index segment, double angle) const {
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

PolygonResult twist_polygon(const PolygonProblem& problem,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& start,
                            const PolygonOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  require_polygon(problem, start, options);
  const Deadline deadline(options.time_limit);
  const TwistedWay way(problem, start);
  const double length = problem.rest_lengths.sum();
  PolygonOptions step_options = options;
  step_options.in_stages = false;
  PolygonResult now;
  now.points = start;
  now.twists.assign(problem.twists.size(), 0);
  Eigen::Matrix3Xd slope;  // of the points by part; empty after a jump
  double part = 0;
  double turning = first_turning;
  while (part < 1) {
    const double next = std::min(1.0, part + turning / std::max(turning, way.length()));
    const PolygonProblem there = way.at(next, now.twists, part);
    step_options.time_limit = deadline.remaining();
    step_options.max_evaluations = options.max_evaluations - now.evaluations;
    if (step_options.time_limit <= 0 || step_options.max_evaluations < 1) {
      const bool late = step_options.time_limit <= 0;
      now.status = late ? SolveStatus::time_limit : SolveStatus::evaluation_limit;
    } else {
      const Eigen::Matrix3Xd from =
          slope.cols() > 0 ? Eigen::Matrix3Xd(now.points + (next - part) * slope) : now.points;
      PolygonResult found = solve_polygon(there, from, step_options);
      const double moved = (found.points - now.points).colwise().norm().maxCoeff() / length;
      now.evaluations += found.evaluations;
      const bool solved = succeeded(found.status);
      const bool jumped = !(moved <= longest_movement);
      if (solved && (!jumped || turning <= turning_at_jump)) {
        slope.resize(3, 0);
        if (!jumped) slope = (found.points - now.points) / (next - part);
        found.evaluations = now.evaluations;
        now = std::move(found);
        part = next;
        turning = std::min(longest_turning, 1.5 * turning);
        continue;
      }
      if (turning > least_turning) {
        turning /= 3;
        slope.resize(3, 0);
        continue;
      }
      now.status = found.status;
    }
    now.message = std::string(to_string(now.status)) + ", twisted by " + std::to_string(part) +
                  " of its turn";
    break;
  }
  now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return now;
}

}  // namespace dlo::energy_model
