#include "frames/rod_frames.hpp"

#include <algorithm>
#include <cmath>

#include "base/spin.hpp"
#include "linear/dense_products.hpp"

namespace dlo::energy_model {
namespace {

/// Largest acceptable collocation defect, and limits of its correction. After Magnus steps two
/// corrections suffice for all strains that the nodes resolve. For other strains a defect remains
/// that no correction removes; it is recognised by exceeding `largest_square` times the square of
/// the previous defect.
constexpr double finest_defect = 2e-15;
constexpr double largest_square = 10;  // ratio of a defect to the square of the previous one
constexpr int most_corrections = 6;

using Rows = Eigen::Ref<Eigen::MatrixX4d, 0, Eigen::OuterStride<>>;
using ConstRows = Eigen::Ref<const Eigen::MatrixX4d, 0, Eigen::OuterStride<>>;
using ConstStrains = Eigen::Ref<const Eigen::MatrixX3d, 0, Eigen::OuterStride<>>;

/// Computes product = product + scale q (0, 0, 0, u3), row by row.
void add_product_with_twist(const ConstRows& q, const ConstStrains& u, double scale, Rows product) {
  for (Eigen::Index r = 0; r < q.rows(); ++r) {
    const double c = scale * u(r, 2);
    product(r, 0) -= q(r, 3) * c;
    product(r, 1) += q(r, 2) * c;
    product(r, 2) -= q(r, 1) * c;
    product(r, 3) += q(r, 0) * c;
  }
}

/// Computes from_rotation_vector(); for a small angle by the series of sine and cosine.
Eigen::Quaterniond step_rotation(const Eigen::Vector3d& v) {
  constexpr double small = 0.04;  // square of the angle; the omitted terms are below rounding
  const double z = v.squaredNorm();
  if (!(z < small)) return from_rotation_vector(v);
  // Each nested factor multiplies by the inverse of an integer: this is called once per node.
  const double cosine =
      1 -
      z * (1. / 8) *
          (1 - z * (1. / 48) * (1 - z * (1. / 120) * (1 - z * (1. / 224) * (1 - z * (1. / 360)))));
  const double half_sine =
      0.5 * (1 - z * (1. / 24) * (1 - z * (1. / 80) * (1 - z * (1. / 168) * (1 - z * (1. / 288)))));
  return {cosine, half_sine * v.x(), half_sine * v.y(), half_sine * v.z()};
}

Eigen::Vector4d as_vector(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

}  // namespace

void RodFrames::reset(const std::vector<Element>& elements, int terms, const Eigen::Matrix3d& start,
                      bool free_start, const NaturalStrains& natural) {
  start_ = Eigen::Quaterniond(start).normalized();
  fields_ = natural.empty() ? 2 : 3;
  panels_.clear();
  columns_ = 0;
  nodes_ = 0;
  const auto add = [&](double length, const std::array<double, 3>& strain, int count) {
    panels_.push_back({length, strain, &director_table(count), count, columns_, nodes_});
    columns_ += count;
    nodes_ += panels_.back().nodes();
  };
  // A free start's rotation is a constant strain over a length of 1, with one coefficient.
  if (free_start) add(1, {1, 1, 1}, 1);
  turn_nodes_ = nodes_;
  elements_ = elements.size();
  for (const Element& element : elements) {
    const double twist = fields_ == 3 ? element.strain(2) : 0;
    add(element.length, {element.strain(0), element.strain(1), twist}, terms);
  }
  natural_.resize(0, 3);
  if (natural.empty()) return;
  natural_.setZero(nodes_, 3);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Panel& panel = panels_[panels_.size() - elements.size() + e];
    for (Eigen::Index r = 0; r < panel.nodes(); ++r) {
      const double s = elements[e].begin + elements[e].length * panel.table->nodes[r];
      natural_.row(panel.node + r) = natural.at(s).transpose();
    }
  }
}

/// Computes product = length / 2 q (0, u), row by row.
void RodFrames::multiply_by_strains(
    const ConstRows& q, const Panel& panel, const State& state,
    Eigen::Ref<Eigen::MatrixX4d, 0, Eigen::OuterStride<>> product) const {
  const auto u = state.u.middleRows(panel.node, panel.nodes());
  dense_kernel().multiply_by_two_strains(columns_of(q), columns_of(u), panel.length / 2,
                                         result_columns(product));
  if (fields_ == 3) add_product_with_twist(q, u, panel.length / 2, product);
}

void RodFrames::integrate(const Panel& panel, Eigen::Quaterniond& at, State& state) const {
  const LegendreTable& table = *panel.table;
  const Eigen::Index Q = panel.nodes();
  const auto u = state.u.middleRows(panel.node, Q);
  auto q = state.q.middleRows(panel.node, Q);
  auto product = state.product.topRows(Q);
  auto defect = state.defect.topRows(Q);
  auto turn = state.turn.topRows(Q);
  // Magnus step: the strain's integral, plus h^2/12 times the commutator of the strains at both
  // ends.
  multiply(table.integration, u.leftCols(fields_), turn.leftCols(fields_));
  turn.leftCols(fields_) *= panel.length;
  Eigen::Quaterniond along = at;
  for (Eigen::Index r = 0; r < Q; ++r) {
    Eigen::Vector3d step(turn(r, 0), turn(r, 1), fields_ == 3 ? turn(r, 2) : 0);
    if (r > 0) {
      const double h = panel.length * (table.nodes[r] - table.nodes[r - 1]);
      step.head(fields_) -= turn.row(r - 1).head(fields_).transpose();
      step.z() += h * h / 12 * (u(r - 1, 0) * u(r, 1) - u(r - 1, 1) * u(r, 0));
      if (fields_ == 3) {
        step.x() += h * h / 12 * (u(r - 1, 1) * u(r, 2) - u(r - 1, 2) * u(r, 1));
        step.y() += h * h / 12 * (u(r - 1, 2) * u(r, 0) - u(r - 1, 0) * u(r, 2));
      }
    }
    along = along * step_rotation(step);
    q.row(r) = as_vector(along).transpose();
  }
  const Eigen::Vector4d first = as_vector(at);
  const DenseKernel& kernel = dense_kernel();
  double before = 1;
  for (int i = 0; i < most_corrections; ++i) {
    multiply_by_strains(q, panel, state, product);
    multiply(table.integration, product, defect);
    defect -= q;
    defect.rowwise() += first.transpose();
    const double size = defect.cwiseAbs().maxCoeff();
    if (!(size > finest_defect) || !(size < 1) || size > largest_square * before * before) break;
    before = size;
    // eta = d q* + 1/2 int d u q*
    multiply_by_strains(defect, panel, state, product);
    kernel.multiply_by_conjugate(result_columns(product), columns_of(q));
    kernel.multiply_by_conjugate(result_columns(defect), columns_of(q));
    multiply(table.integration, product, turn);
    defect += turn;
    kernel.add_product(result_columns(q), columns_of(defect));
    // The remaining defect is about the square of this one.
    if (size < 3e-8) break;
  }
  multiply_by_strains(q, panel, state, product);
  const Eigen::Vector4d end = first + product.transpose() * table.weights;
  at = Eigen::Quaterniond(end[0], end[1], end[2], end[3]).normalized();
}

void RodFrames::resize(State& state) const {
  state.q.resize(nodes_, 4);
  state.u.resize(nodes_, 3);
  state.panel_ends.resize(panels_.size());
  for (Eigen::MatrixX3d* m : {&state.d1, &state.d2, &state.t, &state.rest_integrals})
    m->resize(nodes_, 3);
  // The last panel is the largest.
  const Eigen::Index Q = panels_.back().nodes();
  for (Eigen::MatrixX4d* m : {&state.product, &state.defect, &state.turn}) m->resize(Q, 4);
  for (Eigen::MatrixX3d* m : {&state.couples, &state.moments, &state.levers}) m->resize(Q, 3);
  state.along.resize(Q, 3);
  state.ends.resize(3, fields_ * columns_);
}

void RodFrames::evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, State& state) const {
  Eigen::Quaterniond at = start_;
  std::size_t done = 0;
  for (const Panel& panel : panels_) {
    for (Eigen::Index f = 0; f < fields_; ++f) {
      auto strains = state.u.col(f).segment(panel.node, panel.nodes());
      multiply(panel.table->values.leftCols(panel.terms),
               x.segment(f * columns_ + panel.column, panel.terms), strains);
      strains *= panel.strain[static_cast<std::size_t>(f)];
    }
    if (fields_ == 3) {
      state.u.middleRows(panel.node, panel.nodes()) +=
          natural_.middleRows(panel.node, panel.nodes());
    }
    integrate(panel, at, state);
    state.panel_ends[done++] = at;
  }
  for (Eigen::Index r = 0; r < nodes_; ++r) {
    const double w = state.q(r, 0), x1 = state.q(r, 1), y = state.q(r, 2), z = state.q(r, 3);
    state.d1.row(r) << 1 - 2 * (y * y + z * z), 2 * (x1 * y + w * z), 2 * (x1 * z - w * y);
    state.d2.row(r) << 2 * (x1 * y - w * z), 1 - 2 * (x1 * x1 + z * z), 2 * (y * z + w * x1);
    state.t.row(r) << 2 * (x1 * z + w * y), 2 * (y * z - w * x1), 1 - 2 * (x1 * x1 + y * y);
  }
  for (const Panel& panel : panels_) {
    // Gauss' rule integrates by parts: S^T W = w w^T - W S.
    const Eigen::Index Q = panel.nodes();
    const auto t = state.t.middleRows(panel.node, Q);
    auto rest_integrals = state.rest_integrals.middleRows(panel.node, Q);
    const Eigen::Vector3d whole = t.transpose() * panel.table->weights;
    multiply(panel.table->integration, t, rest_integrals);
    rest_integrals = (-rest_integrals).rowwise() + whole.transpose();
    rest_integrals.array().colwise() *= panel.table->weights.array();
  }
}

