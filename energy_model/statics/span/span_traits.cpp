#include "span/span_traits.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "certify/piece_cuts.hpp"
#include "frames/piece.hpp"
#include "problem/segments.hpp"

namespace dlo::energy_model {

namespace {

/// Returns the longest interval between the ends and the loads of a span.
double longest_without_load(const Span& span) {
  double longest = 0;
  double begin = 0;
  for (const Span::Load& load : span.loads) {
    longest = std::max(longest, load.at - begin);
    begin = load.at;
  }
  return std::max(longest, span.length - begin);
}

/// Returns an upper bound of the curvature by couples.
double bent_by_couples(const Span& span) {
  double couples = 0;
  for (const Span::Load& load : span.loads) couples += std::abs(load.couple);
  double softest = span.stiffness.head<2>().minCoeff();
  for (const Span::Part& part : span.parts) {
    softest = std::min(softest, part.stiffness.head<2>().minCoeff());
  }
  return couples / softest;
}

int unknowns_by_term(const Span& span) {
  return SpanTraits::fields_of(span) * static_cast<int>(pieces_of(span).size());
}

}  // namespace

SpanTraits::SpanTraits(const Span& span)
    : load(span.total_load()), fields(fields_of(span)), adapted(!span.cuts.empty()) {
  for (const Segment& segment : segments_of(span)) {
    if (!segment.taut()) continue;
    taut = true;
    stiffness = std::max(stiffness, segment.tension / std::max(1e-12, segment.slack()));
  }
  // If contact begins inside an element, it needs more coefficients than its length suggests.
  if (!span.soft_obstacles.empty() && span.contact_ends.empty()) {
    longest_piece = span.length;
    return;
  }
  if (span.is_plain_cantilever()) {
    longest_piece = longest_without_load(span);
    return;
  }
  for (const Piece& piece : pieces_of(span)) {
    longest_piece = std::max(longest_piece, piece.length);
  }
  if (!span.has_material_directors() && !span.has_couples()) return;
  // The rotation of the stress-free shape, and the one by couples, have to be resolved as well.
  const double curvature = span.natural.largest() + bent_by_couples(span);
  natural_terms = first_terms(curvature * curvature, longest_piece);
}

int affordable_terms(const Span& span) {
  return std::max(1, most_model_unknowns / unknowns_by_term(span));
}

void require_affordable(const Span& span, int terms, std::string_view function) {
  const int least = terms > 0 ? terms : least_model_terms;
  if (least <= affordable_terms(span)) return;
  const std::size_t pieces = pieces_of(span).size();
  std::ostringstream message;
  message << function << ": " << span.loads.size() << " loads, " << span.holds.size()
          << " grips and " << span.parts.size() << " sections of a span divide it into " << pieces
          << " elements, must be at most "
          << most_model_unknowns / (least * SpanTraits::fields_of(span)) << " of " << least
          << (terms > 0 ? "" : " or more") << " terms";
  throw std::invalid_argument(message.str());
}

}  // namespace dlo::energy_model
