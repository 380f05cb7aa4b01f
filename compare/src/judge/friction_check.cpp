#include "dlo/compare/friction_check.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "judge/held_polygon.hpp"
#include "judge/nonnegative_least_squares.hpp"
#include "scene/reach.hpp"

namespace dlo::compare {
namespace {

/// What any friction is: up to this factor on the scene's coefficients, and at least up to this
/// coefficient.
constexpr double largest_factor = 10;
constexpr double largest_coefficient = 5;

double any_friction(const Scene& scene) {
  double factor = largest_factor;
  for (const Obstacle& obstacle : scene.obstacles) {
    if (obstacle.friction > 0) factor = std::max(factor, largest_coefficient / obstacle.friction);
  }
  return factor;
}

/// Segments of the finer of two polygons; the coarser has half of them.
constexpr int finest_segments = 120;

/// Sides of the pyramid that stands for a cone in space; within it, so that cos(pi / 12) of its
/// opening is the least.
constexpr int pyramid_sides = 12;

/// Over the length: points nearer to an obstacle touch it, at least; RMS distances that differ by
/// less are the same; and an equilibrium farther away is none of the shape.
constexpr double touching_gap = 1e-4;
constexpr double same_distance = 1e-6;
constexpr double largest_distance = 0.01;

/// Over the length: of points that are farther from all equilibria it is not known that friction
/// suffices.
constexpr double largest_scatter = 2e-4;

/// A node on an obstacle.
struct Touch {
  Eigen::Index node = 0;
  std::size_t obstacle = 0;
  Eigen::Vector3d normal, along, across;  // `across` not used in a plane
};

std::vector<Touch> touches(const Scene& scene, const HeldPolygon& polygon, double gap) {
  std::vector<Touch> result;
  const Eigen::Matrix3Xd nodes = polygon.nodes();
  for (Eigen::Index node = 0; node < nodes.cols(); ++node) {
    const double at = polygon.arc_lengths()[static_cast<std::size_t>(node)];
    const bool held = std::any_of(
        scene.grippers.begin(), scene.grippers.end(),
        [&](const Gripper& gripper) { return std::abs(gripper.at - at) <= 1e-9 * scene.length; });
    if (held) continue;
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
      const obstacle::Gap here = scene.obstacles[i].body.gap(nodes.col(node));
      if (!(here.value < gap)) continue;
      const Eigen::Vector3d t = polygon.tangent(node);
      const Eigen::Vector3d in_surface = t - here.gradient.dot(t) * here.gradient;
      // A rod that stands on the obstacle has no direction along it.
      const Eigen::Vector3d along =
          in_surface.norm() > 1e-6 ? in_surface.normalized() : here.gradient.unitOrthogonal();
      result.push_back({node, i, here.gradient, along, here.gradient.cross(along)});
    }
  }
  return result;
}

/// Squared distances of a shape from equilibria about a polygon, to first order.
class LinearDistance {
 public:
  LinearDistance(const Scene& scene, const Shape& shape, bool planar)
      : scene_(scene), shape_(shape), planar_(planar) {
    // Trapezoidal, as rms() has it.
    const std::vector<double>& s = shape.arc_length;
    const std::size_t count = s.size();
    weights_.resize(3 * static_cast<Eigen::Index>(count));
    for (std::size_t m = 0; m < count; ++m) {
      const double before = m > 0 ? s[m] - s[m - 1] : 0;
      const double after = m + 1 < count ? s[m + 1] - s[m] : 0;
      const double weight = (before + after) / 2 / (s.back() - s.front());
      weights_.segment<3>(3 * static_cast<Eigen::Index>(m)).setConstant(std::sqrt(weight));
    }
  }

