#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace dlo::energy_model {

/// Cross-sections at arc lengths, followed from those at the nodes of a shot before them, and from
/// one to the next within an interval. That at the end is followed too: a last node may lie beyond
/// what a grip there exerts.
/// @param nodes   arc lengths of the nodes, growing;  @param states  there, as many
/// @param s       growing within an interval
/// @param follow  follow(interval, from, to, state) brings a cross-section on
template <typename State, typename Follow>
std::vector<State> states_between(const Eigen::VectorXd& nodes, const std::vector<State>& states,
                                  const std::vector<double>& s, const Follow& follow) {
  const Eigen::Index last = nodes.size() - 2;
  std::vector<State> result;
  result.reserve(s.size());
  State state;
  Eigen::Index interval = -1;
  double reached = 0;
  for (const double at : s) {
    const Eigen::Index after = std::upper_bound(nodes.begin(), nodes.end(), at) - nodes.begin();
    const Eigen::Index i = std::clamp<Eigen::Index>(after - 1, 0, last);
    if (i != interval) {
      state = states[static_cast<std::size_t>(i)];
      interval = i;
      reached = nodes[i];
    }
    if (at > reached) follow(i, reached, at, state);
    reached = at;
    result.push_back(state);
  }
  return result;
}

}  // namespace dlo::energy_model
