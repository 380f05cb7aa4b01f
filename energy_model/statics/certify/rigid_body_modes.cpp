#include "certify/rigid_body_modes.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/legendre.hpp"
#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {
namespace {

/// Sine of the angle up to which a vector counts as parallel to an axis: the rounding of decimal
/// input.
constexpr double parallel_tolerance = 1e-10;

/// Returns the vectors, scaled to a length of about 1, that a free rotation must not change.
std::vector<Eigen::Vector3d> rotation_invariants(const Span& span) {
  std::vector<Eigen::Vector3d> invariants;
  const double load = std::max(span.total_load(), 1e-300);
  invariants.emplace_back(span.weight * span.length / load);
  for (const Span::Part& part : span.parts) {
    invariants.emplace_back(part.weight * (part.end - part.begin) / load);
  }
  for (const LineLoad& on : span.line_loads) {
    invariants.emplace_back(on.at_begin * (on.end - on.begin) / load);
    invariants.emplace_back(on.at_end * (on.end - on.begin) / load);
  }
  for (const Span::Load& at : span.loads) {
    invariants.emplace_back(at.force / load);
    if (at.couple != 0) invariants.emplace_back(Eigen::Vector3d::UnitZ());
  }
  if (span.start_direction) invariants.push_back(*span.start_direction);
  if (span.end_direction) invariants.push_back(*span.end_direction);
  for (const Span::Hold& hold : span.holds) {
    invariants.emplace_back(hold.offset / span.length);
    if (hold.direction) invariants.push_back(*hold.direction);
  }
  return invariants;
}

/// Returns the axes, in the span of the given columns, about which a rotation moves none of the
/// vectors.
Eigen::MatrixXd invariant_axes(const std::vector<Eigen::Vector3d>& vectors,
                               const Eigen::MatrixXd& axes) {
  if (axes.cols() == 0 || vectors.empty()) return axes;
  Eigen::MatrixXd moved(3 * static_cast<Eigen::Index>(vectors.size()), axes.cols());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (Eigen::Index k = 0; k < axes.cols(); ++k) {
      const Eigen::Vector3d axis = axes.col(k);
      moved.col(k).segment<3>(3 * static_cast<Eigen::Index>(i)) = axis.cross(vectors[i]);
    }
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(moved, Eigen::ComputeFullV);
  const Eigen::Index lost = (svd.singularValues().array() > parallel_tolerance).count();
  return axes * svd.matrixV().rightCols(axes.cols() - lost);
}

/// Returns the number of rotations about these axes that move the shape.
Eigen::Index count_moving_rotations(const Eigen::MatrixXd& axes,
                                    const std::vector<Eigen::Vector3d>& shape) {
  return axes.cols() - invariant_axes(shape, axes).cols();
}

/// Whether a span is uniform and intrinsically straight, and only grips at its ends act on it.
bool is_held_at_ends_alone(const Span& span) {
  return span.total_load() == 0 && !span.has_couples() && span.contacts.empty() &&
         span.soft_obstacles.empty() && span.parts.empty() && !span.has_material_directors() &&
         span.anchor == 0 && span.holds.size() == 1 && span.holds.front().at == span.length;
}

/// Largest curvature at the ends of a shape that may be shifted along the rod, divided by its
/// largest curvature: the shift changes the energy by about the square of this ratio.
constexpr double straight_end = 1e-2;

bool is_straight_at_ends(const SpanEnergy& model, const Eigen::VectorXd& x) {
  const double length = model.span().length;
  const Eigen::VectorXd& nodes = model.nodes();
  std::vector<double> s(nodes.data(), nodes.data() + nodes.size());
  s.insert(s.end(), {0, length});
  const Eigen::VectorXd size = model.shape(x).sample(s).curvature.colwise().norm();
  return size.tail<2>().maxCoeff() < straight_end * size.maxCoeff();
}

/// Returns the coefficients of the derivative of the curvature by the arc length.
Eigen::VectorXd derivative_along_rod(const SpanEnergy& model, const Eigen::VectorXd& x) {
  const SpanUnknowns& unknowns = model.unknowns();
  const LegendreTable& table = model.table();
  const Eigen::Index K = unknowns.terms;
  Eigen::MatrixXd slopes(K, table.nodes.size());
  Eigen::VectorXd at(K);
  for (Eigen::Index q = 0; q < table.nodes.size(); ++q) {
    legendre_slopes(table.nodes[q], at);
    slopes.col(q) = at;
  }
  const Eigen::MatrixXd derivative =
      table.values.leftCols(K).transpose() * table.weights.asDiagonal() * slopes.transpose();
  Eigen::VectorXd result = Eigen::VectorXd::Zero(x.size());
  for (Eigen::Index field = 0; field < unknowns.fields; ++field) {
    for (Eigen::Index e = 0; e < unknowns.elements; ++e) {
      const Eigen::Index first = unknowns.first(field, e);
      result.segment(first, K) = derivative * x.segment(first, K) / model.element(e).length;
    }
  }
  return result;
}

}  // namespace

