#include <malloc.h>
#include <unistd.h>

#include <climits>
#include <csignal>
#include <exception>
#include <string>
#include <vector>

#include "base/output_file.hpp"
#include "base/temporary_path.hpp"
#include "option/output.hpp"
#include "run_command.hpp"

namespace {

using dlo::cli::ExitStatus;

/// Ends the process without a message, like other programs whose output nobody reads.
[[noreturn]] void end_with_broken_pipe() {
  (void)std::signal(SIGPIPE, SIG_DFL);
  (void)std::raise(SIGPIPE);
  ::_exit(dlo::cli::broken_pipe_status);  // if the caller has blocked the signal
}

/// Returns the exit status of the exception that is being handled, unless it ends the process.
ExitStatus status_of_exception() {
  try {
    return dlo::cli::report_exception();
  } catch (const dlo::compare::BrokenPipe&) {
    end_with_broken_pipe();
  }
}

/// Keeps freed memory in the process. A solve allocates and frees some megabytes of matrices.
/// Returning them to the system and allocating them again costs up to three times as much as the
/// computation.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int largest_threshold = 32 << 20;  // bytes, the largest value that malloc accepts
  (void)mallopt(M_MMAP_THRESHOLD, largest_threshold);
  (void)mallopt(M_TRIM_THRESHOLD, INT_MAX);
#endif
}

/// Ends the process with a message and an exit status after an exception that no caller can catch,
/// such as a lack of memory in a thread of the scheduler.
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
  // Writes beyond the file size limit, or to a pipe that nobody reads, are errors.
  (void)std::signal(SIGXFSZ, SIG_IGN);
  (void)std::signal(SIGPIPE, SIG_IGN);
  std::set_terminate(end_uncaught);
  try {
    const int status = dlo::cli::run_command({argv + 1, argv + argc});
    dlo::cli::close_standard_output();
    return status;
  } catch (...) {
    return static_cast<int>(status_of_exception());
  }
}
