#include "polygon/polygon_response.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

Eigen::Matrix<double, 3, 2> two_normals(const Eigen::Vector3d& axis) {
  Eigen::Matrix<double, 3, 2> result;
  result.col(0) = axis.unitOrthogonal();
  result.col(1) = axis.cross(result.col(0));
  return result;
}

/// Derivatives of a hooke joint's potential -2 (EI/L) ln((1 + u.v)/2).
struct JointDerivatives {
  double slope;      // derivative by u.v, negated: 2 (EI/L) / (1 + u.v)
  double curvature;  // second derivative by u.v: 2 (EI/L) / (1 + u.v)^2
};

JointDerivatives joint_derivatives(double stiffness, const Eigen::Vector3d& u,
                                   const Eigen::Vector3d& v) {
  const double sum = 1 + u.dot(v);
  return {2 * stiffness / sum, 2 * stiffness / (sum * sum)};
}

}  // namespace

std::optional<Discretisation> hooke_polygon(const Scene& scene, int points) {
  ForceModelSettings settings;
  settings.points = points;
  settings.bookkeeping = scene.force_model.bookkeeping;
  settings.point_weight = scene.force_model.point_weight;
  try {
    return discretise(scene, settings);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

bool touches_obstacle(const energy_model::Equilibrium& rod) {
  return std::ranges::any_of(rod.obstacles,
                             [](const Eigen::Vector3d& force) { return force.norm() > 0; });
}

std::string why_no_polygon(const Scene& scene) {
  const auto holds_frame = [](const Gripper& gripper) { return gripper.frame.has_value(); };
  const auto frames = std::ranges::count_if(scene.grippers, holds_frame);
  if (frames > 1) return "the polygon of the response has no twist";
  if (scene.naturally_bent()) return "the polygon of the response is intrinsically straight";
  if (scene.has_two_stiffnesses()) return "the polygon of the response is round";
  if (scene.has_couples()) return "the polygon of the response has no couples";
  if (!scene.sections.empty()) return "the polygon of the response has one section";
  return {};
}

PolygonResponse::PolygonResponse(const Scene& scene, const Discretisation& discretisation,
                                 const energy_model::Equilibrium& rod)
    : scene_(scene), polygon_(discretisation), n_(discretisation.rod.rest_lengths.size()) {
  held_.assign(static_cast<std::size_t>(n_), false);
  for (const force_model::Grip& grip : polygon_.rod.grips) {
    grips_.push_back(&grip);
    if (grip.targets.cols() == 2) held_[static_cast<std::size_t>(grip.first_point)] = true;
  }
  std::ranges::sort(grips_, {}, &force_model::Grip::first_point);
  const std::vector<double>& s = polygon_.arc_length;
  std::vector<double> points;
  std::vector<double> middles;
  for (std::size_t i = 0; i < s.size(); ++i) {
    points.push_back(std::clamp(s[i], 0.0, scene.length));
    if (i > 0) middles.push_back(std::clamp((s[i - 1] + s[i]) / 2, 0.0, scene.length));
  }
  rod_points_ = rod.sample(points).points;
  tangents_ = rod.sample(middles).tangents;
  for (const force_model::Grip& grip : polygon_.rod.grips) {
    if (grip.targets.cols() < 2) continue;
    tangents_.col(grip.first_point) = (grip.targets.col(1) - grip.targets.col(0)).normalized();
  }
  for (Eigen::Index i = 0; i < n_; ++i) across_.push_back(two_normals(tangents_.col(i)));
  find_forces(rod);
}

/// Computes the forces n_i from the loads on the polygon: from the free ends inwards, and between
/// grips from the force that remains after the grips' reactions. An error of a reaction would only
/// change the multipliers of the constraints.
void PolygonResponse::find_forces(const energy_model::Equilibrium& rod) {
  forces_.setZero(3, n_);
  const Eigen::Matrix3Xd& loads = polygon_.rod.loads;
  const Eigen::Index first = grips_.front()->first_point;
  const auto last_point = [](const force_model::Grip* grip) {
    return grip->first_point + grip->targets.cols() - 1;
  };
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < first; ++i) forces_.col(i) = force -= loads.col(i);
  force.setZero();
  for (Eigen::Index i = n_; i > last_point(grips_.back()); --i) {
    forces_.col(i - 1) = force += loads.col(i);
  }
  for (std::size_t k = 0; k + 1 < grips_.size(); ++k) {
    const Eigen::Index begin = last_point(grips_[k]);
    const double s = (polygon_.arc_length[static_cast<std::size_t>(begin)] +
                      polygon_.arc_length[static_cast<std::size_t>(begin) + 1]) /
                     2;
    force = -scene_.weight_per_length() * s - scene_.distributed_between(0, s);
    for (const PointLoad& load : scene_.loads) {
      if (load.at <= s) force -= load.force;
    }
    for (std::size_t j = 0; j <= k; ++j) {
      force -= rod.grips[static_cast<std::size_t>(grips_[j] - polygon_.rod.grips.data())].force;
    }
    for (Eigen::Index i = begin; i < grips_[k + 1]->first_point; ++i) {
      if (i > begin) force -= loads.col(i);
      forces_.col(i) = force;
    }
  }
}

Eigen::Index PolygonResponse::constraints() const {
  return 3 * (static_cast<Eigen::Index>(grips_.size()) - 1);
}

Eigen::SparseMatrix<double> PolygonResponse::matrix(double joints) const {
  const Eigen::VectorXd& L = polygon_.rod.rest_lengths;
  const Eigen::Index size = 2 * n_ + constraints();
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& block) {
    for (Eigen::Index i = 0; i < block.rows(); ++i) {
      for (Eigen::Index j = 0; j < block.cols(); ++j) {
        entries.emplace_back(static_cast<int>(row + i), static_cast<int>(column + j), block(i, j));
      }
    }
  };
  const auto is_held = [&](Eigen::Index i) { return held_[static_cast<std::size_t>(i)]; };
  const auto across = [&](Eigen::Index i) -> const Eigen::Matrix<double, 3, 2>& {
    return across_[static_cast<std::size_t>(i)];
  };
  for (Eigen::Index i = 0; i < n_; ++i) {
    double diagonal = is_held(i) ? 1 : L[i] * forces_.col(i).dot(tangents_.col(i));
    for (const Eigen::Index other : {i - 1, i + 1}) {
      if (other < 0 || other >= n_ || is_held(i)) continue;
      const Eigen::Vector3d u = tangents_.col(i);
      const Eigen::Vector3d v = tangents_.col(other);
      const JointDerivatives joint =
          joint_derivatives(2 * joints * scene_.bending_stiffness() / (L[i] + L[other]), u, v);
      diagonal += joint.slope * u.dot(v);
      const Eigen::Vector2d gu = across(i).transpose() * v;
      const Eigen::Vector2d gv = across(other).transpose() * u;
      add(2 * i, 2 * i, joint.curvature * gu * gu.transpose());
      if (is_held(other)) continue;
      add(2 * i, 2 * other,
          joint.curvature * gu * gv.transpose() -
              joint.slope * across(i).transpose() * across(other));
    }
    add(2 * i, 2 * i, diagonal * Eigen::Matrix2d::Identity());
  }
  for (std::size_t k = 0; k + 1 < grips_.size(); ++k) {
    const Eigen::Index row = 2 * n_ + 3 * static_cast<Eigen::Index>(k);
    for (Eigen::Index i = grips_[k]->first_point; i < grips_[k + 1]->first_point; ++i) {
      if (is_held(i)) continue;
      // Scaled by EI, so that all entries have the same magnitude.
      const Eigen::MatrixXd block = L[i] * scene_.bending_stiffness() * across(i);
      add(row, 2 * i, block);
      add(2 * i, row, block.transpose());
    }
  }
  Eigen::SparseMatrix<double> result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

bool PolygonResponse::is_positive(const Eigen::SparseMatrix<double>& matrix) const {
  // The constraints come last, so that no pivot is a zero of the constraint block.
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower,
                              Eigen::NaturalOrdering<int>>
      factors(matrix);
  if (factors.info() != Eigen::Success) return false;
  const Eigen::VectorXd pivots = factors.vectorD();
  return pivots.allFinite() && (pivots.array() < 0).count() == constraints() &&
         (pivots.array() == 0).count() == 0;
}

std::optional<PolygonResponse::Response> PolygonResponse::turns(
    const Eigen::Matrix3Xd& f, const Eigen::Matrix3Xd& gaps) const {
  constexpr double reduced_stiffness_factor = 0.95;
  const Eigen::SparseMatrix<double> bordered = matrix(1);
  if (!is_positive(bordered) || !is_positive(matrix(reduced_stiffness_factor))) {
    return std::nullopt;
  }
  Eigen::VectorXd right = Eigen::VectorXd::Zero(bordered.rows());
  for (Eigen::Index i = 0; i < n_; ++i) {
    if (held_[static_cast<std::size_t>(i)]) continue;
    right.segment<2>(2 * i) = across_[static_cast<std::size_t>(i)].transpose() * f.col(i);
  }
  for (Eigen::Index k = 0; k < gaps.cols(); ++k) {
    right.segment<3>(2 * n_ + 3 * k) = scene_.bending_stiffness() * gaps.col(k);
  }
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> factors(bordered);
  if (factors.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd solution = factors.solve(right);
  if (!solution.allFinite()) return std::nullopt;
  // A nearly singular matrix gives a solution that does not satisfy its equations.
  if ((bordered * solution - right).norm() > 1e-6 * right.norm()) return std::nullopt;
  Response result;
  result.dt.resize(3, n_);
  for (Eigen::Index i = 0; i < n_; ++i) {
    result.dt.col(i) = across_[static_cast<std::size_t>(i)] * solution.segment<2>(2 * i);
  }
  // H dt - f = L dn across the tangents; the multipliers are -dn / EI.
  // Beyond the grips only the loads act, which do not change.
  result.dn.setZero(3, n_);
  for (std::size_t k = 0; k + 1 < grips_.size(); ++k) {
    const Eigen::Index begin = grips_[k]->first_point;
    result.dn.middleCols(begin, grips_[k + 1]->first_point - begin).colwise() =
        Eigen::Vector3d(-scene_.bending_stiffness() *
                        solution.segment<3>(2 * n_ + 3 * static_cast<Eigen::Index>(k)));
  }
  return result;
}

Eigen::Matrix3Xd PolygonResponse::sums_between_grips(const Eigen::Matrix3Xd& steps) const {
  Eigen::Matrix3Xd sums(3, constraints() / 3);
  for (std::size_t k = 0; k + 1 < grips_.size(); ++k) {
    const Eigen::Index begin = grips_[k]->first_point;
    sums.col(static_cast<Eigen::Index>(k)) =
        steps.middleCols(begin, grips_[k + 1]->first_point - begin).rowwise().sum();
  }
  return sums;
}

Eigen::Matrix3Xd PolygonResponse::points_along(const Eigen::Vector3d& start,
                                               const Eigen::Matrix3Xd& steps) const {
  const Eigen::Index first = grips_.front()->first_point;
  Eigen::Matrix3Xd points(3, n_ + 1);
  points.col(first) = start;
  for (Eigen::Index i = first; i < n_; ++i) points.col(i + 1) = points.col(i) + steps.col(i);
  for (Eigen::Index i = first; i > 0; --i) points.col(i - 1) = points.col(i) - steps.col(i - 1);
  return points;
}

double PolygonResponse::displacement_rms(const Eigen::Matrix3Xd& movement) const {
  // Points inside end grippers do not belong to the rod, whose ends there do not move.
  const Shape moved = polygon_.shape(rod_points_ + movement);
  return rms(moved.arc_length, moved.points - rod_points_);
}

PolygonResponse::Response PolygonResponse::response_to(const Eigen::Matrix3Xd& f,
                                                       const Eigen::Matrix3Xd& eta) const {
  const Eigen::RowVectorXd L = polygon_.rod.rest_lengths.transpose();
  Eigen::Matrix3Xd steps = eta * L.asDiagonal();
  for (Eigen::Index i = 0; i < n_; ++i) {
    if (held_[static_cast<std::size_t>(i)]) steps.col(i).setZero();
  }
  std::optional<Response> response = turns(f, -sums_between_grips(steps));
  if (!response) return {};
  steps += response->dt * L.asDiagonal();
  response->displacement_m = displacement_rms(points_along(Eigen::Vector3d::Zero(), steps));
  return *std::move(response);
}

StretchResponse PolygonResponse::stretch(double stiffness) const {
  Eigen::Matrix3Xd f(3, n_);
  Eigen::Matrix3Xd eta(3, n_);
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double strain = forces_.col(i).dot(tangents_.col(i)) / stiffness;
    eta.col(i) = strain * tangents_.col(i);
    f.col(i) = polygon_.rod.rest_lengths[i] * strain * forces_.col(i);
  }
  const Response answer = response_to(f, eta);
  StretchResponse result{answer.displacement_m, std::numeric_limits<double>::quiet_NaN()};
  if (!std::isfinite(answer.displacement_m)) return result;
  double largest = 0;
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double tension = forces_.col(i).dot(tangents_.col(i));
    if (!(std::abs(tension) > std::abs(largest))) continue;
    largest = tension;
    const double change =
        answer.dn.col(i).dot(tangents_.col(i)) + forces_.col(i).dot(answer.dt.col(i));
    result.tension = change / tension;
  }
  return result;
}

