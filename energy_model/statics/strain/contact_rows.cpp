#include "strain/contact_rows.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frames/span_shape.hpp"

namespace dlo::energy_model {
namespace {

constexpr Eigen::Index slope_moments_of_short_part = 8;  // moments of the slope on a short element

/// Whether a grip, a load or a section change is at `at`, which could cause a concentrated force.
bool may_concentrate(const Span& span, double at) {
  const auto is_at = [at](double other) { return std::abs(at - other) < closest_cuts; };
  return is_held(span, at) ||
         std::ranges::any_of(span.loads, [&](const Span::Load& load) { return is_at(load.at); }) ||
         std::ranges::any_of(span.parts, [&](const Span::Part& part) {
           return is_at(part.begin) || is_at(part.end);
         });
}

/// Returns the forces on points times the second derivatives of their gaps by two coordinates.
Eigen::VectorXd stiffness(const Eigen::VectorXd& forces, const std::vector<obstacle::Gap>& gaps,
                          std::size_t a, std::size_t b) {
  Eigen::VectorXd result(forces.size());
  for (Eigen::Index m = 0; m < forces.size(); ++m) {
    const Eigen::Matrix3d& hessian = gaps[static_cast<std::size_t>(m)].hessian;
    result[m] = forces[m] * hessian(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  }
  return result;
}

}  // namespace

Eigen::VectorXd ContactRows::CurvedContact::forces(
    const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  return weights * multipliers.segment(first, weights.cols());
}

Eigen::Index ContactRows::add_row() {
  const Eigen::Index row = linear_.cols();
  linear_.conservativeResize(Eigen::NoChange, row + 1);
  linear_.col(row).setZero();
  normal_.conservativeResize(Eigen::NoChange, row + 1);
  normal_.col(row).setZero();
  offset_.conservativeResize(row + 1);
  offset_[row] = 0;
  return row;
}

void ContactRows::add_curved(CurvedContact curved, Eigen::Index rows) {
  curved.first = linear_.cols();
  for (Eigen::Index k = 0; k < rows; ++k) (void)add_row();
  curved_.push_back(std::move(curved));
}

void ContactRows::add_clearance(const Span& span, std::size_t contact,
                                const std::vector<Element>& elements) {
  const Span::Contact& own = span.contacts[contact];
  contacts_[contact].clearance = linear_.cols();
  const Eigen::Index element = elements_before(elements, own.begin);
  if (!own.lies() && own.slides && element > 0 && element < std::ssize(elements)) {
    ClearanceMinimum touch;
    touch.contact = contact;
    touch.body = own.obstacle.body;
    touch.row = add_row();
    touch.at = own.begin;
    touch.before = element - 1;
    // The search covers half of each adjacent element.
    touch.low = own.begin - elements[static_cast<std::size_t>(element) - 1].length / 2;
    touch.high = own.begin + elements[static_cast<std::size_t>(element)].length / 2;
    clearance_minima_.push_back(std::move(touch));
  } else if (own.obstacle.body.is_half_space()) {
    const Eigen::Index row = add_row();
    linear_.col(row) = reach_.begin(element);
    normal_.col(row) = own.obstacle.body.normal();
    offset_[row] = own.obstacle.body.clearance(Eigen::Vector3d::Zero());
  } else {
    CurvedContact curved;
    curved.contact = contact;
    curved.body = own.obstacle.body;
    curved.reach = {reach_.begin(element), 0, Eigen::MatrixXd::Zero(0, 1)};
    curved.weights.setOnes(1, 1);
    add_curved(std::move(curved), 1);
  }
}

void ContactRows::add_slopes(const Span& span, std::size_t contact,
                             const std::vector<Element>& elements, Eigen::Index degrees,
                             Eigen::Index terms, const LegendreTable& table) {
  const Span::Contact& own = span.contacts[contact];
  const obstacle::Body& body = own.obstacle.body;
  const Eigen::Index Q = table.nodes.size();
  for (Eigen::Index e = 0; e < std::ssize(elements); ++e) {
    const Element& element = elements[static_cast<std::size_t>(e)];
    const double middle = element.begin + element.length / 2;
    if (middle < own.begin || middle > own.end) continue;
    const Eigen::Index count =
        element.length < short_part ? std::min(degrees, slope_moments_of_short_part) : degrees;
    ContactSeries::Slope slope;
    slope.first = linear_.cols();
    slope.count = count;
    slope.length = element.length;
    slope.may_concentrate_force = may_concentrate(span, element.begin);
    contacts_[contact].slopes.push_back(slope);
    if (body.is_half_space()) {
      for (Eigen::Index k = 0; k < count; ++k) {
        const Eigen::Index row = add_row();
        linear_.col(row).segment(e * Q, Q) = table.weights.cwiseProduct(table.values.col(k));
        normal_.col(row) = body.normal();
      }
    } else {
      CurvedContact curved;
      curved.contact = contact;
      curved.body = body;
      curved.reach = reach_.along(e);
      curved.weights.resize(Q + 2, count);
      Eigen::VectorXd values(count);
      Eigen::VectorXd unused(count);
      legendre(0, values, unused);
      curved.weights.row(0) = -values;
      legendre(1, values, unused);
      curved.weights.row(Q + 1) = values;
      for (Eigen::Index q = 0; q < Q; ++q) {
        legendre_slopes(table.nodes[q], values);
        curved.weights.row(q + 1) = -table.weights[q] * values;
      }
      curved.weights /= element.length;
      add_curved(std::move(curved), count);
    }
    degrees = terms;
  }
}

void ContactRows::reset(const Span& span, const std::vector<Element>& elements, int terms,
                        const LegendreTable& table) {
  contacts_.assign(span.contacts.size(), {});
  curved_.clear();
  clearance_minima_.clear();
  normals_.clear();
  linear_.resize(std::ssize(elements) * table.nodes.size(), 0);
  normal_.resize(3, 0);
  offset_.resize(0);
  if (!span.contacts.empty()) reach_ = PositionOperator(span, elements, table);
  for (std::size_t i = 0; i < span.contacts.size(); ++i) {
    const Span::Contact& contact = span.contacts[i];
    const obstacle::Body& body = contact.obstacle.body;
    normals_.emplace_back(body.is_half_space() ? body.normal() : Eigen::Vector3d::Zero());
    const HeldBy held = span.held_within(contact.begin, contact.end, closest_cuts);
    if (held == HeldBy::nothing) {
      add_clearance(span, i, elements);
    } else {
      contacts_[i].held_at_begin = is_held(span, contact.begin);
      contacts_[i].held_at_end = is_held(span, contact.end);
    }
    if (!contact.lies()) continue;
    // Unless a clamp within the contact prescribes the slope, the slope has one more unknown than
    // its derivative.
    const Eigen::Index degrees = held == HeldBy::clamp ? terms : terms + 1;
    add_slopes(span, i, elements, degrees, terms, table);
  }
}

void ContactRows::resize(ContactEvaluation& place) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place.by_tangent[axis] = linear_ * normal_.row(static_cast<Eigen::Index>(axis)).asDiagonal();
  }
  place.residual.setZero(count());
  place.clearance_minima.resize(clearance_minima_.size());
  place.gaps.resize(curved_.size());
  for (std::size_t i = 0; i < curved_.size(); ++i) {
    place.gaps[i].resize(static_cast<std::size_t>(curved_[i].reach.points()));
  }
}