void RodFrames::moments(const Panel& panel, const FrameGradient& f, const Eigen::Vector3d& later,
                        State& state) const {
  const Eigen::Index Q = panel.nodes();
  auto couples = state.couples.topRows(Q);
  auto moments = state.moments.topRows(Q);
  moments.noalias() = panel.length * (panel.table->weights * later.transpose());
  if (panel.node < turn_nodes_ || f.nodes == nullptr) {
    couples.setZero();
    return;
  }
  for (Eigen::Index r = 0; r < Q; ++r) {
    const Eigen::Index node = panel.node + r;
    const Eigen::Vector3d t = state.t.row(node);
    const Eigen::Vector3d g = f.nodes->row(node - turn_nodes_);
    couples.row(r) = t.cross(g);
  }
  auto beyond = state.levers.topRows(Q);
  multiply(panel.table->integration_transposed, couples, beyond);
  moments += panel.length * beyond;
}

void RodFrames::add_adjoint(const FrameGradient& f, double sense, State& state,
                            Eigen::Ref<Eigen::VectorXd> gradient) const {
  Eigen::Vector3d later = Eigen::Vector3d::Zero();
  std::size_t element = elements_;
  for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
    if (element > 0 && !f.couples.empty()) later += f.couples[--element];
    moments(*panel, f, later, state);
    const Eigen::Index Q = panel->nodes();
    auto along = state.along.topLeftCorner(Q, fields_);
    for (Eigen::Index field = 0; field < fields_; ++field) {
      const auto d = director(state, field).middleRows(panel->node, Q);
      along.col(field) = d.cwiseProduct(state.moments.topRows(Q)).rowwise().sum();
    }
    auto columns = state.product.topLeftCorner(panel->terms, fields_);
    multiply(panel->table->values_transposed.topRows(panel->terms), along, columns);
    for (Eigen::Index field = 0; field < fields_; ++field) {
      const double scale = sense * panel->strain[static_cast<std::size_t>(field)];
      gradient.segment(field * columns_ + panel->column, panel->terms) +=
          scale * columns.col(field);
    }
    later += state.couples.topRows(Q).colwise().sum().transpose();
  }
}

