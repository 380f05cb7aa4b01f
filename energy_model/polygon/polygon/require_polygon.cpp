#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/require.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {
namespace {

constexpr const char* name = "PolygonProblem";

/// Checks that vectors have no z component, as polygons whose joints are bent at rest require.
void require_in_plane(const char* problem, const char* what, const Points& vectors) {
  const double across = vectors.row(2).cwiseAbs().maxCoeff();
  require(across == 0, problem, (std::string("z of ") + what).c_str(), across,
          "0 with natural turns");
}

void require_twists(const PolygonProblem& problem) {
  const Eigen::Index n = problem.rest_lengths.size();
  const auto count = static_cast<double>(problem.twists.size());
  require(problem.twists.empty() || problem.law != JointLaw::paper, name, "number of twists", count,
          "0 for the paper's law");
  require(problem.twists.empty() || problem.natural_turns.size() == 0, name, "number of twists",
          count, "0 with natural turns");
  const auto is_held = [&](Eigen::Index point) {
    return std::ranges::find(problem.held, point, &HeldPoint::point) != problem.held.end();
  };
  for (const PolygonTwist& twist : problem.twists) {
    for (const Eigen::Index segment : {twist.first_segment, twist.last_segment}) {
      const bool held = segment >= 0 && segment < n && is_held(segment) && is_held(segment + 1);
      require(held, name, "segment of a twist", static_cast<double>(segment),
              "one whose two points are held");
    }
    require(twist.first_segment < twist.last_segment, name, "first_segment of a twist",
            static_cast<double>(twist.first_segment), "less than its last_segment");
    require_positive(name, "compliance of a twist", twist.compliance);
    require_finite(name, "angle of a twist", twist.angle);
    for (const Eigen::Vector3d& d1 : {twist.first_d1, twist.last_d1}) {
      require_positive(name, "|d1| of a twist", d1.norm());
    }
  }
}

}  // namespace

void require_polygon(const PolygonProblem& problem, const Points& start,
                     const PolygonOptions& options) {
  const Eigen::Index n = problem.rest_lengths.size();
  require(n >= 2, name, "number of segments", static_cast<double>(n), ">= 2");
  const double shortest = problem.rest_lengths.minCoeff();
  require(shortest > 0 && problem.rest_lengths.allFinite(), name, "smallest rest length", shortest,
          "finite and > 0");
  require_positive(name, "stretch_stiffness", problem.stretch_stiffness);
  require_positive(name, "stiffness", problem.stiffness);
  require_unlike_joints(name, problem.law, problem.stiffnesses, problem.natural_turns, n);
  require_twists(problem);
  require(problem.node_forces.cols() == n + 1, name, "columns of node_forces",
          static_cast<double>(problem.node_forces.cols()), "one more than segments");
  require_finite(name, "node_forces", problem.node_forces);
  require(!problem.held.empty(), name, "number of held points", 0, ">= 1");
  std::vector<bool> taken(static_cast<std::size_t>(n + 1), false);
  for (const HeldPoint& held : problem.held) {
    const bool exists = held.point >= 0 && held.point <= n;
    require(exists && !taken[static_cast<std::size_t>(held.point)], name, "a held point",
            static_cast<double>(held.point), "a point of the polygon that is held only once");
    taken[static_cast<std::size_t>(held.point)] = true;
    require_finite(name, "position of a held point", held.position);
  }
  for (const PointObstacle& obstacle : problem.obstacles) {
    require(obstacle.stiffness >= 0 && std::isfinite(obstacle.stiffness), name,
            "stiffness of an obstacle", obstacle.stiffness, "finite and >= 0");
    require(obstacle.body.centre().allFinite() && obstacle.body.axes().allFinite(), name,
            "point of an obstacle", obstacle.body.centre().norm(), "finite, like its axes");
    require(obstacle.stiffnesses.size() == 0 ||
                (obstacle.stiffnesses.size() == n && obstacle.stiffnesses.minCoeff() >= 0 &&
                 obstacle.stiffnesses.allFinite()),
            name, "number of stiffnesses of an obstacle",
            static_cast<double>(obstacle.stiffnesses.size()),
            "0 or the number of segments, each finite and >= 0");
    require(obstacle.samples >= 1, name, "samples per segment", obstacle.samples, ">= 1");
  }
  require_positive("PolygonOptions", "tolerance", options.tolerance);
  require(options.max_evaluations >= 1, "PolygonOptions", "max_evaluations",
          options.max_evaluations, ">= 1");
  require(options.time_limit > 0, "PolygonOptions", "time_limit", options.time_limit, "> 0");
  require(start.cols() == n + 1, "solve_polygon", "columns of start",
          static_cast<double>(start.cols()), "one more than segments");
  const double closest = (start.rightCols(n) - start.leftCols(n)).colwise().norm().minCoeff();
  if (problem.natural_turns.size() > 0) {
    require_in_plane(name, "a node force", problem.node_forces);
    require_in_plane("solve_polygon", "a point of start", start);
    for (const HeldPoint& held : problem.held) {
      require_in_plane(name, "a held point", held.position);
    }
    for (const PointObstacle& obstacle : problem.obstacles) {
      require(obstacle.body.is_symmetric(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(),
                                         problem.rest_lengths.sum()),
              name, "z of an obstacle's centre", obstacle.body.centre().z(),
              "0, with an obstacle that is symmetric about the plane z = 0");
    }
  }
  require(start.allFinite() && closest > 0, "solve_polygon", "shortest segment of start", closest,
          "finite and > 0");
}

void require_unlike_joints(const char* problem, JointLaw law, const Eigen::VectorXd& stiffnesses,
                           const Eigen::VectorXd& natural_turns, Eigen::Index n) {
  const auto require_each = [&](const Eigen::VectorXd& numbers, const char* size) {
    require(numbers.size() == 0 || numbers.size() == n - 1, problem, size,
            static_cast<double>(numbers.size()), "0 or the number of joints");
  };
  require_each(stiffnesses, "size of stiffnesses");
  require_each(natural_turns, "size of natural_turns");
  for (const double stiffness : stiffnesses) {
    require_positive(problem, "stiffness of a joint", stiffness);
  }
  require(natural_turns.size() == 0 || law != JointLaw::paper, problem, "size of natural_turns",
          static_cast<double>(natural_turns.size()), "0 for the paper's law");
  for (const double turn : natural_turns) {
    require(std::abs(turn) < fold_angle, problem, "natural turn", turn, "in (-3, 3) rad");
  }
}

}  // namespace dlo::energy_model
