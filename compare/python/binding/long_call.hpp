#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "dlo/energy_model/interrupt.hpp"

namespace dlo::python {

namespace py = pybind11;

/// Releases the GIL during its lifetime. At the end of the interpreter, Python ends threads that
/// request the GIL in a way that skips destructors. Such a thread is stopped here instead, and
/// waits for the end of the process.
class GilReleased {
 public:
  GilReleased();
  ~GilReleased();
  GilReleased(const GilReleased&) = delete;
  GilReleased& operator=(const GilReleased&) = delete;

  /// Takes the GIL before the end of the scope; returns false if this thread will be stopped there.
  [[nodiscard]] bool take_back();

 private:
  PyThreadState* state_;
};

/// Makes the end of the interpreter stop the calls of other threads, which are daemons, and wait up
/// to five seconds for it.
/// @param module  the module that is being imported
void stop_calls_at_exit(py::module_& module);

/// Mutex of data that one call uses at a time. A signal handler runs within a call of its own
/// thread and would deadlock: it is refused.
class CallMutex {
 public:
  /// Locks the mutex. @throws std::runtime_error if this thread owns the mutex
  void lock();
  /// Locks the mutex if it is free. @return whether it was free
  /// @throws std::runtime_error if this thread owns the mutex
  [[nodiscard]] bool try_lock();
  void unlock();

 private:
  void refuse_own_thread() const;

  std::mutex mutex_;
  std::atomic<std::thread::id> owner_{};
};

/// Checks for signals, such as Ctrl-C, during a computation without the GIL. Python handles signals
/// on its main thread only: calls of other threads stop only at the end of the interpreter.
class Signals {
 public:
  Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals();

  /// Whether a handler has raised an exception, for which it checks ten times per second on the
  /// call's own thread, or another thread ends the interpreter. May be called from any thread.
  [[nodiscard]] bool stop();
  /// Throws an exception if stop(), to leave a callback.
  void throw_if_stopped();
  /// Raises the exception that the handler has raised, if any. Requires the GIL.
  void rethrow() const;

  /// Returns stop() of the call in which this thread is; false outside of a call.
  [[nodiscard]] static bool asked();

 private:
  std::thread::id owner_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point next_look_;
  std::atomic<bool> stopped_ = false;
  std::optional<py::error_already_set> error_;
  Signals* before_;
};

/// Returns the number of steps between two checks for signals: some milliseconds for any size of
/// the model. @param points  points of all its rods together
[[nodiscard]] long steps_between_looks(long points);

/// Runs a long computation with the GIL released, so that other threads of Python continue and
/// Ctrl-C ends it. @param function  receives the call's Signals; must not use Python
template <typename Function>
auto run_long(const Function& function) {
  Signals signals;
  std::optional<decltype(function(signals))> result;
  try {
    const GilReleased released;
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
