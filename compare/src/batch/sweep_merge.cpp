#include "batch/sweep_merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/output_file.hpp"
#include "batch/read_sweep.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

struct ShardFile {
  std::string path;
  SweepHead head;
  std::string columns;
};

ShardFile open_shard(const std::string& path) {
  LineReader reader(path);
  std::string line;
  ShardFile shard{path, {}, {}};
  const std::optional<SweepHead> head = reader.next(line) ? parse_sweep_head(line) : std::nullopt;
  if (!head) {
    throw InputError(fmt::format(
        "{}: is no shard of a sweep (allowed: files that dlo sweep --shard i/n has finished)",
        path));
  }
  shard.head = *head;
  if (!reader.next(shard.columns)) {
    throw InputError(
        fmt::format("{}: not finished, it has no row yet (allowed: run its sweep "
                    "again, it goes on)",
                    path));
  }
  return shard;
}

/// All of one sweep, in the order of their rows, with no row twice and none left out.
void require_whole(const std::vector<ShardFile>& shards) {
  const ShardFile& front = shards.front();
  std::int64_t next = 0;
  const ShardFile* before = nullptr;
  for (const ShardFile& shard : shards) {
    const SweepHead& head = shard.head;
    if (head.identity != front.head.identity || head.rows != front.head.rows ||
        shard.columns != front.columns) {
      throw InputError(fmt::format("{}: belongs to another sweep than {}: {} and {}", shard.path,
                                   front.path, head.identity, front.head.identity));
    }
    if (head.range.first < next) {
      throw InputError(fmt::format("{}: shard {} has rows that {} (shard {}) has too", shard.path,
                                   head.shard, before->path, before->head.shard));
    }
    if (head.range.first > next) break;
    next = head.range.last;
    before = &shard;
  }
  if (next == front.head.rows) return;
  const auto after = std::find_if(shards.begin(), shards.end(),
                                  [&](const auto& shard) { return shard.head.range.first > next; });
  const std::int64_t end = after == shards.end() ? front.head.rows : after->head.range.first;
  throw InputError(fmt::format("--merge: rows {} to {} of {} are missing (shards given: {})", next,
                               end - 1, front.head.rows, shards.size()));
}

void append_rows(const ShardFile& shard, OutputFile& target, SweepOutcome& outcome) {
  LineReader reader(shard.path);
  std::string line;
  for (int preamble = 0; preamble < 2; ++preamble) (void)reader.next(line);
  const std::int64_t fields = fields_of(shard.columns);
  constexpr std::size_t block = 1 << 16;
  std::string lines;
  std::int64_t row = shard.head.range.first;
  for (; reader.next(line); ++row) {
    if (row == shard.head.range.last || line.rfind(fmt::format("{},", row), 0) != 0 ||
        fields_of(line) != fields) {
      throw InputError(fmt::format("{}:{}: not row {} of its sweep, the file is damaged",
                                   shard.path, reader.line_number(), row));
    }
    if (!row_is_ok(line)) ++outcome.without_result;
    lines += line + "\n";
    if (lines.size() < block) continue;
    target.append(lines);
    lines.clear();
  }
  if (row != shard.head.range.last || reader.torn()) {
    throw InputError(fmt::format(
        "{}: not finished, it has {} of {} rows (allowed: run its sweep "
        "again, it goes on)",
        shard.path, row - shard.head.range.first, shard.head.range.last - shard.head.range.first));
  }
  target.append(lines);
  outcome.rows += row - shard.head.range.first;
}

}  // namespace

SweepOutcome merge_sweep(const std::vector<std::string>& files, const std::string& path) {
  std::vector<ShardFile> shards;
  shards.reserve(files.size());
  for (const std::string& file : files) shards.push_back(open_shard(file));
  if (shards.empty()) throw InputError("--merge: no files given (allowed: all shards of a sweep)");
  std::stable_sort(shards.begin(), shards.end(), [](const ShardFile& a, const ShardFile& b) {
    return std::pair(a.head.range.first, a.head.range.last) <
           std::pair(b.head.range.first, b.head.range.last);
  });
  require_whole(shards);
  OutputFile target(path);
  SweepOutcome outcome;
  target.append(shards.front().columns + "\n");
  for (const ShardFile& shard : shards) append_rows(shard, target, outcome);
  target.finish();
  return outcome;
}

}  // namespace dlo::compare
