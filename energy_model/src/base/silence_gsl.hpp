#pragma once

#include <gsl/gsl_errno.h>

namespace dlo::energy_model {

/// GSL aborts the program on errors unless told otherwise; every call looks at its result instead.
inline void silence_gsl() {
  static const bool silent = gsl_set_error_handler_off() != nullptr;
  (void)silent;
}

}  // namespace dlo::energy_model
