// Files of a sweep: going on after a kill, shards, merging.

#include "batch/sweep_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "batch/sweep_merge.hpp"
#include "dlo/compare/error.hpp"
#include "folder_fixture.hpp"
#include "sweep_scene.hpp"

namespace {

using dlo::compare::InputError;
using dlo::compare::merge_sweep;
using dlo::compare::Shard;
using dlo::compare::Sweep;
using dlo::compare::SweepFileOptions;
using dlo::compare::SweepOutcome;
using dlo::compare::write_sweep;
using dlo::test::error_of;
using dlo::test::says;
using dlo::test::sweep;

const std::vector<std::string> grid = {"rod.length=lin:-0.1:1:12"};

class SweepFile : public dlo::test::Folder {
 protected:
  /// Writes shards 1 to n of a sweep; their paths.
  [[nodiscard]] std::vector<std::string> shards(const Sweep& whole, std::int64_t n) const {
    std::vector<std::string> paths;
    for (std::int64_t i = 1; i <= n; ++i) {
      paths.push_back(path(std::to_string(i) + ".csv"));
      write_sweep(whole, Shard{i, n, ""}, paths.back(), serial);
    }
    return paths;
  }
  void expect_merge_error(const std::vector<std::string>& paths, const std::string& words) const {
    EXPECT_TRUE(says(error_of<InputError>([&] { return merge_sweep(paths, path("merged.csv")); }),
                     {words}));
    EXPECT_FALSE(std::filesystem::exists(path("merged.csv")));
    EXPECT_FALSE(std::filesystem::exists(path("merged.csv.tmp")));
  }