void RodFrames::end_rotation_jacobian(State& state) const {
  for (const Panel& panel : panels_) end_spins(panel, state);
}

void RodFrames::couple_adjoint(Eigen::Index element, const Eigen::Vector3d& couple,
                               const State& state,
                               Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) const {
  const Panel& last = panels_[panels_.size() - elements_ + static_cast<std::size_t>(element)];
  const Eigen::Index count = last.column + last.terms;
  row.setZero();
  for (Eigen::Index field = 0; field < fields_; ++field) {
    row.segment(field * columns_, count).noalias() =
        couple.transpose() * state.ends.middleCols(field * columns_, count);
  }
}

void RodFrames::position_jacobian(const std::vector<double>& signs, State& state,
                                  Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  // A force along an axis a has the moment v x a, with v the vector to the points beyond; d.(v x a)
  // = a.(d x v).
  Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
  std::size_t element = signs.size();
  for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
    const Eigen::Index Q = panel->nodes();
    const double length = panel->length;
    const double sign = panel->node < turn_nodes_ ? 0 : signs[--element];
    auto v = state.moments.topRows(Q);
    v.noalias() = length * panel->table->weights * beyond.transpose();
    v += sign * length * length * state.rest_integrals.middleRows(panel->node, Q);
    auto levers = state.levers.topRows(Q);
    for (Eigen::Index field = 0; field < fields_; ++field) {
      const Eigen::MatrixX3d& directors = director(state, field);
      for (Eigen::Index r = 0; r < Q; ++r) {
        const Eigen::Vector3d d = directors.row(panel->node + r);
        const Eigen::Vector3d own = v.row(r);
        levers.row(r) = d.cross(own);
      }
      auto columns = state.product.topLeftCorner(panel->terms, 3);
      multiply(panel->table->values_transposed.topRows(panel->terms), levers, columns);
      jacobian.middleCols(field * columns_ + panel->column, panel->terms) =
          panel->strain[static_cast<std::size_t>(field)] * columns.transpose();
    }
    const auto t = state.t.middleRows(panel->node, Q);
    beyond += sign * length * (t.transpose() * panel->table->weights);
  }
}

