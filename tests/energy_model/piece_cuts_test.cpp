// Tests of the ends of elements of a soft rod, such that few coefficients resolve it: random scenes
// that no affordable number of terms on elements between grips resolves.

#include "certify/piece_cuts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "random_scenes.hpp"
#include "solved.hpp"
#include "span/refinement.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {
namespace {

/// A heavy rod between two pins that are close together: it hangs from both and turns back below.
Span hairpin() {
  Span span;
  span.holds = {{1, {0.05, 0, 0}}};
  span.weight = {0, -2e4, 0};
  return span;
}

SpanSolution solved(const Span& span, int terms, SpanWorkspace& workspace) {
  SpanOptions options;
  options.terms = terms;
  return std::move(solve_span(span, options, workspace).front());
}

TEST(PieceCuts, AreWhereASoftRodTurnsBackAndBesideIt) {
  SpanWorkspace workspace;
  Span span = hairpin();
  const SpanSolution plain = test::converged(solved(span, 96, workspace));
  span.cuts = piece_cuts(plain);
  // The lowest point is in the middle, and everything as far from it to both sides.
  const auto is_cut = [&](double s) {
    return std::any_of(span.cuts.begin(), span.cuts.end(),
                       [&](double cut) { return std::abs(cut - s) < 2e-3; });
  };
  EXPECT_TRUE(is_cut(0.5));
  for (const double cut : span.cuts) EXPECT_TRUE(is_cut(1 - cut)) << cut;
  // With as many unknowns the last coefficients are smaller by orders of magnitude.
  constexpr int terms = 24;
  SpanWorkspace other;
  const SpanSolution cut = test::converged(solved(span, terms, other));
  const int as_many = terms * cut.model->pieces() / plain.model->pieces();
  const SpanSolution uncut = solved(hairpin(), as_many, workspace);
  printf("cut %d pieces tail %g; uncut %d pieces x %d tail %g\n", cut.model->pieces(),
         cut.model->truncation(cut.x), plain.model->pieces(), as_many,
         uncut.model->truncation(uncut.x));
  EXPECT_LT(cut.model->truncation(cut.x), 1e-2 * uncut.model->truncation(uncut.x));
}

TEST(PieceCuts, ResolveSoftRodsBetweenManyGrips) {
  // These scenes were refused before elements ended where a shape requires it, before initial
  // guesses included the effect of loads across a taut part, and before minima of polygons were
  // followed with all terms.
  for (const std::uint64_t number : {16, 19, 111, 127, 215, 245, 282, 341, 373}) {
    SCOPED_TRACE(number);
    const Problem problem = test::random_problem(number, test::RandomSpace::mixed);
    const Equilibrium energy = test::converged(solve_energy(problem));
    EXPECT_LT(test::defects_of(problem, energy).worst(), 1e-6);
    // Multiple shooting does not converge for a force of 1e8 EI/l^2.
    if (number == 19) continue;
    const Equilibrium exact = test::converged(solve_exact(problem, {.start = &energy}));
    double distance = 1;
    EXPECT_EQ(test::agreement_of(problem, energy, exact, distance), test::Agreement::same)
        << distance;
  }
}

TEST(PieceCuts, OfAShapeAreThoseThatItIsFinishedOn) {
  SpanWorkspace workspace;
  Span span = hairpin();
  span.cuts = piece_cuts(solved(span, 96, workspace));
  const SpanSolution cut = test::converged(solved(span, 0, workspace));
  ASSERT_GT(cut.model->pieces(), 1);
  // The span that it is a shape of need not have them.
  const SpanSolution finished = test::converged(finish(cut, SpanOptions(), workspace));
  EXPECT_EQ(finished.model->pieces(), cut.model->pieces());
  EXPECT_NEAR(finished.energy, cut.energy, 1e-9 * std::abs(cut.energy));
}

}  // namespace
}  // namespace dlo::energy_model
