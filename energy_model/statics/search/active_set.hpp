#pragma once

#include "contact/clearance.hpp"
#include "span/span_options.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Finds the contacts of an equilibrium by an active-set method. Each round runs Newton's method
/// with given contacts, moves their ends to where the rod lifts off (free_boundary_newton()),
/// releases contacts that pull, and adds contacts where the rod is within an obstacle
/// (updated_contacts()). It ends when nothing is released or added. It ends as not_verified after
/// 16 rounds, if a round finds no equilibrium, or if the contacts then do not end where the rod
/// lifts off. It applies to all rods, including those that clamps twist.
class ActiveSet {
 public:
  /// All arguments have to outlive the object.
  /// @param searched  the span without contacts; if it is planar and an initial guess is in space,
  ///   the shape has left its plane
  ActiveSet(const Span& searched, const SpanOptions& options, SpanWorkspace& workspace)
      : searched_(searched),
        options_(options),
        workspace_(workspace),
        least_terms_(options.start.known.terms()) {}

  /// Solves from a guess of contacts and shape. The result is certified, and not_verified if the
  /// contacts do not converge.
  [[nodiscard]] SpanSolution solve(Span span, TangentField near);
  /// Solves from an equilibrium with its contacts; certified likewise.
  [[nodiscard]] SpanSolution solve(SpanSolution equilibrium);
  /// Updates contacts with about the present number of coefficients and without a certificate, for
  /// steps of a continuation. The result is no equilibrium if the contacts do not converge.
  [[nodiscard]] SpanSolution update(SpanSolution equilibrium);

  /// Solves by Newton's method from a guess, or by descent, with fixed contacts.
  [[nodiscard]] SpanSolution newton_from(const Span& span, const TangentField& near);

 private:
  /// Returns the number of coefficients of each element that resolves a shape under the span's
  /// load, or half of it if there are many elements.
  [[nodiscard]] static int terms_of_load(const Span& span);
  [[nodiscard]] SpanSolution run(Span span, TangentField near, SpanSolution solution,
                                 Resolution resolution);
  [[nodiscard]] SpanSolution resolved(SpanSolution solution, Span& span);
  [[nodiscard]] SpanSolution with_all_terms(SpanSolution solution);
  [[nodiscard]] SpanSolution finished(SpanSolution solution);
  [[nodiscard]] bool is_within_truncation(const SpanSolution& solution) const;
  [[nodiscard]] SpanSolution with_evaluations(SpanSolution solution);

  const Span& searched_;
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  int least_terms_;
  int spent_ = 0;
};

/// Returns known contacts, made sliding, with the present positions of their obstacles;
/// std::nullopt if an obstacle has disappeared.
[[nodiscard]] std::optional<std::vector<Span::Contact>> moved_contacts(
    const Span& span, std::vector<Span::Contact> known);

/// Solves for the equilibrium near a known one (SpanOptions::start) of a span whose grips or
/// obstacles have moved a little: Newton's method with its contacts from that shape, then updates
/// by ActiveSet. There is no search. The result is `followed` if it is stable or a singular point.
/// It is no equilibrium if an obstacle of a contact has disappeared or the shape has changed a lot.
[[nodiscard]] SpanSolution follow_contacts(const Span& searched, const SpanOptions& options,
                                           SpanWorkspace& workspace);

}  // namespace dlo::energy_model