std::optional<Eigen::MatrixXd> sliding_modes(const SpanEnergy& model, const Eigen::VectorXd& x,
                                             ReducedHessian& hessian, Eigen::Index rigid) {
  if (!is_held_at_ends_alone(model.span()) || !is_straight_at_ends(model, x)) return std::nullopt;
  Eigen::VectorXd shift = derivative_along_rod(model, x);
  const SpanUnknowns& unknowns = model.unknowns();
  if (unknowns.fields == 2) {
    // A helix that is shifted also rotates about its axis, which is a separate mode.
    const Eigen::Index n = unknowns.columns();
    Eigen::VectorXd rotation = Eigen::VectorXd::Zero(x.size());
    rotation.head(n) = -x.segment(n, n);
    rotation.segment(n, n) = x.head(n);
    shift -= shift.dot(rotation) / rotation.squaredNorm() * rotation;
  }
  // Smallest fraction of the shift's squared norm within these modes; for other modes it is about
  // zero.
  constexpr double least_share = 0.99;
  Eigen::MatrixXd modes(x.size(), rigid + 1);
  for (Eigen::Index i = 0; i <= rigid; ++i) modes.col(i) = eigenvector_by_magnitude(hessian, i);
  const double share = (modes.transpose() * shift).squaredNorm() / shift.squaredNorm();
  if (!(share > least_share)) return std::nullopt;
  return modes;
}

RigidBodyModes rigid_body_modes(const Span& span, const Eigen::Matrix3Xd& tangents) {
  // A clamp prevents every rotation of material directors. A twisted round rod spins about its own
  // axis during such a rotation without a change of energy, so that its end frames stay as
  // prescribed.
  if (span.has_material_directors() && span.start_direction) return {};
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  std::vector<Eigen::Vector3d> shape;
  if (span.has_material_directors()) {
    // A rotation about a straight rod's own axis moves its frame.
    shape = {axes.col(0), axes.col(1), axes.col(2)};
  } else {
    for (Eigen::Index q = 0; q < tangents.cols(); ++q) shape.emplace_back(tangents.col(q));
  }
  const std::vector<Eigen::Vector3d> invariants = rotation_invariants(span);
  const auto count = [&](const Eigen::MatrixXd& about) {
    return count_moving_rotations(invariant_axes(invariants, about), shape);
  };
  if (!span.planar) return {.in_plane = count(axes)};
  return {.in_plane = count(axes.col(2)),
          .out_of_plane = span.stays_in_plane() ? 0 : count(axes.leftCols(2))};
}

bool is_rotated_copy(const Span& span, const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  constexpr double tolerance = 1e-6;
  if (span.has_material_directors()) return false;
  const std::vector<Eigen::Vector3d> invariants = rotation_invariants(span);
  const auto count = static_cast<Eigen::Index>(invariants.size());
  Eigen::Matrix3Xd from(3, count + a.cols());
  for (Eigen::Index i = 0; i < count; ++i) from.col(i) = invariants[static_cast<std::size_t>(i)];
  from.rightCols(a.cols()) = a / span.length;
  Eigen::Matrix3Xd to = from;
  to.rightCols(b.cols()) = b / span.length;
  // Kabsch's algorithm: the best rotation in the least-squares sense.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(to * from.transpose(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs[2] = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d turn = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return (turn * from - to).norm() < tolerance;
}

}  // namespace dlo::energy_model