/// Finds the first minimum of the clearance, starting from touch.at, on the side to which the
/// clearance decreases. The rate of the result is 0 if there is no minimum between touch.low and
/// touch.high.
ContactEvaluation::ClearanceMinimum ContactRows::least_clearance(
    const Eigen::MatrixX3d& tangents, const ClearanceMinimum& touch) const {
  constexpr double closest = 1e-14;
  constexpr int strides = 8;
  constexpr int most_steps = 50;
  ContactEvaluation::ClearanceMinimum found;
  const auto evaluate = [&](Eigen::Index element, double s) {
    found.at = s;
    found.point = reach_.at(element, s);
    found.gap = touch.body.gap(tangents.transpose() * found.point.position);
    found.tangent = tangents.transpose() * found.point.tangent;
    found.rate = found.gap.gradient.dot(tangents.transpose() * found.point.curvature) +
                 found.tangent.dot(found.gap.hessian * found.tangent);
    return found.gap.gradient.dot(found.tangent);
  };
  // Search in the direction in which the clearance decreases.
  double sense = -1;
  double slope = -evaluate(touch.before, touch.at);
  Eigen::Index element = touch.before;
  if (!(slope < 0)) {
    sense = 1;
    slope = std::min(evaluate(++element, touch.at), 0.0);
  }
  const double largest_distance = std::abs((sense < 0 ? touch.low : touch.high) - touch.at);
  double low = 0;  // distances from touch.at; the clearance decreases at `low` and increases at
                   // `high`
  double high = 0;
  double distance = 0;
  for (int step = 0; step < most_steps; ++step) {
    const double newton = found.rate > 0 ? distance - slope / found.rate : largest_distance;
    if (found.rate > 0 && std::abs(newton - distance) < closest) return found;
    const bool bracketed = high > 0;
    if (bracketed) {
      distance = newton > low && newton < high ? newton : (low + high) / 2;
    } else {
      distance = std::min(newton, low + largest_distance / strides);
    }
    if (distance > largest_distance || (bracketed && high - low < closest)) break;
    slope = sense * evaluate(element, touch.at + sense * distance);
    (slope < 0 ? low : high) = distance;
  }
  found.rate = 0;  // outside the range of the search
  return found;
}

