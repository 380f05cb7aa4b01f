#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "batch/shard.hpp"
#include "batch/sweep.hpp"
#include "batch/sweep_merge.hpp"
#include "dlo/compare/progress.hpp"

namespace dlo::compare {

/// How a sweep is written.
struct SweepFileOptions {
  int threads = 0;       ///< 0: all cores
  bool restart = false;  ///< throw away what an earlier run has left
  /// Called after every row with the rows that are done and all rows.
  Progress progress;
  /// Called once, before anything is computed, with the rows that an earlier run has left, if any.
  std::function<void(std::int64_t rows)> resumed;
};

/// First line of a file that is not a whole sweep: fingerprints of the scene (with its name and the
/// known materials), of the grid and of the options, the model, the shard and its rows.
[[nodiscard]] std::string sweep_identity(const Sweep& sweep, const std::optional<Shard>& shard);

/// Computes a sweep, or a shard of it, into a CSV file.
///
/// Rows are appended in order to `name`.part, whose first line is sweep_identity(). A run that
/// finds such a file goes on behind its last whole line, a torn one is cut off; so a run may be
/// killed at any moment and no row is lost or written twice. The file is locked while a process
/// writes it. In the end a whole sweep is put into `name` at once, without its first line; a shard
/// keeps it. A shard that is in `name` already is left as it is. Links are followed, `.part` is
/// then beside their target. A device or a pipe gets the rows as they come and nothing is kept.
/// @throws InputError if `name` is refused by output_target(), or if the files cannot be opened,
/// belong to another sweep or to a process that still writes them;  @throws OutputError if writing
/// fails
SweepOutcome write_sweep(const Sweep& sweep, const std::optional<Shard>& shard,
                         const std::string& name, const SweepFileOptions& options = {});

}  // namespace dlo::compare
