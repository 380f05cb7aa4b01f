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

/// No GIL in its scope. At the end of the interpreter Python ends a thread that asks for the GIL in
/// a way that no destructor lets through: such a thread is stopped here instead, and waits for the
/// end of the process.
class GilReleased {
 public:
  GilReleased();
  ~GilReleased();
  GilReleased(const GilReleased&) = delete;
  GilReleased& operator=(const GilReleased&) = delete;

  /// Takes the GIL before the scope's end; false if this thread will be stopped at that.
  [[nodiscard]] bool take_back();

 private:
  PyThreadState* state_;
};

/// Has the interpreter's end stop the calls of other threads, those of daemons, and wait for that.
/// @param module  the one that is being imported
void stop_calls_at_exit(py::module_& module);

/// What one call uses at a time. A handler of a signal, which runs within a call of its own thread,
/// would wait for itself: it is refused.
class CallMutex {
 public:
  /// @throws std::runtime_error if this thread has it
  void lock();
  /// @throws std::runtime_error if this thread has it
  [[nodiscard]] bool try_lock();
  void unlock();

 private:
  void refuse_own_thread() const;

  std::mutex mutex_;
  std::atomic<std::thread::id> owner_{};
};

/// Looks whether a signal has come, as Ctrl-C, while a computation holds no GIL. Python handles
/// signals on its main thread only: on others it is never told to stop.
class Signals {
 public:
  Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
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

/// Steps of a force model of so many points, of all its rods together, between two looks whether a
/// signal has come: some milliseconds, whatever the size of the model.
[[nodiscard]] long steps_between_looks(long points);

/// Runs what may take long, with the GIL released: other threads of Python go on, and Ctrl-C ends
/// it. @param function  of the call's Signals; must not touch Python
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
