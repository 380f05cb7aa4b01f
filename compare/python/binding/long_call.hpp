#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "dlo/energy_model/interrupt.hpp"

namespace dlo::python {

namespace py = pybind11;

/// Looks whether a signal has come, as Ctrl-C, while a computation holds no GIL. Python handles
/// signals on its main thread only: on others it is never told to stop.
class Signals {
 public:
  Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  Signals(Signals&&) = delete;
  Signals& operator=(Signals&&) = delete;
  ~Signals();

  /// Whether a handler has raised an exception; looks ten times a second. From any thread.
  [[nodiscard]] bool stop();
  /// Throws if stop(): out of a callback.
  void throw_if_stopped();
  /// Raises what the handler has raised. With the GIL.
  void rethrow() const;

  /// stop() of the call that this thread is in.
  [[nodiscard]] static bool asked();

 private:
  std::thread::id owner_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point next_look_;
  std::atomic<bool> stopped_ = false;
  std::optional<py::error_already_set> error_;
  Signals* before_;
};

/// Runs what may take long, with the GIL released: other threads of Python go on, and Ctrl-C ends
/// it. @param function  of the call's Signals; must not touch Python
template <typename Function>
auto run_long(const Function& function) {
  Signals signals;
  std::optional<decltype(function(signals))> result;
  try {
    const py::gil_scoped_release release;
    const energy_model::Interruption interruption(Signals::asked);
    result.emplace(function(signals));
  } catch (...) {
    signals.rethrow();
    throw;
  }
  signals.rethrow();
  return std::move(*result);
}

}  // namespace dlo::python
