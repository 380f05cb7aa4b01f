#include <malloc.h>
#include <unistd.h>

#include <climits>
#include <csignal>
#include <exception>
#include <string>
#include <vector>

#include "base/output_file.hpp"
#include "base/temporary_path.hpp"
#include "option/exit_status.hpp"
#include "option/output.hpp"
#include "run_command.hpp"

namespace {

using dlo::cli::ExitStatus;

/// Nobody reads the output: as other programs, gone without a word.
[[noreturn]] void end_with_broken_pipe() {
  (void)std::signal(SIGPIPE, SIG_DFL);
  (void)std::raise(SIGPIPE);
  ::_exit(dlo::cli::broken_pipe_status);  // if the caller has blocked the signal
}

/// The exit status of what is being handled, unless that ends the process.
ExitStatus status_of_exception() {
  try {
    return dlo::cli::report_exception();
  } catch (const dlo::compare::BrokenPipe&) {
    end_with_broken_pipe();
  }
}

/// Memory that is freed stays with the process. A solve takes and frees some megabytes of matrices;
/// to return them to the system and take them again costs up to three times what is computed with
/// them.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int largest_threshold = 32 << 20;  // bytes, of those that malloc takes
  (void)mallopt(M_MMAP_THRESHOLD, largest_threshold);
  (void)mallopt(M_TRIM_THRESHOLD, INT_MAX);
#endif
}

/// What no caller could catch, such as memory that a thread of the scheduler does not get, ends
/// like anything else: with a line and a status.
[[noreturn]] void end_uncaught() {
  ExitStatus status = ExitStatus::no_resources;
  if (std::current_exception()) {
    status = status_of_exception();
  } else {
    dlo::cli::write_standard_error("dlo: internal error\n");
  }
  dlo::compare::end_groups();
  ::_exit(static_cast<int>(status));
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  dlo::cli::reserve_standard_descriptors();
  dlo::compare::end_groups_at_signals();
  // A limit of a file's size is an error of its write.
  (void)std::signal(SIGXFSZ, SIG_IGN);
  std::set_terminate(end_uncaught);
  try {
    const int status = dlo::cli::run_command({argv + 1, argv + argc});
    dlo::cli::close_standard_output();
    return status;
  } catch (...) {
    return static_cast<int>(status_of_exception());
  }
}
