#include "batch/sweep_file.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/output_file.hpp"
#include "batch/locked_file.hpp"
#include "batch/read_sweep.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

SweepHead head_of(const Sweep& sweep, const std::optional<Shard>& shard) {
  const Shard part = shard.value_or(Shard{});
  return {sweep.identity(), part.name(), rows_of(part, sweep.grid().size()), sweep.grid().size()};
}

[[noreturn]] void refuse_other_sweep(const std::string& path, const std::string& line,
                                     const SweepHead& expected) {
  const std::optional<SweepHead> found = parse_sweep_head(line);
  std::string problem = "is no part of a sweep";
  if (found && found->identity != expected.identity) {
    problem =
        fmt::format("belongs to another sweep: {}, this is {}", found->identity, expected.identity);
  } else if (found) {
    problem = fmt::format("is shard {}, this is {}", found->shard, expected.shard);
  }
  throw InputError(fmt::format("{}: {} (allowed: another -o, or --restart)", path, problem));
}

/// What an earlier run has left of a file.
struct Remains {
  std::int64_t rows = 0;
  std::int64_t without_result = 0;
  std::int64_t bytes = 0;  ///< of whole lines
};

/// Reads a file that an earlier run began. Every row has to be the one that belongs there;
/// one that lacks columns or its status ends what is kept.
Remains read_remains(const Sweep& sweep, const SweepHead& head, const std::string& path) {
  LineReader reader(path);
  Remains remains;
  std::string line;
  const std::string preamble = head.line() + sweep.header();
  std::string begun;
  while (begun.size() < preamble.size() && reader.next(line)) begun += line + "\n";
  const bool whole = begun == preamble;
  // A run that was killed early may have left a part of the first lines.
  const bool early = !whole && preamble.compare(0, begun.size(), begun) == 0 &&
                     (!reader.torn() || preamble.compare(begun.size(), line.size(), line) == 0);
  if (early) return remains;
  if (!whole) refuse_other_sweep(path, begun.substr(0, begun.find('\n')), head);
  remains.bytes = reader.bytes();
  const std::int64_t fields = fields_of(sweep.header());
  while (reader.next(line)) {
    const std::int64_t row = head.range.first + remains.rows;
    const std::string start = row < head.range.last ? sweep.row_start(row) : std::string();
    // What is behind a row that lacks something is computed again with it.
    const bool belongs = !start.empty() && (line.starts_with(start) || start.starts_with(line));
    if (belongs && !row_is_whole(line, start, fields)) return remains;
    if (!belongs) {
      throw InputError(
          fmt::format("{}:{}: not row {} of this sweep, the file is damaged (allowed: "
                      "another -o, or --restart)",
                      path, reader.line_number(), row));
    }
    ++remains.rows;
    if (!row_is_ok(line)) ++remains.without_result;
    remains.bytes = reader.bytes();
  }
  return remains;
}

void count_row(std::string_view line, const SweepHead& head, const SweepFileOptions& options,
               SweepOutcome& outcome) {
  ++outcome.rows;
  if (!row_is_ok(line.substr(0, line.size() - 1))) ++outcome.without_result;
  if (options.progress) options.progress(outcome.rows, head.range.last - head.range.first);
}

/// Into what is no file: nothing stays there to go on with.
SweepOutcome stream_rows(const Sweep& sweep, const std::optional<Shard>& shard,
                         const std::string& name, const SweepFileOptions& options) {
  const SweepHead head = head_of(sweep, shard);
  OutputFile file(name);
  file.append(shard ? head.line() + sweep.header() : sweep.header());
  SweepOutcome outcome;
  sweep.run(head.range, options.threads, [&](const std::string& line) {
    file.append(line);
    count_row(line, head, options, outcome);
  });
  file.finish();
  return outcome;
}

void compute_rows(const Sweep& sweep, const SweepHead& head, const SweepFileOptions& options,
                  LockedFile& file, SweepOutcome& outcome) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds between_syncs(1);
  Clock::time_point synced = Clock::now();
  const auto take = [&](const std::string& line) {
    file.append(line);
    if (Clock::now() - synced > between_syncs) {
      file.sync();
      synced = Clock::now();
    }
    count_row(line, head, options, outcome);
  };
  sweep.run({head.range.first + outcome.found, head.range.last}, options.threads, take);
  file.sync();
}

SweepOutcome finished_shard(const Sweep& sweep, const SweepHead& head, const std::string& path) {
  const Remains remains = read_remains(sweep, head, path);
  const std::int64_t rows = head.range.last - head.range.first;
  if (remains.bytes > 0 && remains.rows == rows) return {rows, rows, remains.without_result};
  throw InputError(fmt::format(
      "{}: has {} of {} rows, but only a finished shard has this name (allowed: another "
      "-o, or --restart)",
      path, remains.rows, rows));
}

}  // namespace

std::string sweep_identity(const Sweep& sweep, const std::optional<Shard>& shard) {
  return head_of(sweep, shard).line();
}

SweepOutcome write_sweep(const Sweep& sweep, const std::optional<Shard>& shard,
                         const std::string& name, const SweepFileOptions& options) {
  const SweepHead head = head_of(sweep, shard);
  const OutputTarget target = output_target(name);
  if (target.kind != OutputTarget::Kind::file) return stream_rows(sweep, shard, name, options);
  std::error_code unknown;
  const bool link = std::filesystem::is_symlink(name, unknown);
  const std::string path = link ? target.path : name;
  const std::string part = path + ".part";
  if (shard && !options.restart && std::filesystem::exists(path, unknown)) {
    return finished_shard(sweep, head, path);
  }
  LockedFile file(part);
  const Remains remains = options.restart ? Remains{} : read_remains(sweep, head, part);
  file.cut(remains.bytes);
  if (remains.bytes == 0) file.append(head.line() + sweep.header());
  SweepOutcome outcome{remains.rows, remains.rows, remains.without_result};
  if (remains.rows > 0 && options.resumed) options.resumed(remains.rows);
  compute_rows(sweep, head, options, file, outcome);
  if (shard) {
    file.rename(path);
  } else {
    (void)merge_sweep({part}, path);
    file.remove();
  }
  return outcome;
}

}  // namespace dlo::compare
