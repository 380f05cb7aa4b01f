#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "batch/sweep.hpp"

namespace dlo::compare {

/// Part `index` of `count` of a sweep, 1 <= index <= count.
struct Shard {
  std::int64_t index = 1;  ///< 1 <= index <= count
  std::int64_t count = 1;  ///< of shards
  std::string source;      ///< the environment variables it was taken from, if it was

  [[nodiscard]] std::string name() const;  ///< "2/4"
};

/// Reads "2/4". @throws InputError
[[nodiscard]] Shard parse_shard(const std::string& text);

/// The shard of this process as a scheduler says it: SLURM_ARRAY_TASK_ID with _MIN, _COUNT (and
/// _STEP, _MAX, if they are set) of a Slurm job array; OMPI_COMM_WORLD_RANK and _SIZE of Open MPI's
/// mpirun; of an array of MPI jobs every rank of every task is one. Nothing if neither is set.
/// @param variable  value of an environment variable, or nullptr
/// @throws InputError if the variables contradict each other, or if an array's numbers have gaps,
/// so that what the other tasks compute is not known
[[nodiscard]] std::optional<Shard> shard_from_environment(
    const std::function<const char*(const char*)>& variable);

/// The rows of a shard: blocks in order, whose sizes differ by one row at most.
[[nodiscard]] RowRange rows_of(const Shard& shard, std::int64_t rows);

}  // namespace dlo::compare
