#include "strain/contact_rows.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "strain/span_shape.hpp"

namespace dlo::energy_model {
namespace {

/// How a grip holds the rod at a contact.
enum class HeldBy {
  nothing,
  pin,
  clamp,
};

HeldBy held_within(const Span& span, double begin, double end) {
  const auto within = [&](double at) {
    return at > begin - closest_cuts && at < end + closest_cuts;
  };
  HeldBy held = HeldBy::nothing;
  if (within(span.anchor)) held = span.start_direction ? HeldBy::clamp : HeldBy::pin;
  for (std::size_t i = 0; i < span.holds.size(); ++i) {
    if (!within(span.holds[i].at)) continue;
    const bool clamp =
        span.holds[i].direction || (span.end_direction && i + 1 == span.holds.size());
    held = std::max(held, clamp ? HeldBy::clamp : HeldBy::pin);
  }
  return held;
}

/// Series in orthonormal Legendre polynomials at xi.
double series(const Eigen::Ref<const Eigen::VectorXd>& coefficients, double xi) {
  Eigen::VectorXd values(coefficients.size());
  Eigen::VectorXd integrals(coefficients.size());
  legendre(xi, values, integrals);
  return values.dot(coefficients);
}

}  // namespace

Eigen::Index ContactRows::add_row(const Span::Contact& contact, double offset) {
  const Eigen::Index row = weighted_.cols();
  weighted_.conservativeResize(Eigen::NoChange, row + 1);
  weighted_.col(row).setZero();
  normal_.conservativeResize(Eigen::NoChange, row + 1);
  normal_.col(row) = contact.wall.normal;
  offset_.conservativeResize(row + 1);
  offset_[row] = offset;
  return row;
}

void ContactRows::reset(const Span& span, const std::vector<Piece>& pieces, int terms,
                        const LegendreTable& table, const Eigen::VectorXd& nodes,
                        const Eigen::VectorXd& weights) {
  contacts_.clear();
  weighted_.resize(nodes.size(), 0);
  normal_.resize(3, 0);
  offset_.resize(0);
  const Eigen::Index Q = table.nodes.size();
  for (const Span::Contact& contact : span.contacts) {
    Rows rows;
    const HeldBy held = held_within(span, contact.begin, contact.end);
    if (held == HeldBy::nothing) {
      rows.clearance = add_row(contact, contact.wall.offset);
      for (Eigen::Index q = 0; q < nodes.size(); ++q) {
        if (nodes[q] > span.anchor && nodes[q] < contact.begin) {
          weighted_(q, rows.clearance) = weights[q];
        }
        if (nodes[q] < span.anchor && nodes[q] > contact.begin) {
          weighted_(q, rows.clearance) = -weights[q];
        }
      }
    }
    // A slope of which nothing is known yet has one more unknown than its curvature.
    Eigen::Index degrees = held == HeldBy::clamp ? terms : terms + 1;
    for (std::size_t e = 0; e < pieces.size() && contact.lies(); ++e) {
      const double middle = pieces[e].begin + pieces[e].length / 2;
      if (middle < contact.begin || middle > contact.end) continue;
      Rows::Slope slope;
      slope.first = weighted_.cols();
      slope.count = degrees;
      slope.length = pieces[e].length;
      for (Eigen::Index k = 0; k < degrees; ++k) {
        const Eigen::Index row = add_row(contact, 0);
        weighted_.col(row).segment(static_cast<Eigen::Index>(e) * Q, Q) =
            table.weights.cwiseProduct(table.values.col(k));
      }
      rows.slopes.push_back(slope);
      degrees = terms;
    }
    contacts_.push_back(std::move(rows));
  }
}

Eigen::Vector3d ContactRows::moment(Eigen::Index row, double multiplier,
                                    const Eigen::MatrixX3d& tangents) const {
  const Eigen::Vector3d lever = tangents.transpose() * weighted_.col(row);
  return multiplier * lever.cross(Eigen::Vector3d(normal_.col(row)));
}

Eigen::VectorXd ContactRows::adopt(const ContactRows& other,
                                   const Eigen::VectorXd& multipliers) const {
  Eigen::VectorXd adopted = Eigen::VectorXd::Zero(count());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Rows& to = contacts_[i];
    const Rows& from = other.contacts_[i];
    if (to.clearance >= 0) adopted[to.clearance] = multipliers[from.clearance];
    for (std::size_t k = 0; k < to.slopes.size(); ++k) {
      const Eigen::Index shared = std::min(to.slopes[k].count, from.slopes[k].count);
      adopted.segment(to.slopes[k].first, shared) =
          multipliers.segment(from.slopes[k].first, shared);
    }
  }
  return adopted;
}

std::vector<ContactForce> ContactRows::forces(const Eigen::VectorXd& multipliers) const {
  constexpr int looks = 32;  // at the pressure of a piece
  std::vector<ContactForce> result;
  for (const Rows& rows : contacts_) {
    ContactForce force;
    double before = rows.clearance < 0 ? 0 : multipliers[rows.clearance];
    force.total = force.begin = before;
    for (std::size_t i = 0; i < rows.slopes.size(); ++i) {
      const Rows::Slope& slope = rows.slopes[i];
      const Eigen::VectorXd carried = multipliers.segment(slope.first, slope.count) / slope.length;
      const double here = series(carried, 0);
      if (i == 0) {
        force.begin = before - here;
      } else {
        force.least_inner = std::min(force.least_inner, before - here);
      }
      force.end = before = series(carried, 1);
      // The pressure is its derivative, which the last coefficients hardly know.
      const Eigen::VectorXd smooth = carried.head((slope.count + 1) / 2);
      double last = series(smooth, 0);
      for (int k = 1; k <= looks; ++k) {
        const double next = series(smooth, static_cast<double>(k) / looks);
        const double pressure = (last - next) * looks / slope.length;
        const bool first = i == 0 && k == 1;
        force.least_pressure = first ? pressure : std::min(force.least_pressure, pressure);
        force.largest_pressure = first ? pressure : std::max(force.largest_pressure, pressure);
        last = next;
      }
    }
    result.push_back(force);
  }
  return result;
}

}  // namespace dlo::energy_model
