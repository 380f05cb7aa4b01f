#include "search/known_shape.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/require.hpp"
#include "base/sized_samples.hpp"
#include "contact/penalty_polygon.hpp"
#include "search/twist_path.hpp"
#include "span/local_solver.hpp"

namespace dlo::energy_model {

Equilibrium shape_through(const std::vector<double>& arc_lengths,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& points, double length) {
  constexpr const char* function = "energy_near";
  constexpr double shortest_chord = 1.0 / 64;
  const auto count = static_cast<Eigen::Index>(arc_lengths.size());
  require(count >= 2 && points.cols() == count, function, "points",
          static_cast<double>(points.cols()), "one for each arc length, two or more");
  require(points.allFinite(), function, "points", NAN, "finite");
  std::vector<double> middles;
  std::vector<Eigen::Vector3d> chords;
  Eigen::Index last = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double before = i > 0 ? arc_lengths[at - 1] : -1;
    require(arc_lengths[at] >= 0 && arc_lengths[at] <= length && arc_lengths[at] > before, function,
            "arc length", arc_lengths[at], "growing, in [0, " + std::to_string(length) + "]");
    const double first = arc_lengths[static_cast<std::size_t>(last)];
    const Eigen::Vector3d chord = points.col(i) - points.col(last);
    const bool is_long = arc_lengths[at] - first >= shortest_chord * length;
    if (i == 0 || !((is_long || i + 1 == count) && chord.norm() > 0)) continue;
    middles.push_back((first + arc_lengths[at]) / 2);
    chords.emplace_back(chord.normalized());
    last = i;
  }
  require(!chords.empty(), function, "points", points(0, 0),
          "different from the first at the last arc length, or at one >= 1/64 of the length away");
  Equilibrium shape;
  shape.sample = [s = Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(
                      middles.data(), static_cast<Eigen::Index>(middles.size()))),
                  t = Eigen::Matrix3Xd(Eigen::Map<Eigen::Matrix3Xd>(
                      chords.front().data(), 3, static_cast<Eigen::Index>(chords.size()))),
                  length](std::span<const double> at) {
    Samples samples = sized_samples(at, length);
    for (std::size_t q = 0; q < at.size(); ++q) {
      samples.tangents.col(static_cast<Eigen::Index>(q)) = tangent_between(s, t, at[q]);
    }
    return samples;
  };
  return shape;
}

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
    if (std::abs(part.begin - placed.start) < same_arc_length_share * length) return &part;
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
  std::ranges::sort(contacts, {}, &Span::Contact::begin);
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
          twist_from(field, {prescribed_end_d1(*placed.frames, placed.span), twisted->angle},
                     placed.span, placed.frames->stiffness, options, workspace);
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
