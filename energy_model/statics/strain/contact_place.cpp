#include "strain/contact_place.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/legendre.hpp"

namespace dlo::energy_model {
namespace {

/// Number of coefficients of the force on a short element.
constexpr Eigen::Index force_terms_of_short_part = 4;
constexpr int pressure_samples = 32;  // number of samples of the pressure on an element

/// Evaluates a series in orthonormal Legendre polynomials at xi.
double series(const Eigen::Ref<const Eigen::VectorXd>& coefficients, double xi) {
  Eigen::VectorXd values(coefficients.size());
  Eigen::VectorXd integrals(coefficients.size());
  legendre(xi, values, integrals);
  return values.dot(coefficients);
}

/// Updates the extreme pressures with an element's pressure, minus the derivative of its force.
/// @param smooth  coefficients of the force without the last ones, which are inaccurate in the
///   derivative
/// @param first  whether no earlier element has contributed
void add_pressure(const Eigen::VectorXd& smooth, double length, bool first, ContactForce& force) {
  double last = series(smooth, 0);
  for (int k = 1; k <= pressure_samples; ++k) {
    const double next = series(smooth, static_cast<double>(k) / pressure_samples);
    const double pressure = (last - next) * pressure_samples / length;
    const bool is_first = first && k == 1;
    force.least_pressure = is_first ? pressure : std::min(force.least_pressure, pressure);
    force.largest_pressure = is_first ? pressure : std::max(force.largest_pressure, pressure);
    last = next;
  }
}

}  // namespace

Eigen::MatrixXd ContactEvaluation::along(const Eigen::MatrixX3d& vectors) const {
  Eigen::MatrixXd result = vectors.col(0).asDiagonal() * by_tangent[0];
  result += vectors.col(1).asDiagonal() * by_tangent[1];
  result += vectors.col(2).asDiagonal() * by_tangent[2];
  return result;
}

void ContactEvaluation::add(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                            Eigen::MatrixX3d& carried) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    carried.col(static_cast<Eigen::Index>(axis)).noalias() += by_tangent[axis] * multipliers;
  }
}

Eigen::Vector3d moment_about_anchor(const Eigen::MatrixX3d& tangents,
                                    const Eigen::MatrixX3d& carried) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index q = 0; q < tangents.rows(); ++q) {
    moment += Eigen::Vector3d(tangents.row(q)).cross(Eigen::Vector3d(carried.row(q)));
  }
  return moment;
}

ContactForce force_of_series(const ContactSeries& rows, const Eigen::VectorXd& multipliers) {
  ContactForce force;
  double before = rows.clearance < 0 ? 0 : multipliers[rows.clearance];
  if (rows.held_at_begin && !rows.slopes.empty()) {
    // The concentrated force there belongs to the grip.
    const ContactSeries::Slope& slope = rows.slopes.front();
    before = series(multipliers.segment(slope.first, slope.count) / slope.length, 0);
    force.held_begin = -before;
  }
  force.total = force.begin = before;
  for (std::size_t i = 0; i < rows.slopes.size(); ++i) {
    const ContactSeries::Slope& slope = rows.slopes[i];
    const bool is_short = slope.length < short_part;
    const Eigen::Index known =
        is_short ? std::min(slope.count, force_terms_of_short_part) : slope.count;
    const Eigen::VectorXd carried = multipliers.segment(slope.first, known) / slope.length;
    const double here = series(carried, 0);
    if (i == 0) {
      force.begin = before - here;
    } else if (slope.may_concentrate_force) {
      force.least_inner_force = std::min(force.least_inner_force, before - here);
    }
    force.end = before = series(carried, 1);
    add_pressure(carried.head(is_short ? 2 : (slope.count + 1) / 2), slope.length, i == 0, force);
  }
  if (rows.held_at_end && !rows.slopes.empty()) {
    const ContactSeries::Slope& slope = rows.slopes.back();
    force.held_end = series(multipliers.segment(slope.first, slope.count) / slope.length, 1);
    force.total -= force.held_end;
    force.end = 0;
  }
  return force;
}

Eigen::VectorXd ContactSeries::own(const Eigen::VectorXd& multipliers) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(multipliers.size());
  if (clearance >= 0) result[clearance] = multipliers[clearance];
  for (const Slope& slope : slopes) {
    result.segment(slope.first, slope.count) = multipliers.segment(slope.first, slope.count);
  }
  return result;
}

}  // namespace dlo::energy_model
