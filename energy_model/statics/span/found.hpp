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

/// What a search for all equilibria has looked from, strategies in the order of their first use,
/// and what it has left out, each reason once.
class SearchLog {
 public:
  void tried(const std::string& strategy, int starts = 1) { of(strategy).tried += starts; }
  /// An equilibrium that nothing had led to before.
  void found(const std::string& strategy, int equilibria = 1) {
    of(strategy).found_first += equilibria;
  }
  void leave_out(const std::string& what);

  /// What another search has tried and left out, none of whose equilibria count.
  void add_starts(const SearchLog& other, const std::string& suffix);

  [[nodiscard]] int starts() const;
  [[nodiscard]] const std::vector<SearchStrategy>& looked_from() const { return looked_from_; }
  [[nodiscard]] const std::vector<std::string>& not_looked() const { return not_looked_; }

 private:
  SearchStrategy& of(const std::string& strategy);

  std::vector<SearchStrategy> looked_from_;
  std::vector<std::string> not_looked_;
};

/// What is noted where there is a log.
inline void note_tried(SearchLog* log, const std::string& strategy) {
  if (log != nullptr) log->tried(strategy);
}
inline void note_found(SearchLog* log, const std::string& strategy) {
  if (log != nullptr) log->found(strategy);
}
inline void note_not_tried(SearchLog* log, const std::string& what) {
  if (log != nullptr) log->leave_out(what);
}

/// Difference of points over the length up to which shapes that Newton's method has found are one.
inline constexpr double same_points = 1e-6;

/// Whether a solution is one of those that are looked for: among all equilibria those that a fold
/// or a bifurcation leaves open count too.
[[nodiscard]] inline bool counts(const SpanSolution& solution, const SpanOptions& options) {
  return solution.is_equilibrium() || (options.wants_all() && solution.is_singular_point());
}

/// Message of a search between held frames whose equilibria are all of the other homotopy class.
inline constexpr const char* no_equilibrium_of_class =
    "no equilibrium was found with the turns of the clamps";

/// Returns the writhe of a shape from its start to its end; empty as writhe().
[[nodiscard]] std::optional<Writhe> writhe_of(const SpanSolution& solution);

/// Whether the frames along an equilibrium are a path of the homotopy class that clamps with these
/// turns hold; notes how many turns it lacks. Always true of a round straight rod, which is twisted
/// to its turns, and if the turns are not known.
[[nodiscard]] bool is_of_class(SpanSolution& solution, const std::optional<double>& turns);

/// A braced list would copy it.
[[nodiscard]] std::vector<SpanSolution> list_of(SpanSolution solution);

/// Two equilibria of one span that are the same but for rounding and, in space, for rigid-body
/// modes.
[[nodiscard]] bool is_same_shape(const SpanSolution& a, const SpanSolution& b,
                                 double tolerance = same_points);

/// The equilibria that a search has come to, each once, or its first failure while there is none;
/// the evaluations of everything that it has looked at, and the log of what has led to them.
class Found {
 public:
  explicit Found(const SpanOptions& options) : options_(options) {}

  /// What a start has led to. @return whether it is an equilibrium that was not known
  bool add(SpanSolution solution);
  /// The same, noted in the log.
  bool add(SpanSolution solution, const std::string& strategy);
  /// Evaluations besides those of what is added.
  void spend(int evaluations) { evaluations_ += evaluations; }

  /// In the order in which they were found.
  [[nodiscard]] const std::vector<SpanSolution>& in_order() const { return found_; }
  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] const SpanSolution& operator[](std::size_t i) const { return found_[i]; }
  /// Stable shapes come first, then other equilibria, then the rest, each by energy; there is one.
  [[nodiscard]] const SpanSolution& best() const;
  /// Whether what is wanted has been found: the best one is stable, and not all are wanted.
  [[nodiscard]] bool suffices() const {
    return !options_.wants_all() && !empty() && succeeded(best().status);
  }
  /// Whether the lowest of the equilibria that have not lost turns can hold itself.
  [[nodiscard]] bool has_stable_lowest() const;
  /// Best first: all equilibria if they are wanted, else the best one and the other stable ones.
  /// The first one has the evaluations of all.
  [[nodiscard]] std::vector<SpanSolution> take() &&;

 private:
  const SpanOptions& options_;
  std::vector<SpanSolution> found_;
  int evaluations_ = 0;
};

}  // namespace dlo::energy_model