/// Computes state.spins, the rotations of the panel's nodes by its own unknowns. Rows are unknowns;
/// columns are nodes, axis by axis.
void RodFrames::own_spins(const Panel& panel, State& state) const {
  const Eigen::Index Q = panel.nodes();
  const Eigen::Index K = panel.terms;
  const auto values = panel.table->values_transposed.topRows(K);
  auto scaled = state.scaled.topLeftCorner(fields_ * K, Q);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (Eigen::Index field = 0; field < fields_; ++field) {
      const double scale = panel.length * panel.strain[static_cast<std::size_t>(field)];
      const auto d = director(state, field).col(axis).segment(panel.node, Q);
      for (Eigen::Index r = 0; r < Q; ++r) {
        scaled.col(r).segment(field * K, K) = (scale * d[r]) * values.col(r);
      }
    }
    multiply(scaled, panel.table->integration_transposed,
             state.spins.block(0, axis * Q, fields_ * K, Q));
  }
}

/// Computes the panel's columns of state.ends, the rotation of the panel's end by its own unknowns.
void RodFrames::end_spins(const Panel& panel, State& state) const {
  const Eigen::Index Q = panel.nodes();
  auto weighted = state.levers.topRows(Q);
  for (Eigen::Index field = 0; field < fields_; ++field) {
    const auto d = director(state, field).middleRows(panel.node, Q);
    weighted.noalias() = panel.table->weights.asDiagonal() * d;
    auto columns = state.product.topLeftCorner(panel.terms, 3);
    multiply(panel.table->values_transposed.topRows(panel.terms), weighted, columns);
    state.ends.middleCols(field * columns_ + panel.column, panel.terms) =
        panel.length * panel.strain[static_cast<std::size_t>(field)] * columns.transpose();
  }
}

std::array<Eigen::MatrixXd, 3> RodFrames::tangent_jacobian(State& state) const {
  const Eigen::Index nodes = nodes_ - turn_nodes_;
  std::array<Eigen::MatrixXd, 3> jacobian;
  Eigen::MatrixXd spins = Eigen::MatrixXd::Zero(3 * nodes, fields_ * columns_);
  state.spins.resize(fields_ * panels_.back().terms, 3 * panels_.back().nodes());
  state.scaled.resize(fields_ * panels_.back().terms, panels_.back().nodes());
  for (const Panel& panel : panels_) {
    const Eigen::Index Q = panel.nodes();
    const Eigen::Index K = panel.terms;
    own_spins(panel, state);
    end_spins(panel, state);
    const Eigen::Index first = panel.node - turn_nodes_;
    const Eigen::Index beyond = std::max<Eigen::Index>(0, first + Q);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (Eigen::Index field = 0; field < fields_; ++field) {
        const Eigen::Index column = field * columns_ + panel.column;
        if (first >= 0) {
          spins.block(axis * nodes + first, column, Q, K) =
              state.spins.block(field * K, axis * Q, K, Q).transpose();
        }
        spins.block(axis * nodes + beyond, column, nodes - beyond, K).rowwise() =
            state.ends.row(axis).segment(column, K);
      }
    }
  }
  const auto t = state.t.bottomRows(nodes);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::Index a = (axis + 1) % 3;
    const Eigen::Index b = (axis + 2) % 3;
    jacobian[static_cast<std::size_t>(axis)] =
        t.col(b).asDiagonal() * spins.middleRows(a * nodes, nodes);
    jacobian[static_cast<std::size_t>(axis)] -=
        t.col(a).asDiagonal() * spins.middleRows(b * nodes, nodes);
  }
  return jacobian;
}

}  // namespace dlo::energy_model
