#include "dynamics/span_dynamics.hpp"

#include <Eigen/Geometry>
#include <array>
#include <utility>

#include "base/legendre.hpp"
#include "base/spin.hpp"
#include "vibration/span_modes.hpp"

namespace dlo::energy_model {
namespace {

/// Time in which twist follows the rotation of the ends, divided by the bending time m^(1/2) (l /
/// EI)^(1/2) l. A torsional wave crosses a round rod in about 0.4 d / l of that time. The
/// constant is smaller than that if l < 4000 d. Twist is in equilibrium with an error of the order
/// of the constant's square.
constexpr double twist_relaxation_time = 1e-4;

}  // namespace

VectorMotion rotating_vector(const Eigen::Vector3d& vector, const Eigen::Vector3d& spin,
                             const Eigen::Vector3d& spin_rate) {
  const Eigen::Vector3d rate = spin.cross(vector);
  return {vector, rate, spin_rate.cross(vector) + spin.cross(rate)};
}

SpanDynamics::SpanDynamics(Span span, int terms, const Eigen::Vector3d& first, SpanInertia inertia,
                           const ContactLaw& contact)
    : span_(std::move(span)),
      terms_(terms),
      inertia_(std::move(inertia)),
      nodes_(span_, elements_of(span_), director_table(terms)),
      points_(nodes_),
      grid_(span_.rigid_obstacles, nodes_, contact),
      axes_(span_.planar ? 2 : 3) {
  // In the plane d1 is normal to it, so that the first strain bends the rod within the plane.
  const Eigen::Vector3d tangent = span_.start_direction.value_or(first).normalized();
  start_frame_ = frame_along(tangent, span_.first_d1(tangent));
  const bool free_start = !span_.start_direction;
  frames_.reset(nodes_.elements(), terms_, start_frame_, free_start, span_.natural);
  frames_.resize(state_);
  const Eigen::Index fields = span_.planar ? 1 : frames_.fields();
  elastic_ = Eigen::VectorXd::Ones(fields * frames_.columns());
  if (fields > 2) {
    twist_inertia_ = Eigen::VectorXd::Zero(elastic_.size());
    twist_inertia_.tail(frames_.columns())
        .setConstant(twist_relaxation_time * twist_relaxation_time);
  }
  if (free_start) elastic_(Eigen::seq(0, Eigen::last, frames_.columns())).setZero();
  const std::vector<Element>& elements = nodes_.elements();
  const auto point_at = [&](double s) { return points_.begin(elements_before(elements, s)); };
  for (const Span::Hold& hold : span_.holds) {
    grip_points_.push_back(point_at(hold.at));
    signs_.push_back(nodes_.signs(hold.at));
  }
  constraints_ = axes_ * std::ssize(grip_points_);
  if (span_.end_direction) constraints_ += axes_ - 1;
  if (span_.twist) ++constraints_;
  masses_ = points_.weights_with_density(inertia_.per_length);
  for (const PointMass& mass : inertia_.points) masses_[point_at(mass.at)] += mass.mass;
  gravity_.setZero(points_.points(), 3);
  Eigen::Index node = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Element& element = elements[e];
    const double middle = element.begin + element.length / 2;
    const Eigen::Vector3d mean =
        span_.weight_between(element.begin, element.end()) / element.length;
    // Line loads begin and end at element boundaries, and are linear on each element.
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
    for (const LineLoad& load : span_.line_loads) {
      if (load.begin < middle && middle < load.end) slope += load.slope();
    }
    const Eigen::Index begin = points_.begin(static_cast<Eigen::Index>(e));
    for (Eigen::Index point = begin; point < begin + points_.element_points(); ++point) {
      const double weight = points_.weights()[point];
      // Begins and ends of elements are not quadrature nodes.
      if (!(weight > 0)) continue;
      gravity_.row(point) = weight * (mean + (nodes()[node++] - middle) * slope).transpose();
    }
  }
  loads_.setZero(points_.points(), 3);
  for (const Span::Load& load : span_.loads) {
    loads_.row(point_at(load.at)) += load.force.transpose();
  }
}

Eigen::VectorXd SpanDynamics::full(const Eigen::Ref<const Eigen::VectorXd>& part) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(full_size());
  result.head(size()) = part;
  return result;
}