  static inline const SweepFileOptions serial{.threads = 1};
};

TEST_F(SweepFile, IsHeaderAndRowsAndNothingElseIsLeft) {
  const Sweep whole = sweep(grid);
  const SweepOutcome outcome = write_sweep(whole, std::nullopt, path("a.csv"));
  EXPECT_EQ(outcome.rows, 12);
  EXPECT_EQ(outcome.found, 0);
  EXPECT_EQ(outcome.without_result, 2);  // lengths -0.1 and 0
  std::string expected = whole.header();
  for (std::int64_t row = 0; row < 12; ++row) expected += whole.row(row);
  EXPECT_EQ(read(path("a.csv")), expected);
  EXPECT_EQ(files(), std::vector<std::string>{"a.csv"});
}

TEST_F(SweepFile, GoesOnFromEveryPlaceAtWhichAKillCanCutIt) {
  const Sweep whole = sweep(grid);
  write_sweep(whole, std::nullopt, path("a.csv"), serial);
  const std::string expected = read(path("a.csv"));
  const std::string part = dlo::compare::sweep_identity(whole, std::nullopt) + expected;
  for (std::size_t size = 0; size <= part.size(); ++size) {
    // Inside lines some places stand for all; around line ends every one counts.
    const std::size_t newline = part.find('\n', size > 0 ? size - 1 : 0);
    if (newline > size + 1 && size % 17 != 0) continue;
    write("b.csv.part", part.substr(0, size));
    const SweepOutcome outcome = write_sweep(whole, std::nullopt, path("b.csv"), serial);
    ASSERT_EQ(read(path("b.csv")), expected) << "cut at " << size;
    ASSERT_EQ(outcome.rows, 12);
    ASSERT_EQ(outcome.without_result, 2);
    const auto lines = std::count(part.begin(), part.begin() + static_cast<long>(size), '\n');
    ASSERT_EQ(outcome.found, std::max<std::int64_t>(lines - 2, 0));
  }
  EXPECT_EQ(files(), (std::vector<std::string>{"a.csv", "b.csv"}));
}

TEST_F(SweepFile, ComputesARowThatLacksSomethingAgain) {
  const Sweep whole = sweep(grid);
  write_sweep(whole, std::nullopt, path("a.csv"), serial);
  const std::string expected = read(path("a.csv"));
  const std::string begun = dlo::compare::sweep_identity(whole, std::nullopt) + whole.header();
  std::string kept;
  for (std::int64_t row = 0; row < 12; ++row) {
    const std::string line = whole.row(row);
    // A line that ends inside its fields, or inside the word ok; a status of its own may end early.
    const bool ok = line.ends_with(",ok\n");
    const std::size_t most = ok ? line.size() - 2 : line.rfind(",,") + 2;
    for (std::size_t size = 0; size <= most; size += row == 6 || size + 5 > most ? 1 : 7) {
      write("b.csv.part", begun + kept + line.substr(0, size) + "\n");
      ASSERT_EQ(write_sweep(whole, std::nullopt, path("b.csv"), serial).found, row) << size;
      ASSERT_EQ(read(path("b.csv")), expected) << line.substr(0, size);
    }
    kept += line;
  }
}

TEST_F(SweepFile, RefusesAPartOfAnotherSweepUnlessToldToRestart) {
  const Sweep whole = sweep(grid);
  const Sweep other = sweep({"rod.length=lin:-0.1:1:13"});
  const std::string foreign[] = {dlo::compare::sweep_identity(other, std::nullopt) + other.header(),
                                 dlo::compare::sweep_identity(whole, Shard{1, 2, ""}), "x,y\n1,2\n",
                                 "\n"};
  for (const std::string& text : foreign) {
    write("a.csv.part", text);
    EXPECT_THROW(write_sweep(whole, std::nullopt, path("a.csv"), serial), InputError) << text;
    EXPECT_EQ(read(path("a.csv.part")), text);
  }
  EXPECT_EQ(write_sweep(whole, std::nullopt, path("a.csv"), {.threads = 1, .restart = true}).rows,
            12);
}

TEST_F(SweepFile, ADifferentSceneModelOrOptionIsAnotherSweep) {
  const std::string identity = sweep(grid).identity();
  EXPECT_EQ(sweep(grid).identity(), identity);
  EXPECT_NE(sweep(grid, dlo::compare::SweepModel::exact).identity(), identity);
  EXPECT_NE(sweep({"rod.length=lin:-0.1:1:13"}).identity(), identity);
  EXPECT_NE(sweep(grid, dlo::compare::SweepModel::energy,
                  std::string(dlo::test::sweep_scene) + "# another\n")
                .identity(),
            identity);
}

TEST_F(SweepFile, RefusesADamagedRow) {
  const Sweep whole = sweep(grid);
  write("a.csv.part", dlo::compare::sweep_identity(whole, std::nullopt) + whole.header() +
                          whole.row(0) + whole.row(2));
  EXPECT_TRUE(says(
      error_of<InputError>([&] { return write_sweep(whole, std::nullopt, path("a.csv"), serial); }),
      {"a.csv.part:4: not row 1"}));
}

TEST_F(SweepFile, IsWrittenByOneProcessAtATime) {
  const Sweep whole = sweep({"rod.length=lin:0.1:1:100"});
  SweepFileOptions nested = serial;
  int refused = 0;
  nested.progress = [&](std::int64_t, std::int64_t) {
    // A second open file description is locked out like a second process.
    EXPECT_THROW(write_sweep(whole, std::nullopt, path("a.csv"), serial), InputError);
    ++refused;
  };
  write_sweep(whole, std::nullopt, path("a.csv"), nested);
  EXPECT_GT(refused, 1);
}

TEST_F(SweepFile, ShardsMergeToWhatOneRunWrites) {
  const Sweep whole = sweep(grid);
  write_sweep(whole, std::nullopt, path("a.csv"));
  for (const std::int64_t n : {1, 3, 12, 15}) {  // of 15 shards three are empty
    std::vector<std::string> paths = shards(whole, n);
    std::reverse(paths.begin(), paths.end());
    const SweepOutcome outcome = merge_sweep(paths, path("b.csv"));
    EXPECT_EQ(outcome.rows, 12);
    EXPECT_EQ(outcome.without_result, 2);
    EXPECT_EQ(read(path("b.csv")), read(path("a.csv"))) << n;
    for (const std::string& file : paths) std::filesystem::remove(file);
  }
}

TEST_F(SweepFile, AFinishedShardIsLeftAsItIs) {
  const Sweep whole = sweep(grid);
  (void)shards(whole, 2);
  const std::string before = read(path("1.csv"));
  EXPECT_EQ(write_sweep(whole, Shard{1, 2, ""}, path("1.csv"), serial).found, 6);
  EXPECT_EQ(read(path("1.csv")), before);
  EXPECT_THROW(write_sweep(whole, Shard{2, 2, ""}, path("1.csv"), serial), InputError);
  EXPECT_EQ(files(), (std::vector<std::string>{"1.csv", "2.csv"}));
}

TEST_F(SweepFile, MergeRefusesGapsDuplicatesAndOtherSweeps) {
  const Sweep whole = sweep(grid);
  const std::vector<std::string> paths = shards(whole, 3);
  expect_merge_error({paths[0], paths[2]}, "rows 4 to 7 of 12 are missing");
  expect_merge_error({paths[0], paths[1]}, "rows 8 to 11 of 12 are missing");
  expect_merge_error({paths[1], paths[2]}, "rows 0 to 3 of 12 are missing");
  expect_merge_error({paths[0], paths[1], paths[1], paths[2]}, "too");
  write_sweep(whole, Shard{1, 2, ""}, path("half.csv"), serial);
  expect_merge_error({paths[0], path("half.csv"), paths[2]}, "too");
  write_sweep(sweep({"rod.length=lin:-0.1:2:12"}), Shard{2, 3, ""}, path("other.csv"), serial);
  expect_merge_error({paths[0], path("other.csv"), paths[2]}, "another sweep");
  expect_merge_error({}, "no files");
}

TEST_F(SweepFile, MergeRefusesFilesThatAreNoWholeShard) {
  const Sweep whole = sweep(grid);
  const std::vector<std::string> paths = shards(whole, 2);
  const std::string good = read(path("2.csv"));
  const auto damaged = [&](const std::string& text, const std::string& words) {
    write("2.csv", text);
    expect_merge_error(paths, words);
  };
  damaged("", "no shard");
  damaged("row,a\n1,2\n", "no shard");
  damaged(std::string(100, '\0'), "no shard");
  damaged(good.substr(0, good.find('\n') + 1), "no row yet");
  damaged(good.substr(0, good.size() - 1), "5 of 6 rows");
  damaged(good.substr(0, good.rfind("\n11,") + 1), "5 of 6 rows");
  damaged(good + "12,1\n", "not row 12");
  std::string text = good;
  text.replace(text.find("\n8,"), 3, "\n9,");
  damaged(text, "2.csv:5: not row 8");
  text = good;
  text.erase(text.rfind(','), 1);
  damaged(text, "not row 11");
  text = good;
  text.replace(text.find("rows from"), 9, "rows of");
  damaged(text, "no shard");
  text = good;
  text.replace(text.find("of 12"), 5, "of 11");
  damaged(text, "no shard");
  std::filesystem::remove(paths[1]);
  expect_merge_error(paths, "cannot be read");
}

TEST_F(SweepFile, ThatCannotBeWrittenIsAnInputError) {
  const Sweep whole = sweep(grid);
  EXPECT_THROW(write_sweep(whole, std::nullopt, path("no/folder/a.csv"), serial), InputError);
  std::filesystem::create_directory(path("folder"));
  EXPECT_THROW(write_sweep(whole, std::nullopt, path("folder"), serial), InputError);
}

}  // namespace
