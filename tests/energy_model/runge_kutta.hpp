#pragma once

#include "../helpers.hpp"

namespace dlo::test {

/// Makes one step of the classical Runge-Kutta method, of order four.
/// @param rate  of the state, by position (or time) and state
template <class Real, class State, class Rate>
State runge_kutta(const Rate& rate, Real at, const State& state, Real step) {
  const State a = rate(at, state);
  const State b = rate(at + step / 2, State(state + step / 2 * a));
  const State c = rate(at + step / 2, State(state + step / 2 * b));
  const State d = rate(at + step, State(state + step * c));
  return state + step / 6 * (a + 2 * b + 2 * c + d);
}

}  // namespace dlo::test
