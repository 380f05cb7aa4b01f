#include "span/span_traits.hpp"

#include <algorithm>

#include "certify/enough_terms.hpp"
#include "problem/segments.hpp"
#include "strain/piece.hpp"

namespace dlo::energy_model {

namespace {

/// Of the parts between the ends and the loads of a span.
double longest_without_load(const Span& span) {
  double longest = 0;
  double begin = 0;
  for (const Span::Load& load : span.loads) {
    longest = std::max(longest, load.at - begin);
    begin = load.at;
  }
  return std::max(longest, span.length - begin);
}

}  // namespace

SpanTraits::SpanTraits(const Span& span)
    : load(span.total_load()), fields(fields_of(span)), graded(!span.cuts.empty()) {
  for (const Segment& segment : segments_of(span)) {
    if (!segment.taut()) continue;
    taut = true;
    stiffness = std::max(stiffness, segment.tension / std::max(1e-12, segment.slack()));
  }
  // Where contact begins inside a piece it takes more terms than the piece's length tells.
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
  if (!span.has_material_directors()) return;
  // What the free rod turns by has to be resolved as well.
  const double curvature = span.natural.largest();
  natural_terms = first_terms(curvature * curvature, longest_piece);
}

}  // namespace dlo::energy_model
