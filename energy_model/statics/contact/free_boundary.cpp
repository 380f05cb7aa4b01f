#include "contact/free_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "contact/clearance.hpp"

namespace dlo::energy_model {
namespace {

bool is_free(const Span& span, double at) {
  return at > closest_cuts && at < span.length - closest_cuts && !is_held(span, at);
}

}  // namespace

double FreeBoundary::at(const Span& span) const {
  const Span::Contact& own = span.contacts[contact];
  return begins ? own.begin : own.end;
}

void FreeBoundary::move(Span& span, double way) const {
  Span::Contact& own = span.contacts[contact];
  const bool lies = own.lies();
  if (begins || !lies) own.begin += way;
  if (!begins || !lies) own.end += way;
  if (!lies) own.end = own.begin;
}

std::vector<FreeBoundary> free_boundaries(const Span& span) {
  std::vector<FreeBoundary> ends;
  for (std::size_t i = 0; i < span.contacts.size(); ++i) {
    const Span::Contact& contact = span.contacts[i];
    if (is_free(span, contact.begin)) ends.push_back({i, true});
    if (contact.lies() && is_free(span, contact.end)) ends.push_back({i, false});
  }
  return ends;
}

MoveLimits move_limits(const Span& span, const FreeBoundary& end) {
  const double at = end.at(span);
  const Span::Contact& own = span.contacts[end.contact];
  MoveLimits limits{at, span.length - at};
  const auto beside = [&](double other) {
    if (other < at) limits.down = std::min(limits.down, at - other);
    if (other > at) limits.up = std::min(limits.up, other - at);
  };
  beside(span.anchor);
  for (const Span::Hold& hold : span.holds) beside(hold.at);
  for (const Span::Contact& contact : span.contacts) {
    if (&contact == &own) continue;
    beside(contact.begin);
    beside(contact.end);
  }
  if (own.lies()) beside(end.begins ? own.end : own.begin);
  return limits;
}

Eigen::VectorXd free_boundary_residual(const SpanSolution& solution,
                                       const std::vector<FreeBoundary>& ends) {
  constexpr double aside = 1e-12;
  const Span& span = solution.model->span();
  const std::shared_ptr<SpanPoint> point = solution.at_x();
  std::vector<double> s;
  for (const FreeBoundary& end : ends) {
    // Evaluate in the free one of the two elements that meet there.
    const double at = end.at(span);
    const bool after = span.contacts[end.contact].lies() && !end.begins;
    s.push_back(after ? at + aside : at - aside);
  }
  const SpanSamples samples = solution.model->shape(solution.x).sample(s);
  Eigen::VectorXd result(static_cast<Eigen::Index>(ends.size()));
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Span::Contact& contact = span.contacts[ends[i].contact];
    const Clearance here = clearance_at(contact.obstacle.body, samples, column);
    const MoveLimits limits = move_limits(span, ends[i]);
    if (contact.lies()) {
      result[column] = here.rate * (ends[i].begins ? limits.down : limits.up);
    } else if (const auto at = solution.model->touches_at(*point, ends[i].contact)) {
      result[column] = contact.begin - *at;
    } else {
      result[column] = here.slope * std::min(limits.down, limits.up);
    }
  }
  return result;
}

}  // namespace dlo::energy_model
