#include "dlo/energy_model/interrupt.hpp"

namespace dlo::energy_model {
namespace {

thread_local bool (*question)() = nullptr;

}  // namespace

Interruption::Interruption(bool (*asked)()) : before_(question) { question = asked; }

Interruption::~Interruption() { question = before_; }

bool interrupted() { return question != nullptr && question(); }

}  // namespace dlo::energy_model
