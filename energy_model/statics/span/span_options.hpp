#pragma once

#include <Eigen/Core>
#include <memory>

#include "base/deadline.hpp"
#include "strain/span_energy.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

class SearchLog;

/// Newton's method factors a dense matrix of this size at most.
inline constexpr int most_unknowns = 480;

/// How a given start is left.
enum class Approach {
  follow,        ///< by Newton's method, to the equilibrium next to it, stable or not
  follow_only,   ///< the same from a known shape; where that does not lead on, no
                 ///< other way is tried
  descend,       ///< downhill, to a minimum
  descend_only,  ///< the same; where that leads to no equilibrium, no search follows
};

/// Unknowns of a shape that is known, of the same span with its grips elsewhere.
struct KnownShape {
  std::shared_ptr<const SpanEnergy> model;  ///< none: nothing is known
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
  std::shared_ptr<NewtonFactor> factor = nullptr;  ///< there; null: none is known

  /// That resolve it.
  [[nodiscard]] int terms() const { return model ? model->terms() : 0; }
};

/// Tangents by which a shape may differ from the known one that it follows [-]: beyond, Newton's
/// method has gone somewhere else.
inline constexpr double followed_tangents = 0.3;

/// A shape to begin with instead of a search.
struct SpanStart {
  TangentField field;  ///< none: there is no such shape
  Approach approach = Approach::follow;
  KnownShape known;   ///< what `field` shows, if it is a span's solution that is
                      ///< followed
  KnownShape before;  ///< the shape known before that one, on the same way
};

struct SpanOptions {
  int terms = 0;  ///< 0: as many as `tolerance` needs
  double tolerance = 1e-10;
  int max_evaluations = 2000;
  Deadline deadline;  ///< of the whole solve
  SpanStart start;
  /// Of a search for every equilibrium that the starts lead to; null: the lowest one is wanted.
  SearchLog* log = nullptr;
  /// Counts the starts that pass obstacles on another side; null: nobody asks.
  int* passing_starts = nullptr;

  [[nodiscard]] bool wants_all() const { return log != nullptr; }
  [[nodiscard]] bool only_follows() const { return start.approach == Approach::follow_only; }
  /// Whether the search ends where a descent from the start does.
  [[nodiscard]] bool only_descends() const { return start.approach == Approach::descend_only; }
  /// Whether a start is left downhill before Newton's method is tried.
  [[nodiscard]] bool descends() const {
    return start.approach == Approach::descend || only_descends();
  }
};

}  // namespace dlo::energy_model