void SpanDynamics::move(const SpanDrive& drive, const Eigen::Ref<const Eigen::VectorXd>& x,
                        const Eigen::Ref<const Eigen::VectorXd>& v,
                        const Eigen::Ref<const Eigen::VectorXd>& a) {
  drive_ = drive;
  x_ = x;
  v_ = v;
  a_ = a;
  frames_.evaluate(full(x), state_);
  const FrameSpins spins =
      frame_spins(frames_, state_, {full(v), full(a), drive.spin, drive.spin_rate});
  t_ = state_.t.bottomRows(nodes().size());
  t_rate_ = cross_rows(spins.velocities, t_);
  const Eigen::Matrix3d end = state_.end_frame();
  end_d1_ = rotating_vector(end.col(0), spins.end_velocity, spins.end_acceleration);
  end_tangent_ = rotating_vector(end.col(2), spins.end_velocity, spins.end_acceleration);
  Eigen::MatrixXd tangents(t_.rows(), 9);
  tangents << t_, t_rate_,
      cross_rows(spins.accelerations, t_) + cross_rows(spins.velocities, t_rate_);
  const Eigen::MatrixXd moved = points_.to_points(tangents);
  const VectorMotion& anchor = drive.grips.front();
  position_ = moved.leftCols<3>().rowwise() + anchor.value.transpose();
  velocity_ = moved.middleCols<3>(3).rowwise() + anchor.rate.transpose();
  acceleration_ = moved.rightCols<3>().rowwise() + anchor.acceleration.transpose();
  forces_ = masses_.asDiagonal() * acceleration_;
  forces_ += (inertia_.drag * points_.weights()).asDiagonal() * velocity_;
  add_quadratic_drag();
  forces_ -= (gravity_ + loads_) * drive.turn.transpose();
  collect_soft_contact_points();
  collect_contact_points();
}

/// Adds quadratic drag to the forces. Begins and ends of elements have zero weight.
void SpanDynamics::add_quadratic_drag() {
  mean_drag_ = inertia_.drag;
  if (!(inertia_.quadratic_drag > 0)) return;
  quadratic_drag_.setZero(points_.points(), 3);
  double change = 0;
  Eigen::Index node = 0;
  for (Eigen::Index point = 0; point < points_.points(); ++point) {
    const double weight = inertia_.quadratic_drag * points_.weights()[point];
    if (!(weight > 0)) continue;
    const Eigen::RowVector3d along = t_.row(node++);
    const Eigen::RowVector3d across =
        velocity_.row(point) - velocity_.row(point).dot(along) * along;
    quadratic_drag_.row(point) = weight * across.norm() * across;
    change += 2 * weight * across.norm();
  }
  mean_drag_ += change / span_.length;
  forces_ += quadratic_drag_;
}

Eigen::Vector3d SpanDynamics::multiplier_force(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                               std::size_t hold) const {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  force.head(axes_) = multipliers.segment(axes_ * static_cast<Eigen::Index>(hold), axes_);
  return force;
}

/// Returns the derivatives of f by the unknowns.
Eigen::VectorXd SpanDynamics::frame_adjoint(const FrameGradient& f) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(full_size());
  frames_.add_adjoint(f, 1, state_, result);
  return result.head(size());
}

/// Returns minus the derivatives by the tangents of the work of all forces on the rod with these
/// multipliers, inertia included: the internal force that balances them.
Eigen::MatrixX3d SpanDynamics::work_gradient(
    const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  Eigen::MatrixX3d forces = forces_;
  for (std::size_t k = 0; k < grip_points_.size(); ++k) {
    forces.row(grip_points_[k]) -= multiplier_force(multipliers, k).transpose();
  }
  Eigen::MatrixX3d result = points_.to_nodes(forces);
  for (const ContactPoint& touch : contact_points_)
    result -= tangent_gradient(touch, touch.force());
  return result;
}

/// Returns minus the couple on each element at its end: minus the torque of the clamp at the end of
/// the span, and zero for all elements but the last.
std::vector<Eigen::Vector3d> SpanDynamics::couples(
    const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  std::vector<Eigen::Vector3d> result(nodes_.elements().size(), Eigen::Vector3d::Zero());
  Eigen::Index row = axes_ * std::ssize(grip_points_);
  for (const AcrossDirector& across : drive_.across_end) {
    result.back() -= multipliers[row++] * director(across).value.cross(across.direction.value);
  }
  return result;
}

Eigen::VectorXd SpanDynamics::residual(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  const Eigen::MatrixX3d tangents = work_gradient(multipliers);
  Eigen::VectorXd result = elastic_.cwiseProduct(x_ + inertia_.material_damping * v_) +
                           frame_adjoint({&tangents, couples(multipliers)});
  if (has_twist()) result += twist_inertia_.cwiseProduct(a_);
  return result;
}