void ContactRows::evaluate(const Eigen::MatrixX3d& tangents, ContactEvaluation& place) const {
  for (std::size_t i = 0; i < clearance_minima_.size(); ++i) {
    place.clearance_minima[i] = least_clearance(tangents, clearance_minima_[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      place.by_tangent[axis].col(clearance_minima_[i].row) =
          place.clearance_minima[i].gap.gradient[static_cast<Eigen::Index>(axis)] *
          place.clearance_minima[i].point.position;
    }
  }
  for (std::size_t i = 0; i < curved_.size(); ++i) {
    const CurvedContact& curved = curved_[i];
    const Eigen::Index points = curved.reach.points();
    const Eigen::Matrix3Xd positions = curved.reach.positions(tangents);
    Eigen::MatrixX3d gradients(points, 3);
    Eigen::VectorXd clearances(points);
    for (Eigen::Index m = 0; m < points; ++m) {
      obstacle::Gap& gap = place.gaps[i][static_cast<std::size_t>(m)];
      gap = curved.body.gap(positions.col(m));
      gradients.row(m) = gap.gradient;
      clearances[m] = gap.value;
    }
    const Eigen::Index rows = curved.weights.cols();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      auto by_tangent =
          place.by_tangent[static_cast<std::size_t>(axis)].middleCols(curved.first, rows);
      // A rod in the plane has no component normal to it.
      if (gradients.col(axis).isZero(0)) {
        by_tangent.setZero();
      } else {
        curved.reach.to_nodes(gradients.col(axis).asDiagonal() * curved.weights, by_tangent);
      }
    }
    place.residual.segment(curved.first, rows).noalias() = curved.weights.transpose() * clearances;
  }
  for (Eigen::Index row = 0; row < count(); ++row) {
    if (normal_.col(row).squaredNorm() == 0) continue;
    place.residual[row] =
        linear_.col(row).dot(tangents * Eigen::Vector3d(normal_.col(row))) + offset_[row];
  }
  for (std::size_t i = 0; i < clearance_minima_.size(); ++i) {
    place.residual[clearance_minima_[i].row] = place.clearance_minima[i].gap.value;
  }
}

std::optional<double> ContactRows::contact_arc_length(const ContactEvaluation& place,
                                                      std::size_t contact) const {
  for (std::size_t i = 0; i < clearance_minima_.size(); ++i) {
    if (clearance_minima_[i].contact == contact) return place.clearance_minima[i].at;
  }
  return std::nullopt;
}

