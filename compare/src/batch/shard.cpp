#include "batch/shard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

constexpr std::int64_t most_shards = 1'000'000'000;

/// One counter of a scheduler: this process is `index` of `count`, from 0.
struct Place {
  std::int64_t index = 0;
  std::int64_t count = 1;
};

using Variable = std::function<const char*(const char*)>;

std::optional<std::int64_t> integer_variable(const Variable& variable, const char* name) {
  const char* text = variable(name);
  if (text == nullptr) return std::nullopt;
  const auto value = as_number<std::int64_t>(text);
  if (!value) {
    throw InputError(fmt::format("environment: {} = {}: must be a whole number", name, text));
  }
  return value;
}

std::int64_t needed_variable(const Variable& variable, const char* name, const char* beside) {
  const auto value = integer_variable(variable, name);
  if (!value) {
    throw InputError(fmt::format(
        "environment: {} is set, {} is not (allowed: both, none, or --shard i/n)", beside, name));
  }
  return *value;
}

Place checked(const Place& place, const std::string& what) {
  if (place.count >= 1 && place.count <= most_shards && place.index >= 0 &&
      place.index < place.count) {
    return place;
  }
  throw InputError(
      fmt::format("environment: {}: number {} of {} (allowed: 0 to count - 1, or "
                  "--shard i/n)",
                  what, place.index, place.count));
}

std::optional<Place> slurm_place(const Variable& variable) {
  const auto id = integer_variable(variable, "SLURM_ARRAY_TASK_ID");
  if (!id) return std::nullopt;
  const char* beside = "SLURM_ARRAY_TASK_ID";
  const std::int64_t least = needed_variable(variable, "SLURM_ARRAY_TASK_MIN", beside);
  const std::int64_t count = needed_variable(variable, "SLURM_ARRAY_TASK_COUNT", beside);
  const std::int64_t step = integer_variable(variable, "SLURM_ARRAY_TASK_STEP").value_or(1);
  const std::int64_t last = least + step * (count - 1);
  const auto most = integer_variable(variable, "SLURM_ARRAY_TASK_MAX");
  if (step < 1 || (*id - least) % step != 0 || (most && *most != last)) {
    throw InputError(fmt::format(
        "environment: SLURM_ARRAY_TASK_ID = {}: the array has gaps, {} tasks from {} in steps of "
        "{} (allowed: equal steps such as --array=1-8, or --shard i/n)",
        *id, count, least, step));
  }
  return checked({(*id - least) / step, count}, beside);
}

std::optional<Place> mpi_place(const Variable& variable) {
  const auto rank = integer_variable(variable, "OMPI_COMM_WORLD_RANK");
  if (!rank) return std::nullopt;
  const char* beside = "OMPI_COMM_WORLD_RANK";
  return checked({*rank, needed_variable(variable, "OMPI_COMM_WORLD_SIZE", beside)}, beside);
}

}  // namespace

std::string Shard::name() const { return fmt::format("{}/{}", index, count); }

Shard parse_shard(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto index = as_number<std::int64_t>(std::string_view(text).substr(0, slash));
  const auto count =
      as_number<std::int64_t>(std::string_view(text).substr(std::min(slash + 1, text.size())));
  if (!index || !count || *index < 1 || *index > *count || *count > most_shards) {
    throw InputError(
        fmt::format("--shard {}: must be i/n (allowed: 1 <= i <= n <= {})", text, most_shards));
  }
  return {*index, *count, ""};
}

std::optional<Shard> shard_from_environment(const Variable& variable) {
  const std::optional<Place> task = slurm_place(variable);
  const std::optional<Place> rank = mpi_place(variable);
  if (!task && !rank) return std::nullopt;
  const Place outer = task.value_or(Place{});
  const Place inner = rank.value_or(Place{});
  Shard shard{outer.index * inner.count + inner.index + 1, outer.count * inner.count, ""};
  if (task) shard.source = "SLURM_ARRAY_TASK_ID";
  if (rank) shard.source += task ? ", OMPI_COMM_WORLD_RANK" : "OMPI_COMM_WORLD_RANK";
  return shard;
}

RowRange rows_of(const Shard& shard, std::int64_t rows) {
  // The first rows % count shards have one row more. No product can overflow.
  const std::int64_t size = rows / shard.count;
  const std::int64_t longer = rows % shard.count;
  const auto begin = [&](std::int64_t index) { return index * size + std::min(index, longer); };
  return {begin(shard.index - 1), begin(shard.index)};
}

}  // namespace dlo::compare