  /// About a polygon whose system is linearised.
  void take(const HeldPolygon& polygon, const std::vector<Touch>& touches) {
    touches_ = touches;
    const std::vector<double>& s = shape_.arc_length;
    const auto motion = [&](const Eigen::VectorXd& step) {
      return Eigen::VectorXd(weights_.cwiseProduct(polygon.motion(s, step)));
    };
    free_ = polygon.free_step();
    const Eigen::Map<const Eigen::VectorXd> wanted(shape_.points.data(), shape_.points.size());
    missing_ = weights_.cwiseProduct(wanted - polygon.points(s)) - motion(free_);
    const auto count = static_cast<Eigen::Index>(touches.size());
    for (std::size_t k = 0; k < 3; ++k) {
      steps_[k].resize(free_.size(), count);
      motions_[k].resize(missing_.size(), count);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const Touch& touch = touches[static_cast<std::size_t>(i)];
      const Eigen::Vector3d axes[] = {touch.normal, touch.along, touch.across};
      for (std::size_t k = 0; k < (planar_ ? 2U : 3U); ++k) {
        steps_[k].col(i) = polygon.response({touch.node, axes[k]});
        motions_[k].col(i) = motion(steps_[k].col(i));
      }
    }
  }

  /// The nearest under forces in cones that are this factor as wide as the scene's.
  struct Nearest {
    double mean_square = 0;
    std::vector<NodeForce> forces;
    Eigen::VectorXd step;
  };
  [[nodiscard]] Nearest nearest(double factor) const {
    std::vector<Eigen::Vector3d> edges;  // of all cones: along the normal, `along`, `across`
    std::vector<std::size_t> of;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const double mu = factor * scene_.obstacles[touches_[i].obstacle].friction;
      const int sides = mu == 0 ? 1 : planar_ ? 2 : pyramid_sides;
      for (int k = 0; k < sides; ++k) {
        const double angle = 2 * std::numbers::pi * k / sides;
        edges.emplace_back(1, mu * std::cos(angle), planar_ ? 0 : mu * std::sin(angle));
        of.push_back(i);
      }
    }
    Eigen::MatrixXd A =
        Eigen::MatrixXd::Zero(missing_.size(), static_cast<Eigen::Index>(of.size()));
    const auto sum = [&](const auto& columns, std::size_t edge) {
      const auto i = static_cast<Eigen::Index>(of[edge]);
      Eigen::VectorXd result =
          edges[edge][0] * columns[0].col(i) + edges[edge][1] * columns[1].col(i);
      if (!planar_) result += edges[edge][2] * columns[2].col(i);
      return result;
    };
    for (std::size_t j = 0; j < of.size(); ++j) {
      A.col(static_cast<Eigen::Index>(j)) = sum(motions_, j);
    }
    const Eigen::VectorXd c = nonnegative_least_squares(A, missing_);
    Nearest result;
    result.mean_square = (A * c - missing_).squaredNorm();
    result.step = free_;
    for (std::size_t j = 0; j < of.size(); ++j) {
      const double size = c[static_cast<Eigen::Index>(j)];
      if (size == 0) continue;
      const Touch& touch = touches_[of[j]];
      result.step += size * sum(steps_, j);
      result.forces.push_back(
          {touch.node, size * (edges[j][0] * touch.normal + edges[j][1] * touch.along +
                               edges[j][2] * touch.across)});
    }
    return result;
  }

 private:
  const Scene& scene_;
  const Shape& shape_;
  bool planar_;
  Eigen::VectorXd weights_;
  std::vector<Touch> touches_;
  Eigen::VectorXd free_, missing_;
  Eigen::MatrixXd steps_[3], motions_[3];
};

/// What one polygon says.
struct Needed {
  bool converged = false;
  bool touches = false;
  double factor = 0, least_factor = 0, mean_square = 0;
};

/// The least factor with which the mean square distance is no larger.
double least_with(const LinearDistance& distance, double mean_square, double most) {
  if (distance.nearest(0).mean_square <= mean_square) return 0;
  double low = 0;
  double high = most;
  for (int i = 0; i < 16; ++i) {
    const double middle = (low + high) / 2;
    (distance.nearest(middle).mean_square <= mean_square ? high : low) = middle;
  }
  return high;
}

