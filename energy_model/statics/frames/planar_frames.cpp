#include "frames/planar_frames.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/legendre.hpp"
#include "linear/dense_products.hpp"

namespace dlo::energy_model {
namespace {

bool is_same(const Element& a, const Element& b) {
  return a.begin == b.begin && a.length == b.length && a.stiffness == b.stiffness;
}

}  // namespace

double angle_of(const Eigen::Vector3d& direction) {
  return std::atan2(direction.y(), direction.x());
}

double nearest_equivalent_angle(double angle, double target) {
  constexpr double turn = 2 * std::numbers::pi;
  return angle + turn * std::round((target - angle) / turn);
}

void dot_in_plane(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b, Eigen::VectorXd& result) {
  result = a.col(0).cwiseProduct(b.col(0)) + a.col(1).cwiseProduct(b.col(1));
}

void PlanarFrames::reset(const std::vector<Element>& elements, int terms,
                         std::optional<double> start_theta, const NaturalStrains& natural) {
  const Eigen::Index free_start = start_theta ? 0 : 1;
  // The derivatives of the angles by the unknowns depend only on these values.
  const bool has_angles =
      angle_.size() > 0 && terms == terms_ && free_start == free_start_ &&
      std::equal(elements.begin(), elements.end(), elements_.begin(), elements_.end(), is_same);
  start_theta_ = start_theta.value_or(0);
  natural_ = natural;
  if (!has_angles) {
    elements_ = elements;
    terms_ = terms;
    free_start_ = free_start;
    table_ = &legendre_table(terms);
    const Eigen::Index nodes = table_->nodes.size();
    const Eigen::Index count = std::ssize(elements_);
    angle_.setZero(count * nodes, free_start_ + count * terms_);
    if (free_start_ == 1) angle_.col(0).setOnes();
    for (Eigen::Index e = 0; e < count; ++e) {
      const Eigen::Index column = free_start_ + e * terms_;
      angle_.block(e * nodes, column, nodes, terms_) =
          element_rotation(e) * table_->integrals.leftCols(terms_);
      // Only p_0 contributes to the rotation over a whole element.
      angle_.col(column).tail((count - e - 1) * nodes).setConstant(element_rotation(e));
    }
    angle_transposed_ = angle_.transpose();
  }
  natural_angle_.resize(0);
  if (natural.empty()) return;
  const Eigen::Index Q = table_->nodes.size();
  natural_angle_.resize(angle_.rows());
  for (Eigen::Index q = 0; q < angle_.rows(); ++q) {
    const Element& element = elements_[static_cast<std::size_t>(q / Q)];
    natural_angle_[q] = natural.integral(element.begin + element.length * table_->nodes[q % Q]).x();
  }
}

Eigen::RowVectorXd PlanarFrames::angle_derivatives_after(Eigen::Index element) const {
  Eigen::RowVectorXd result = Eigen::RowVectorXd::Zero(angle_.cols());
  if (free_start_ == 1) result[0] = 1;
  for (Eigen::Index e = 0; e <= element; ++e)
    result[free_start_ + e * terms_] = element_rotation(e);
  return result;
}

double PlanarFrames::angle_towards(const Eigen::Vector3d& direction, Eigen::Index element) const {
  const double angle = nearest_equivalent_angle(angle_of(direction), start_theta_);
  if (natural_.empty()) return angle;
  return angle - natural_.integral(elements_[static_cast<std::size_t>(element)].end()).x();
}

void PlanarFrames::resize(State& state) const {
  const Eigen::Index nodes = angle_.rows();
  for (Eigen::VectorXd* v : {&state.theta, &state.turning, &state.curvature}) v->resize(nodes);
  state.t_theta.setZero(nodes, 3);
  state.by_unknown.resize(angle_.cols());
  state.beside.resize(terms_);
  state.scaled.resize(terms_, table_->nodes.size());
  state.own.resize(terms_, terms_);
}

void PlanarFrames::evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::MatrixX3d& tangents,
                            State& state) const {
  multiply(angle_, x, state.theta);
  state.theta.array() += start_theta_;
  if (natural_angle_.size() > 0) state.theta += natural_angle_;
  dense_kernel().turn(state.theta.data(), state.theta.size(), tangents.col(0).data(),
                      tangents.col(1).data());
  state.t_theta.col(0) = -tangents.col(1);
  state.t_theta.col(1) = tangents.col(0);
}