double PolygonResponse::shear(double stiffness) const {
  Eigen::Matrix3Xd f(3, n_);
  Eigen::Matrix3Xd eta(3, n_);
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double tension = forces_.col(i).dot(tangents_.col(i));
    eta.col(i) = (forces_.col(i) - tension * tangents_.col(i)) / stiffness;
    f.col(i) = -polygon_.rod.rest_lengths[i] * tension * eta.col(i);
  }
  return response_to(f, eta).displacement_m;
}

double PolygonResponse::discretisation() const {
  const Eigen::VectorXd& L = polygon_.rod.rest_lengths;
  Eigen::Matrix3Xd f = forces_ * L.asDiagonal();
  for (Eigen::Index i = 0; i + 1 < n_; ++i) {
    const Eigen::Vector3d u = tangents_.col(i);
    const Eigen::Vector3d v = tangents_.col(i + 1);
    const double slope =
        joint_derivatives(2 * scene_.bending_stiffness() / (L[i] + L[i + 1]), u, v).slope;
    f.col(i) += slope * v;
    f.col(i + 1) += slope * u;
  }
  Eigen::Matrix3Xd steps = tangents_ * L.asDiagonal();
  Eigen::Matrix3Xd gaps = -sums_between_grips(steps);
  for (std::size_t k = 0; k + 1 < grips_.size(); ++k) {
    gaps.col(static_cast<Eigen::Index>(k)) +=
        grips_[k + 1]->targets.col(0) - grips_[k]->targets.col(0);
  }
  const std::optional<Response> turned = turns(f, gaps);
  if (!turned) return std::numeric_limits<double>::infinity();
  steps += turned->dt * L.asDiagonal();
  const Eigen::Vector3d start = grips_.front()->targets.col(0);
  return displacement_rms(points_along(start, steps) - rod_points_);
}

double bound_of_response(double response, double length) {
  constexpr double bound_factor = 2;
  constexpr double largest_response = 0.03;
  return response <= largest_response * length ? bound_factor * response
                                               : std::numeric_limits<double>::infinity();
}

double polygon_bound(const Scene& scene, const Discretisation& polygon,
                     const energy_model::Equilibrium& rod) {
  return bound_of_response(PolygonResponse(scene, polygon, rod).discretisation(), scene.length);
}

}  // namespace dlo::compare
