#pragma once

#include <string>
#include <vector>

#include "dlo/energy_model/energy.hpp"

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
inline void note_left_out(SearchLog* log, const std::string& what) {
  if (log != nullptr) log->leave_out(what);
}

}  // namespace dlo::energy_model