void ContactRows::subtract_hessian(const ContactEvaluation& place,
                                   const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                   const std::array<Eigen::MatrixXd, 3>& tangents,
                                   Eigen::Ref<Eigen::MatrixXd> hessian) const {
  Eigen::MatrixX3d moved(hessian.cols(), 3);
  for (std::size_t i = 0; i < clearance_minima_.size(); ++i) {
    const ContactEvaluation::ClearanceMinimum& touch = place.clearance_minima[i];
    const double mu = multipliers[clearance_minima_[i].row];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      moved.col(static_cast<Eigen::Index>(axis)).noalias() =
          tangents[axis].transpose() * touch.point.position;
    }
    hessian.noalias() -= mu * (moved * touch.gap.hessian * moved.transpose());
    if (!(touch.rate > 0)) continue;
    // The contact point slides along the rod when the slope of the clearance changes.
    Eigen::VectorXd turned = moved * (touch.gap.hessian * touch.tangent);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      turned.noalias() += touch.gap.gradient[static_cast<Eigen::Index>(axis)] *
                          (tangents[axis].transpose() * touch.point.tangent);
    }
    hessian.noalias() += (mu / touch.rate) * turned * turned.transpose();
  }
  for (std::size_t i = 0; i < curved_.size(); ++i) {
    const CurvedContact& curved = curved_[i];
    const Eigen::VectorXd forces = curved.forces(multipliers);
    std::array<Eigen::MatrixXd, 3> points;  // x unknowns
    const std::size_t axes = tangents[2].isZero(0) ? 2 : 3;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      points[axis] = curved.reach.to_points(tangents[axis]);
    }
    for (std::size_t a = 0; a < axes; ++a) {
      Eigen::MatrixXd bent = Eigen::MatrixXd::Zero(points[a].rows(), points[a].cols());
      for (std::size_t b = 0; b < axes; ++b) {
        bent.noalias() += stiffness(forces, place.gaps[i], a, b).asDiagonal() * points[b];
      }
      hessian.noalias() -= points[a].transpose() * bent;
    }
  }
}

Eigen::VectorXd ContactRows::prolong(const ContactRows& other,
                                     const Eigen::VectorXd& multipliers) const {
  Eigen::VectorXd prolonged = Eigen::VectorXd::Zero(count());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const ContactSeries& to = contacts_[i];
    const ContactSeries& from = other.contacts_[i];
    if (to.clearance >= 0) prolonged[to.clearance] = multipliers[from.clearance];
    for (std::size_t k = 0; k < to.slopes.size(); ++k) {
      const Eigen::Index shared = std::min(to.slopes[k].count, from.slopes[k].count);
      prolonged.segment(to.slopes[k].first, shared) =
          multipliers.segment(from.slopes[k].first, shared);
    }
  }
  return prolonged;
}

std::vector<ContactForce> ContactRows::forces(const ContactEvaluation& place,
                                              const Eigen::MatrixX3d& tangents,
                                              const Eigen::VectorXd& multipliers) const {
  std::vector<ContactForce> result;
  result.reserve(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    result.push_back(force_of_series(contacts_[i], multipliers));
    result.back().force = result.back().total * normals_[i];
    Eigen::MatrixX3d carried = Eigen::MatrixX3d::Zero(tangents.rows(), 3);
    place.add(contacts_[i].own(multipliers), carried);
    result.back().moment = moment_about_anchor(tangents, carried);
  }
  for (std::size_t i = 0; i < clearance_minima_.size(); ++i) {
    result[clearance_minima_[i].contact].force =
        multipliers[clearance_minima_[i].row] * place.clearance_minima[i].gap.gradient;
  }
  for (std::size_t i = 0; i < curved_.size(); ++i) {
    const CurvedContact& curved = curved_[i];
    const Eigen::VectorXd forces = curved.forces(multipliers);
    const ContactSeries& rows = contacts_[curved.contact];
    const bool begins = !rows.slopes.empty() && curved.first == rows.slopes.front().first;
    const bool ends = !rows.slopes.empty() && curved.first == rows.slopes.back().first;
    const Eigen::Index first = begins && rows.held_at_begin ? 1 : 0;
    const Eigen::Index last = forces.size() - (ends && rows.held_at_end ? 1 : 0);
    for (Eigen::Index m = first; m < last; ++m) {
      result[curved.contact].force +=
          forces[m] * place.gaps[i][static_cast<std::size_t>(m)].gradient;
    }
  }
  return result;
}

}  // namespace dlo::energy_model