/// Between the points of the shape, and on past them as it ends.
Eigen::Matrix3Xd points_at(const std::vector<double>& at, const Shape& shape) {
  const std::vector<double>& s = shape.arc_length;
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(at.size()));
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto after = std::upper_bound(s.begin() + 1, s.end() - 1, at[i]);
    const auto m = static_cast<Eigen::Index>(after - s.begin());
    const auto right = static_cast<std::size_t>(m);
    const double share = (at[i] - s[right - 1]) / (s[right] - s[right - 1]);
    result.col(static_cast<Eigen::Index>(i)) =
        (1 - share) * shape.points.col(m - 1) + share * shape.points.col(m);
  }
  return result;
}

Needed needed(const Scene& scene, const Shape& shape, int segments,
              const std::optional<Eigen::Vector3d>& normal) {
  HeldPolygon polygon(scene, segments, normal);
  polygon.lay_along(points_at(polygon.arc_lengths(), shape));
  LinearDistance distance(scene, shape, normal.has_value());
  const double same = same_distance * scene.length;
  const double most = any_friction(scene);
  Needed result;
  double gap = 10 * touching_gap * scene.length;
  std::vector<NodeForce> forces;
  for (const bool first : {true, false}) {
    const std::vector<Touch> touching = touches(scene, polygon, gap);
    result.touches = std::any_of(touching.begin(), touching.end(), [&](const Touch& touch) {
      return scene.obstacles[touch.obstacle].friction > 0;
    });
    if (!result.touches) return result;
    // The forces of equal shapes are many, and one or another comes out; the shape converges.
    constexpr double small_turn = 0.01;  // [rad]; its square is what a step leaves
    result.converged = false;
    // A system that does not know the forces yet would lead away from the shape.
    constexpr int stays = 4;
    for (int i = 0; i < 30 && !result.converged; ++i) {
      polygon.linearise(forces);
      distance.take(polygon, touching);
      LinearDistance::Nearest nearest = distance.nearest(most);
      forces = std::move(nearest.forces);
      if (first && i < stays) {
        polygon.take_pulls(nearest.step);
        continue;
      }
      const double turned = polygon.move(nearest.step);
      if (!std::isfinite(turned)) return result;
      const double change =
          std::abs(std::sqrt(nearest.mean_square) - std::sqrt(result.mean_square));
      result.converged =
          turned < small_turn && change < 0.02 * std::sqrt(nearest.mean_square) + same;
      result.mean_square = nearest.mean_square;
    }
    if (!result.converged) return result;
    if (first) gap = std::max(gap / 10, 3 * std::sqrt(result.mean_square));
  }
  polygon.linearise(forces);
  distance.take(polygon, touches(scene, polygon, gap));
  const double floor = distance.nearest(most).mean_square;
  const auto points = static_cast<double>(shape.arc_length.size());
  // Eight more of the squares' variance, that of a point in space, is a little more than chance.
  result.factor = least_with(distance, floor * (1 + 8 / (3 * points)) + same * same, most);
  result.least_factor = least_with(distance, 2 * floor + same * same, most);
  return result;
}

/// Why a scene or a shape is not looked at; empty: it is.
std::string refusal(const Scene& scene, const ShapeCheck& check) {
  if (check.alignment.arc_lengths == ArcLengths::nearest) {
    return "arc lengths are those of the nearest points, which hide what friction does along the "
           "rod";
  }
  const RigidMotion& pose = check.alignment.pose;
  if (!pose.rotation.isIdentity() || !pose.translation.isZero()) {
    return "the file's frame was found by laying it on a shape without friction";
  }
  if (scene.has_material_directors())
    return "the rod has axes of its own, which this does not know";
  if (scene.holds_twist()) return "the grippers hold the rod's twist, which this does not know";
  const bool yields =
      std::any_of(scene.obstacles.begin(), scene.obstacles.end(),
                  [](const Obstacle& obstacle) { return std::isfinite(obstacle.stiffness); });
  if (yields)
    return "an obstacle yields, and where it holds the rod is not identifiable from the shape";
  constexpr std::size_t least_points = 8;
  if (check.alignment.shape.arc_length.size() < least_points) {
    return fmt::format("fewer than {} points", least_points);
  }
  return {};
}