void PlanarFrames::adjoint(const Eigen::MatrixX3d& nodes, State& state) const {
  dot_in_plane(nodes, state.t_theta, state.turning);
  multiply(angle_transposed_, state.turning, state.by_unknown);
}

void PlanarFrames::adjoint(const Eigen::Ref<const Eigen::VectorXd>& weights, Eigen::Index axis,
                           State& state) const {
  state.turning = state.t_theta.col(axis).cwiseProduct(weights);
  multiply(angle_transposed_, state.turning, state.by_unknown);
}

/// Uses that an unknown beyond its own element rotates the rod as a whole, if it is the first of
/// its element or the start's angle, and otherwise has no effect there.
void PlanarFrames::add_hessian(const Eigen::VectorXd& along, State& state,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const {
  const Eigen::Index Q = table_->nodes.size();
  const Eigen::Index K = terms_;
  double later = 0;
  for (Eigen::Index e = std::ssize(elements_); e-- > 0;) {
    const auto here = along.segment(e * Q, Q);
    const double own_turn = element_rotation(e);
    const Eigen::Index column = free_start_ + e * K;
    const auto angle = angle_transposed_.block(column, e * Q, K, Q);
    state.scaled = angle * here.asDiagonal();
    multiply_symmetric(angle, state.scaled, state.own);
    hessian.block(column, column, K, K) += state.own;
    hessian(column, column) += own_turn * own_turn * later;
    if (column > 0) multiply(angle, here, state.beside);
    state.beside[0] += own_turn * later;
    for (Eigen::Index before = -free_start_; before < e; ++before) {
      const bool start = before < 0;
      const double turn = start ? 1 : element_rotation(before);
      const Eigen::Index row = start ? 0 : free_start_ + before * K;
      hessian.row(row).segment(column, K) += turn * state.beside.transpose();
      hessian.col(row).segment(column, K) += turn * state.beside;
    }
    later += here.sum();
  }
  if (free_start_ == 1) hessian(0, 0) += later;
}

std::array<Eigen::MatrixXd, 3> PlanarFrames::tangent_jacobian(const State& state) const {
  return {state.t_theta.col(0).asDiagonal() * angle_, state.t_theta.col(1).asDiagonal() * angle_,
          Eigen::MatrixXd::Zero(angle_.rows(), angle_.cols())};
}

void PlanarFrames::subtract_bending(const Eigen::VectorXd& x, const Eigen::VectorXd& weights,
                                    State& state, Eigen::VectorXd& along) const {
  const Eigen::Index Q = table_->nodes.size();
  for (Eigen::Index e = 0; e < std::ssize(elements_); ++e) {
    const Element& element = elements_[static_cast<std::size_t>(e)];
    auto u = state.curvature.segment(e * Q, Q);
    multiply(table_->values.leftCols(terms_), x.segment(free_start_ + e * terms_, terms_), u);
    u *= element.strain(0);
    along.segment(e * Q, Q).array() -=
        element.stiffness[0] * weights.segment(e * Q, Q).array() * u.array().square();
  }
}

Eigen::VectorXd PlanarFrames::angles(const Eigen::Matrix3Xd& tangents) const {
  Eigen::VectorXd angles(tangents.cols());
  double previous = free_start_ == 1 ? angle_of(tangents.col(0)) : start_theta_;
  for (Eigen::Index q = 0; q < angles.size(); ++q) {
    angles[q] = previous = nearest_equivalent_angle(angle_of(tangents.col(q)), previous);
  }
  if (natural_angle_.size() > 0) angles -= natural_angle_;
  return angles;
}

Eigen::VectorXd PlanarFrames::fit(const Eigen::VectorXd& angles) const {
  std::vector<double> turns;
  turns.reserve(elements_.size());
  for (const Element& element : elements_) turns.push_back(element.angle(0));
  std::optional<double> start;
  if (free_start_ == 0) start = start_theta_;
  const FittedAngle fitted = fit_angle(*table_, turns, angles, start);
  Eigen::VectorXd x(angle_.cols());
  if (free_start_ == 1) x[0] = fitted.start;
  x.tail(fitted.coefficients.size()) = fitted.coefficients;
  return x;
}

}  // namespace dlo::energy_model
