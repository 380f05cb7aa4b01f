#include "long_call.hpp"

#include <stdexcept>

namespace dlo::python {
namespace {

constexpr std::chrono::milliseconds between_looks(100);

thread_local Signals* current = nullptr;

}  // namespace

Signals::Signals()
    : next_look_(std::chrono::steady_clock::now() + between_looks), before_(current) {
  current = this;
}

Signals::~Signals() { current = before_; }

bool Signals::stop() {
  if (stopped_.load(std::memory_order_relaxed)) return true;
  if (std::this_thread::get_id() != owner_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return false;
  next_look_ = now + between_looks;
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() == 0) return false;
  error_.emplace();  // takes what was raised
  stopped_.store(true, std::memory_order_relaxed);
  return true;
}

void Signals::throw_if_stopped() {
  if (stop()) throw std::runtime_error("stopped by a signal");
}

void Signals::rethrow() const {
  if (error_) throw py::error_already_set(*error_);
}

bool Signals::asked() { return current != nullptr && current->stop(); }

}  // namespace dlo::python
