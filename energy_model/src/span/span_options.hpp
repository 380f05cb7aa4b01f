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
  follow,   ///< by Newton's method, to the equilibrium next to it, stable or not
  descend,  ///< downhill, to a minimum
};

/// Unknowns of a shape that is known, of the same span with its grips elsewhere.
struct KnownShape {
  std::shared_ptr<const SpanEnergy> model;  ///< none: nothing is known
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
  std::shared_ptr<NewtonFactor> factor =
      nullptr;  ///< of Newton's method there; null: there is none
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

}  // namespace dlo::energy_model