/// Sums the stiffness of strains, of rigid contacts, and of the internal force, which keeps its
/// direction when the tangents rotate. The latter is nearly all of the stiffness of a thread under
/// tension T, where bending has the fraction EI / (T l^2).
Eigen::MatrixXd SpanDynamics::stiffness(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  const Eigen::MatrixX3d tangents = work_gradient(multipliers);
  std::vector<Eigen::Matrix3d> curvatures(nodes_.elements().size(), Eigen::Matrix3d::Zero());
  Eigen::Index row = axes_ * std::ssize(grip_points_);
  for (const AcrossDirector& across : drive_.across_end) {
    curvatures.back() -=
        multipliers[row++] * spin_hessian(director(across).value, across.direction.value);
  }
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(full_size(), full_size());
  frame_hessian_.add(frames_, {&tangents, couples(multipliers)}, curvatures, state_, hessian);
  Eigen::MatrixXd result = hessian.topLeftCorner(size(), size());
  result.diagonal() += elastic_;
  add_contact_derivatives(&ContactPoint::by_depth, result);
  return result;
}

Eigen::MatrixXd SpanDynamics::damping(const Eigen::MatrixXd& mass) {
  // Drag is proportional to the mass matrix if the mass per length is constant.
  const double rod = points_.weights_with_density(inertia_.per_length).sum();
  Eigen::MatrixXd result = (rod > 0 ? mean_drag_ * span_.length / rod : 0) * mass;
  result.diagonal() += inertia_.material_damping * elastic_;
  add_contact_derivatives(&ContactPoint::by_rate, result);
  return result;
}

Eigen::VectorXd SpanDynamics::impulse(const Eigen::MatrixX3d& before) {
  const Eigen::MatrixX3d tangents = points_.to_nodes(masses_.asDiagonal() * (velocity_ - before));
  return frame_adjoint({&tangents, {}});
}

Eigen::MatrixX3d SpanDynamics::constraint_residuals() const {
  Eigen::MatrixX3d result(constraints_, 3);
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < grip_points_.size(); ++k) {
    Eigen::Matrix3d miss;
    miss.col(0) = position_.row(grip_points_[k]).transpose() - drive_.grips[k + 1].value;
    miss.col(1) = velocity_.row(grip_points_[k]).transpose() - drive_.grips[k + 1].rate;
    miss.col(2) = acceleration_.row(grip_points_[k]).transpose() - drive_.grips[k + 1].acceleration;
    result.middleRows(row, axes_) = miss.topRows(axes_);
    row += axes_;
  }
  for (const AcrossDirector& across : drive_.across_end) {
    const VectorMotion& e = across.direction;
    const VectorMotion& t = director(across);
    result(row, 0) = e.value.dot(t.value);
    result(row, 1) = e.rate.dot(t.value) + e.value.dot(t.rate);
    result(row, 2) =
        e.acceleration.dot(t.value) + 2 * e.rate.dot(t.rate) + e.value.dot(t.acceleration);
    ++row;
  }
  return result;
}

Eigen::MatrixXd SpanDynamics::jacobian() {
  Eigen::MatrixXd result(constraints_, size());
  Eigen::Index row = 0;
  for (const std::vector<double>& signs : signs_) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, full_size());
    frames_.position_jacobian(signs, state_, rows);
    result.middleRows(row, axes_) = rows.topLeftCorner(axes_, size());
    row += axes_;
  }
  std::vector<Eigen::Vector3d> couples(nodes_.elements().size(), Eigen::Vector3d::Zero());
  for (const AcrossDirector& across : drive_.across_end) {
    couples.back() = director(across).value.cross(across.direction.value);
    result.row(row++) = frame_adjoint({nullptr, couples}).transpose();
  }
  return result;
}

Eigen::MatrixXd SpanDynamics::mass_matrix() {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size(), size());
  for (const Eigen::MatrixXd& tangents : frames_.tangent_jacobian(state_)) {
    result += energy_model::mass_matrix(points_, masses_, tangents.leftCols(size()));
  }
  if (has_twist()) result.diagonal() += twist_inertia_;
  return result;
}

Eigen::VectorXd SpanDynamics::fit(const StartShape& shape) const {
  RodFrames::State scratch;
  frames_.resize(scratch);
  Eigen::VectorXd x = energy_model::fit(frames_, shape.tangents, most_fit_steps, scratch);
  if (has_twist() && shape.roll.size() > 0) x = rolled(frames_, x, shape.roll);
  return x.head(size());
}

SpanShape SpanDynamics::shape(const Eigen::VectorXd& x) const {
  SpanShape result;
  result.terms = terms_;
  result.planar = false;
  result.anchor = span_.anchor;
  result.elements = nodes_.elements();
  result.start_frame = start_frame_;
  result.free_start = !span_.start_direction;
  result.strains = full(x);
  result.natural = span_.natural;
  return result;
}

}  // namespace dlo::energy_model