/// The normal of the scene's plane if the shape lies in it: a frictionless floor lets a rod turn
/// out of its plane, and friction may hold it there.
std::optional<Eigen::Vector3d> shared_plane(const Scene& scene, const Shape& shape) {
  std::optional<Eigen::Vector3d> normal = scene.plane_normal();
  if (!normal) return normal;
  const Eigen::Vector3d grip = scene.grippers.front().position;
  const double off = (normal->transpose() * (shape.points.colwise() - grip)).cwiseAbs().maxCoeff();
  if (!(off <= same_distance * scene.length)) normal.reset();
  return normal;
}

/// Of all obstacles in reach that have friction; none where they have several.
std::optional<double> only_coefficient(const Scene& scene) {
  std::optional<double> mu;
  for (const std::size_t i : obstacles_in_reach(scene)) {
    const double own = scene.obstacles[i].friction;
    if (own == 0) continue;
    if (mu && *mu != own) return std::nullopt;
    mu = own;
  }
  return mu;
}

}  // namespace

FrictionCheck check_friction(const Scene& scene, const ShapeCheck& check) {
  FrictionCheck result;
  result.reason = refusal(scene, check);
  if (!result.reason.empty()) return result;
  const Shape& shape = check.alignment.shape;
  const std::optional<Eigen::Vector3d> normal = shared_plane(scene, shape);
  const Needed coarse = needed(scene, shape, finest_segments / 2, normal);
  const Needed fine = needed(scene, shape, finest_segments, normal);
  if (!fine.touches) {
    result.reason = "the shape touches no obstacle that has friction";
    return result;
  }
  if (!coarse.converged || !fine.converged) {
    result.reason = "no equilibrium next to the shape was found";
    return result;
  }
  result.rms_m = std::sqrt(fine.mean_square);
  if (!(result.rms_m <= largest_distance * scene.length)) {
    result.reason = fmt::format(
        "no friction holds it: the nearest equilibrium under any is {:.3g} mm away (RMS)",
        result.rms_m * 1e3);
    return result;
  }
  // Second order in the segments' length.
  const auto limit = [](double at_half, double at_all) {
    return std::max(0.0, at_all + (at_all - at_half) / 3);
  };
  result.factor = limit(coarse.factor, fine.factor);
  result.least_factor = std::min(limit(coarse.least_factor, fine.least_factor), result.factor);
  result.factor_error = std::max(std::abs(fine.factor - coarse.factor),
                                 std::abs(fine.least_factor - coarse.least_factor)) /
                        3;
  if (!normal) {
    result.factor_error += result.factor * (1 / std::cos(std::numbers::pi / pyramid_sides) - 1);
  }
  if (const std::optional<double> mu = only_coefficient(scene)) {
    result.coefficient = result.factor * *mu;
  }
  // What the scatter may hide is as much again as what it leaves open below.
  const double most_needed = 2 * result.factor - result.least_factor + result.factor_error;
  const bool scattered = result.rms_m > largest_scatter * scene.length;
  if (scattered && result.least_factor - result.factor_error <= 1) {
    result.reason =
        fmt::format("a scatter of {:.2g} mm (RMS) may hide what friction does", result.rms_m * 1e3);
  } else if (coarse.factor == 0 && fine.factor == 0) {
    result.verdict = FrictionVerdict::none_needed;
  } else if (most_needed <= 1) {
    result.verdict = FrictionVerdict::inside;
  } else if (result.least_factor - result.factor_error > 1) {
    result.verdict = FrictionVerdict::outside;
  } else {
    result.reason = "scatter of the points and the polygon's segments leave it open";
  }
  return result;
}

}  // namespace dlo::compare
