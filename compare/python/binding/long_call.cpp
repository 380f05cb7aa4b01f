#include "long_call.hpp"

#include <algorithm>
#include <stdexcept>

namespace dlo::python {
namespace {

constexpr std::chrono::milliseconds between_looks(100);

thread_local Signals* current = nullptr;

/// Number of threads inside a GilReleased that have not been stopped there.
std::atomic<int> calls = 0;
/// Thread that ends the interpreter, which may still compute; empty until then.
std::atomic<std::thread::id> ending_thread{};

bool is_at_exit(std::thread::id thread) {
  const std::thread::id ending = ending_thread;
  return ending != std::thread::id() && ending != thread;
}

/// Blocks a daemon thread, which ends with the process.
[[noreturn]] void wait_for_exit() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

void stop_calls() {
  // A thread that does not check for signals within this time does not notice the end either.
  constexpr std::chrono::seconds longest(5);
  ending_thread = std::this_thread::get_id();
  // Threads that already wait for the GIL get it, and continue in Python.
  const py::gil_scoped_release released;
  const auto begin = std::chrono::steady_clock::now();
  while (calls > 0 && std::chrono::steady_clock::now() - begin < longest) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

GilReleased::GilReleased() {
  ++calls;
  state_ = PyEval_SaveThread();
}

bool GilReleased::take_back() {
  if (state_ == nullptr) return true;
  if (is_at_exit(std::this_thread::get_id())) return false;
  PyEval_RestoreThread(std::exchange(state_, nullptr));
  --calls;
  return true;
}

GilReleased::~GilReleased() {
  if (take_back()) return;
  --calls;
  wait_for_exit();
}

void stop_calls_at_exit(py::module_& /*module*/) {
  py::module_::import("atexit").attr("register")(py::cpp_function(&stop_calls));
}

void CallMutex::lock() {
  refuse_own_thread();
  mutex_.lock();
  owner_ = std::this_thread::get_id();
}

bool CallMutex::try_lock() {
  refuse_own_thread();
  if (!mutex_.try_lock()) return false;
  owner_ = std::this_thread::get_id();
  return true;
}

void CallMutex::unlock() {
  owner_ = std::thread::id();
  mutex_.unlock();
}

void CallMutex::refuse_own_thread() const {
  if (owner_ != std::this_thread::get_id()) return;
  throw std::runtime_error(
      "a call of this object within another one of the same thread (allowed: a signal handler that "
      "sets a flag or raises an exception)");
}

Signals::Signals()
    : next_look_(std::chrono::steady_clock::now() + between_looks), before_(current) {
  current = this;
}

Signals::~Signals() { current = before_; }

bool Signals::stop() {
  if (stopped_.load(std::memory_order_relaxed) || is_at_exit(owner_)) return true;
  if (std::this_thread::get_id() != owner_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return false;
  next_look_ = now + between_looks;
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() == 0) return false;
  error_.emplace();  // stores the exception that was raised
  stopped_.store(true, std::memory_order_relaxed);
  return true;
}

void Signals::throw_if_stopped() {
  if (stop()) throw std::runtime_error("stopped by a signal");
}

void Signals::rethrow() const {
  if (error_) throw py::error_already_set(*error_);
}

long steps_between_looks(long points) {
  constexpr long steps_of_a_point = 400'000;  // at about 10 ns each
  return std::max(1L, steps_of_a_point / std::max(1L, points));
}

bool Signals::asked() { return current != nullptr && current->stop(); }

}  // namespace dlo::python
