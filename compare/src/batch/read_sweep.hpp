#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/input_file.hpp"
#include "batch/sweep.hpp"

namespace dlo::compare {

/// The first line of a file that is not a whole sweep.
struct SweepHead {
  std::string identity;   ///< Sweep::identity()
  std::string shard;      ///< "2/4"
  RowRange range;         ///< that the file is for
  std::int64_t rows = 0;  ///< of the whole sweep

  bool operator==(const SweepHead&) const = default;

  [[nodiscard]] std::string line() const;
};

/// Nothing if the line (without its end) is none.
[[nodiscard]] std::optional<SweepHead> parse_sweep_head(const std::string& line);

/// Reads a file line by line and tells whole lines from one that was cut off.
class LineReader {
 public:
  /// More than any row of a sweep has [bytes].
  static constexpr std::size_t longest_line = std::size_t{1} << 20;

  /// @throws InputError if the file cannot be read
  explicit LineReader(const std::string& path);

  /// The next whole line without its end; false at the end of the file or at a torn line, of which
  /// `line` is what there is. @throws InputError if the file cannot be read, or a line is too long
  bool next(std::string& line);

  [[nodiscard]] bool torn() const { return torn_; }
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }         ///< of the whole lines
  [[nodiscard]] std::int64_t line_number() const { return number_; }  ///< of the last whole line

 private:
  std::string path_;
  InputFile file_;
  std::string text_;  // read, but not handed out yet from begin_ on
  std::size_t begin_ = 0;
  bool ended_ = false;
  bool torn_ = false;
  std::int64_t bytes_ = 0;
  std::int64_t number_ = 0;
};

/// Fields of a line (without its end), of which some may be quoted.
[[nodiscard]] std::int64_t fields_of(std::string_view line);

/// Whether a row (without its line end) has all that belongs to it: its start, and results with the
/// status ok or none with one that says why.
/// @param start  Sweep::row_start();  @param fields  of the header
[[nodiscard]] bool row_is_whole(std::string_view line, std::string_view start, std::int64_t fields);

/// Whether the status of a row (without its line end) is ok.
[[nodiscard]] bool row_is_ok(std::string_view line);

}  // namespace dlo::compare
