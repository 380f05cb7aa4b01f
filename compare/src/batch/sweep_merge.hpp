#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dlo::compare {

/// What happened to the rows of a sweep's file.
struct SweepOutcome {
  std::int64_t rows = 0;            ///< in the file
  std::int64_t found = 0;           ///< of them, those that an earlier run had left
  std::int64_t without_result = 0;  ///< of them, those whose status is not ok
};

/// Puts the shards of a sweep together, in any order of files. The result is what one run over the
/// whole grid would have written.
/// @throws InputError naming the file, and nothing is written, if a file is no shard, is damaged or
/// not finished, if shards belong to different sweeps, overlap, or leave rows out, or if `path` is
/// refused by output_target();  @throws OutputError if writing fails
SweepOutcome merge_sweep(const std::vector<std::string>& files, const std::string& path);

}  // namespace dlo::compare
