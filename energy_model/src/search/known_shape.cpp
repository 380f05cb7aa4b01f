#include "search/known_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "search/twist_path.hpp"
#include "span/span_traits.hpp"

namespace dlo::energy_model {

TangentField field_of(const Equilibrium& start, const PlacedSpan& placed, double length) {
  return [&start, &placed, length](const Eigen::VectorXd& s) {
    std::vector<double> arc_lengths;
    arc_lengths.reserve(static_cast<std::size_t>(s.size()));
    for (const double at : s) {
      const double arc = placed.start + (placed.reversed ? -at : at) * length;
      arc_lengths.push_back(std::clamp(arc, 0.0, length));
    }
    const Samples samples = start.sample(arc_lengths);
    StartShape shape((placed.reversed ? -1.0 : 1.0) * (placed.frame * samples.tangents));
    if (placed.span.has_material_directors() && samples.d1.cols() > 0) {
      shape.roll = roll_of(shape.tangents, placed.frame * samples.d1);
    }
    return shape;
  };
}

const TwistedPart* known_twist(const Equilibrium& known, const PlacedSpan& placed, double length) {
  for (const TwistedPart& part : known.twists) {
    if (std::abs(part.begin - placed.start) < 1e-9 * length) return &part;
  }
  return nullptr;
}

std::vector<Span::Contact> known_contacts(const Equilibrium& known, const PlacedSpan& placed,
                                          double length) {
  std::vector<Span::Contact> contacts;
  for (const ContactPart& part : known.contacts) {
    const auto [begin, end] =
        std::minmax({placed.s_of(part.begin, length), placed.s_of(part.end, length)});
    if (begin < 0 || end > placed.span.length) continue;
    Span::Contact contact;
    contact.obstacle.index = part.obstacle;
    contact.begin = begin;
    contact.end = end;
    contacts.push_back(contact);
  }
  std::sort(contacts.begin(), contacts.end(),
            [](const auto& a, const auto& b) { return a.begin < b.begin; });
  return contacts;
}

std::vector<PlacedSolution> spans_in_space(const Problem& problem, const Equilibrium& known,
                                           int terms, const Deadline& deadline,
                                           SpanWorkspace& workspace) {
  std::vector<PlacedSolution> result;
  for (PlacedSpan& placed : split(problem)) {
    placed.span.rigid_obstacles.clear();
    placed.span.planar = false;
    require_affordable(placed.span, terms, "vibrations");
    SpanOptions options;
    options.terms = terms;
    options.deadline = deadline;
    const TangentField field = field_of(known, placed, problem.length);
    const TwistedPart* twisted = known_twist(known, placed, problem.length);
    if (placed.frames && twisted != nullptr) {
      SpanSolution solution =
          twist_from(field, {held_end_d1(*placed.frames, placed.span), twisted->angle}, placed.span,
                     placed.frames->stiffness, options, workspace);
      result.push_back({std::move(placed), std::move(solution)});
      continue;
    }
    options.start.field = field;
    SpanSolution solution = std::move(solve_span(placed.span, options, workspace).front());
    result.push_back({std::move(placed), std::move(solution)});
  }
  return result;
}

}  // namespace dlo::energy_model
