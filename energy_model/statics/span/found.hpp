#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/turns.hpp"
#include "span/span_options.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Log of a search for all equilibria: the strategies tried, in the order of their first use, and
/// what was omitted, each reason once.
class SearchLog {
 public:
  void count_tried(const std::string& strategy, int starts = 1) {
    entry_of(strategy).tried += starts;
  }
  /// Counts equilibria that this strategy found first.
  void count_found(const std::string& strategy, int equilibria = 1) {
    entry_of(strategy).new_equilibria += equilibria;
  }
  void add_omitted(const std::string& what);

  /// Adds what another search has tried and omitted; its equilibria do not count.
  void add_starts(const SearchLog& other, const std::string& suffix);

  [[nodiscard]] int starts() const;
  [[nodiscard]] const std::vector<SearchStrategy>& strategies() const { return strategies_; }
  [[nodiscard]] const std::vector<std::string>& omitted() const { return omitted_; }

 private:
  SearchStrategy& entry_of(const std::string& strategy);

  std::vector<SearchStrategy> strategies_;
  std::vector<std::string> omitted_;
};

inline void log_tried(SearchLog* log, const std::string& strategy) {
  if (log != nullptr) log->count_tried(strategy);
}
inline void log_found(SearchLog* log, const std::string& strategy) {
  if (log != nullptr) log->count_found(strategy);
}
inline void log_omitted(SearchLog* log, const std::string& what) {
  if (log != nullptr) log->add_omitted(what);
}

/// Whether the time limit has passed. The starts that are left are then omitted, which is added to
/// the log.
[[nodiscard]] inline bool omits_late_starts(const SpanOptions& options) {
  const bool late = options.deadline.passed();
  if (late) log_omitted(options.log, "starts after the time limit");
  return late;
}

/// Whether a solution is a result of the search. A search for all equilibria also includes those at
/// a fold or bifurcation.
[[nodiscard]] inline bool is_result(const SpanSolution& solution, const SpanOptions& options) {
  return solution.is_equilibrium() || (options.wants_all() && solution.is_singular_point());
}

/// Message of a search with prescribed end frames if all equilibria belong to another homotopy
/// class.
inline constexpr const char* no_equilibrium_of_class =
    "no equilibrium was found with the number of turns that the clamps prescribe";

/// Returns the writhe of a shape from its start to its end; std::nullopt as writhe().
[[nodiscard]] std::optional<Writhe> writhe_of(const SpanSolution& solution);

/// Whether the frames along an equilibrium belong to the homotopy class that clamps with these
/// turns prescribe; sets solution.missing_turns. Always true for a round straight rod, whose search
/// prescribes the turns itself, for a solution that is no equilibrium, and if the turns are
/// unknown.
[[nodiscard]] bool belongs_to_class(SpanSolution& solution, const std::optional<double>& turns);

/// Returns a list of one solution. A braced list would copy it.
[[nodiscard]] std::vector<SpanSolution> as_list(SpanSolution solution);

/// Whether two equilibria of one span have the same energy and the same points at three arc
/// lengths; in space, without material directors, also up to a rotation (is_rotated_copy()).
/// @param tolerance  norm of the three points' differences, divided by the span's length; that of
///   energies is 0.01 tolerance (1 + load). The default is for converged shapes
[[nodiscard]] bool is_same_shape(const SpanSolution& a, const SpanSolution& b,
                                 double tolerance = 1e-6);

/// Results of a search: each equilibrium once, or the first failure as long as there is none; the
/// number of all evaluations, and the log of the strategies.
class Found {
 public:
  explicit Found(const SpanOptions& options) : options_(options) {}

  /// Adds the result of one start, and records the strategy in the log unless it is empty.
  /// @return whether it is an equilibrium that was not known
  bool add(SpanSolution solution, const std::string& strategy = {});
  /// Adds evaluations other than those of the added solutions.
  void add_evaluations(int evaluations) { evaluations_ += evaluations; }

  /// Solutions in the order in which they were found.
  [[nodiscard]] const std::vector<SpanSolution>& by_discovery() const { return found_; }
  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] const SpanSolution& operator[](std::size_t i) const { return found_[i]; }
  /// Returns the best solution; there has to be one. Stable shapes come first, then other
  /// equilibria, then other solutions; in each group those without lost turns come first, then
  /// those of lower energy.
  [[nodiscard]] const SpanSolution& best() const;
  /// Whether the search may end: the best solution is stable, and not all equilibria are wanted.
  [[nodiscard]] bool suffices() const {
    return !options_.wants_all() && !empty() && succeeded(best().status);
  }
  /// Whether the equilibrium of lowest energy, among those without lost turns, is stable.
  [[nodiscard]] bool has_stable_lowest() const;
  /// Returns the solutions, best first: all equilibria if they are wanted, otherwise the best one
  /// and the other stable ones. The first one has the number of all evaluations.
  [[nodiscard]] std::vector<SpanSolution> take() &&;

 private:
  const SpanOptions& options_;
  std::vector<SpanSolution> found_;
  int evaluations_ = 0;
};

}  // namespace dlo::energy_model
