#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/status.hpp"
#include "newton/newton.hpp"
#include "strain/span_energy.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

class SearchLog;

/// Starts, in the order of their energy, that the search for the lowest minimum follows.
inline constexpr std::size_t followed_starts = 2;
/// The same of a rod with material directors, whose lowest shape is harder to guess.
inline constexpr std::size_t followed_natural_starts = 6;

/// Gradient norm at which a descent hands over: two Newton steps square it to below rounding, while
/// a line search, which compares energies, would stall near the root of the rounding error.
inline constexpr double handover_gradient = 1e-5;

/// Its step [rad] below which Newton's method goes on alone.
inline constexpr double handover_step = 0.1;

/// Newton's method factors a dense matrix of this size at most.
inline constexpr int most_unknowns = 480;

/// How a given start is left.
enum class Approach {
  follow,   ///< by Newton's method, to the equilibrium next to it, stable or not
  descend,  ///< downhill, to a minimum
};

/// Unknowns of a shape that is known, of the same span with its grips elsewhere.
struct KnownShape {
  std::shared_ptr<const SpanEnergy> model;  ///< none: nothing is known
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
};

/// Tangents by which a shape may differ from the known one that it follows [-]: beyond, Newton's
/// method has gone somewhere else.
inline constexpr double followed_tangents = 0.3;

struct SpanOptions {
  int terms = 0;  ///< 0: as many as `tolerance` needs
  double tolerance = 1e-10;
  int max_evaluations = 2000;
  bool all = false;                      ///< every equilibrium that the starts lead to
  TangentField start;                    ///< instead of the search
  Approach approach = Approach::follow;  ///< from `start`
  KnownShape before;                     ///< the shape known before that one, on the same way
  KnownShape known;                      ///< what `start` shows, if it is a span's solution that
                                         ///< is followed: where it gives way it is left
  bool only_known = false;               ///< where Newton's method does not lead on from
                                         ///< `known`, no other way is tried
  int least_terms = 0;                   ///< what resolves the start
  Deadline deadline;                     ///< of the whole solve
  SearchLog* log = nullptr;              ///< of a search for all, if it is asked for
};

/// Buffers that survive a solve: models that no solution holds any more are used again.
class SpanWorkspace {
 public:
  [[nodiscard]] std::shared_ptr<SpanEnergy> model(const Span& span, int terms);
  [[nodiscard]] Newton& newton() { return newton_; }

 private:
  std::vector<std::shared_ptr<SpanEnergy>> models_;
  Newton newton_;
};

/// Difference of points over the length up to which polished shapes are one.
inline constexpr double same_points = 1e-6;

/// Two equilibria of one span that are the same but for rounding and, in space, for free turns.
[[nodiscard]] bool is_same_shape(const SpanSolution& a, const SpanSolution& b,
                                 double tolerance = same_points);

/// Equilibria of a span, lowest energy first: the search's best one, or all of them. Never empty; a
/// failure is a single solution that says so.
[[nodiscard]] std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options,
                                                   SpanWorkspace& workspace);

/// From an equilibrium of the span with too few terms to one with enough, and certified.
[[nodiscard]] SpanSolution finish_span(const Span& span, const SpanOptions& options,
                                       SpanWorkspace& workspace, SpanSolution solution);

}  // namespace dlo::energy_model
