#include "span/model_size.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "span/span_traits.hpp"
#include "strain/span_shape.hpp"

namespace dlo::energy_model {
namespace {

int unknowns_by_term(const Span& span) {
  return SpanTraits::fields_of(span) * static_cast<int>(pieces_of(span).size());
}

}  // namespace

int affordable_terms(const Span& span) {
  return std::max(1, most_model_unknowns / unknowns_by_term(span));
}

void require_affordable(const Span& span, int terms, std::string_view function) {
  const int least = terms > 0 ? terms : least_model_terms;
  if (least <= affordable_terms(span)) return;
  const std::size_t pieces = pieces_of(span).size();
  std::ostringstream message;
  message << function << ": " << span.loads.size() << " loads, " << span.holds.size()
          << " grips and " << span.parts.size() << " sections of a span cut it into " << pieces
          << " pieces, must be at most "
          << most_model_unknowns / (least * SpanTraits::fields_of(span)) << " of " << least
          << (terms > 0 ? "" : " or more") << " terms";
  throw std::invalid_argument(message.str());
}

}  // namespace dlo::energy_model
