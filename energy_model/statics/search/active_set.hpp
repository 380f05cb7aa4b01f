#pragma once

#include "contact/update_contacts.hpp"
#include "span/span_options.hpp"
#include "span/span_workspace.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// The contacts of an equilibrium, by an active-set method: Newton's method with contacts that are
/// given, whose ends move to where the rod lifts off (free_boundary_newton()), then contacts that
/// pull are released and others are added where the rod is behind an obstacle (updated_contacts()),
/// until there are none of either. Of all rods, also of those that clamps twist.
class ActiveSet {
 public:
  /// All of them have to outlive it.
  /// @param searched  without contacts; a guess in space of one in the plane has left that
  ActiveSet(const Span& searched, const SpanOptions& options, SpanWorkspace& workspace)
      : searched_(searched),
        options_(options),
        workspace_(workspace),
        load_(searched.total_load()),
        least_terms_(options.start.known.terms()) {}

  /// From a guess of contacts and shape. Certified; not_verified where contacts do not converge.
  [[nodiscard]] SpanSolution solve(Span span, TangentField near);
  /// The same from an equilibrium with its contacts.
  [[nodiscard]] SpanSolution solve(SpanSolution equilibrium);
  /// The same with about the terms that it has and without a certificate, as steps of a
  /// continuation take it; no equilibrium where contacts do not converge.
  [[nodiscard]] SpanSolution update(SpanSolution equilibrium);
  [[nodiscard]] SpanSolution update(Span span, TangentField near, int terms);

  /// By Newton's method from a guess, or downhill, with contacts that stay.
  [[nodiscard]] SpanSolution newton_from(const Span& span, const TangentField& near);
  /// Terms of each piece that resolve a shape under the span's load, or half of them where pieces
  /// are many.
  [[nodiscard]] int terms_of_load(const Span& span) const;

 private:
  [[nodiscard]] SpanSolution run(Span span, TangentField near, SpanSolution solution,
                                 Resolution resolution);
  [[nodiscard]] SpanSolution resolved(SpanSolution solution, Span& span);
  [[nodiscard]] SpanSolution with_all_terms(SpanSolution solution);
  [[nodiscard]] SpanSolution finished(SpanSolution solution);
  [[nodiscard]] bool hardly_behind(const SpanSolution& solution) const;
  [[nodiscard]] SpanSolution counted(SpanSolution solution);

  const Span& searched_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  double load_;
  int least_terms_;
  int spent_ = 0;
};

/// Contacts held at points: where an obstacle would have to pull there may be no shape that slides,
/// but one that is held; and a part so short that a point is hardly behind the obstacle beside it
/// is one.
/// @return whether any contact has changed
[[nodiscard]] bool hold_points(Span& span);

/// Known contacts with obstacles that may have moved; nothing where one has gone.
[[nodiscard]] std::optional<std::vector<Span::Contact>> moved_contacts(
    const Span& span, std::vector<Span::Contact> known);

}  // namespace dlo::energy_model
