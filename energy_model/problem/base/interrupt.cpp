#include "dlo/energy_model/interrupt.hpp"

namespace dlo::energy_model {
namespace {

thread_local bool (*should_stop)() = nullptr;

}  // namespace

Interruption::Interruption(bool (*asked)()) : before_(should_stop) { should_stop = asked; }

Interruption::~Interruption() { should_stop = before_; }

bool interrupted() { return should_stop != nullptr && should_stop(); }

}  // namespace dlo::energy_model
