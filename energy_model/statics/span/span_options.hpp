#pragma once

#include <Eigen/Core>
#include <memory>

#include "base/deadline.hpp"
#include "base/pool.hpp"
#include "newton/newton.hpp"
#include "strain/span_energy.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

class SearchLog;

/// Number of unknowns up to which coefficients are added in general: Newton's method factors a
/// dense matrix of this size.
inline constexpr int most_unknowns = 480;

/// Method by which an equilibrium is sought from a given start.
enum class Approach {
  follow,        ///< Newton's method to the equilibrium near it; a descent if that is not stable
  follow_only,   ///< Newton's method from a known shape; nothing else is tried if it fails
  descend,       ///< descent to a minimum
  descend_only,  ///< descent; no search follows if it finds no equilibrium
};

/// Unknowns of a known shape of the same span with its grips in other positions.
struct KnownShape {
  std::shared_ptr<const SpanEnergy> model;  ///< null: nothing is known
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
  std::shared_ptr<NewtonFactor> factor = nullptr;  ///< factor at that shape; null: none is known

  /// Number of coefficients that resolve the shape; 0 if nothing is known.
  [[nodiscard]] int terms() const { return model ? model->terms() : 0; }
};

/// Largest difference of tangents [-] between a shape and the known one from which it was followed;
/// beyond it, Newton's method has converged to another shape.
inline constexpr double largest_followed_change = 0.3;

/// A shape to start from, instead of a search.
struct SpanStart {
  TangentField field;  ///< empty: there is no such shape
  Approach approach = Approach::follow;
  KnownShape known;  ///< the shape of `field`, if it is a span's solution that is followed
};

struct SpanOptions {
  int terms = 0;  ///< 0: as many as `tolerance` needs
  double tolerance = 1e-10;
  int max_evaluations = 2000;
  Deadline deadline;  ///< deadline of the whole solve
  SpanStart start;
  /// Log of a search for all equilibria; null: only the lowest one is wanted.
  SearchLog* log = nullptr;
  /// Counts the starts that pass obstacles on another side; null: not counted.
  int* other_side_starts = nullptr;

  [[nodiscard]] bool wants_all() const { return log != nullptr; }
  [[nodiscard]] bool only_follows() const { return start.approach == Approach::follow_only; }
  /// Whether the search ends at the result of a descent from the start.
  [[nodiscard]] bool only_descends() const { return start.approach == Approach::descend_only; }
};

/// Buffers that are kept from one solve to the next: models that no solution holds any more are
/// reused.
class SpanWorkspace {
 public:
  [[nodiscard]] std::shared_ptr<SpanEnergy> model(const Span& span, int terms);
  /// Returns a solution with a model but without unknowns.
  [[nodiscard]] SpanSolution empty_solution(const Span& span, int terms);
  /// Returns a solution's unknowns with another number of coefficients; not an equilibrium yet.
  [[nodiscard]] SpanSolution with_terms(const SpanSolution& solution, int terms);
  [[nodiscard]] NewtonBuffers& newton() { return newton_; }

 private:
  Pool<SpanEnergy> models_;
  NewtonBuffers newton_;
};

}  // namespace dlo::energy_model
