#include "span/search_log.hpp"

#include <algorithm>

namespace dlo::energy_model {

SearchStrategy& SearchLog::of(const std::string& strategy) {
  const auto known =
      std::find_if(looked_from_.begin(), looked_from_.end(),
                   [&](const SearchStrategy& other) { return other.name == strategy; });
  if (known != looked_from_.end()) return *known;
  looked_from_.push_back({strategy, 0, 0});
  return looked_from_.back();
}

void SearchLog::leave_out(const std::string& what) {
  if (std::find(not_looked_.begin(), not_looked_.end(), what) != not_looked_.end()) return;
  not_looked_.push_back(what);
}

void SearchLog::add_starts(const SearchLog& other, const std::string& suffix) {
  for (const SearchStrategy& strategy : other.looked_from_) {
    tried(strategy.name + suffix, strategy.tried);
  }
  for (const std::string& what : other.not_looked_) leave_out(what);
}

int SearchLog::starts() const {
  int sum = 0;
  for (const SearchStrategy& strategy : looked_from_) sum += strategy.tried;
  return sum;
}

}  // namespace dlo::energy_model
