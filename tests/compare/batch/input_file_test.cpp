// Tests of reading files: every failure is reported, and the size of a file is limited.

#include "base/input_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "batch/baseline.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_file.hpp"
#include "folder_fixture.hpp"
#include "reading/scene_template.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

class Reading : public Folder {};

/// Returns the messages of the readers of scenes, scene templates, parameters, materials, baselines
/// and shapes for this file, in this order.
std::vector<std::string> messages_of_all_readers(const std::string& file) {
  using namespace dlo::compare;
  return {error_of<InputError>([&] { (void)load_scene(file); }),
          error_of<InputError>([&] { (void)load_scene_template(file); }),
          error_of<InputError>([&] { (void)load_parameters(file); }),
          error_of<InputError>([&] { (void)load_materials(file); }),
          error_of<InputError>([&] { (void)load_baseline(file); }),
          error_of<InputError>([&] { (void)load_shape(file, 1); })};
}

// A terminal returns the data that were written to it; after its other end is closed, reading
// fails.
TEST_F(Reading, AnErrorAfterThePartThatCouldBeReadIsAnError) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0) << std::strerror(errno);
  ASSERT_EQ(::grantpt(terminal), 0);
  ASSERT_EQ(::unlockpt(terminal), 0);
  const int other = ::open(::ptsname(terminal), O_RDWR | O_NOCTTY);
  ASSERT_GE(other, 0);
  termios mode{};
  ASSERT_EQ(::tcgetattr(other, &mode), 0);
  ::cfmakeraw(&mode);
  ASSERT_EQ(::tcsetattr(other, TCSANOW, &mode), 0);
  ASSERT_EQ(::write(other, "first half", 10), 10);
  ::close(other);
  InputFile file(terminal, "a.toml");
  std::string text;
  const std::string message = error_of<InputError>([&] {
    while (file.read_block(text, 100)) continue;
  });
  EXPECT_EQ(text, "first half");
  EXPECT_EQ(message, "a.toml: cannot be read (Input/output error, after 10 bytes)");
}

TEST_F(Reading, EveryReaderTellsAReadErrorAndADirectory) {
  for (const std::string& message : messages_of_all_readers("/proc/self/mem")) {
    EXPECT_EQ(message, "/proc/self/mem: cannot be read (Input/output error)");
  }
  for (const std::string& message : messages_of_all_readers(path(""))) {
    EXPECT_EQ(message, path("") + ": cannot be read (Is a directory)");
  }
}

TEST_F(Reading, EveryReaderTellsWhyAFileCannotBeOpened) {
  std::filesystem::create_symlink(path("loop"), path("loop"));
  for (const std::string& message : messages_of_all_readers(path("loop"))) {
    EXPECT_TRUE(has_all(message, {"Too many levels of symbolic links"}));
  }
  write("here.toml", "x");
  for (const std::string& message : messages_of_all_readers(path("here"))) {
    EXPECT_TRUE(
        has_all(message, {"(No such file or directory, but " + path("here.toml") + " is there)"}));
  }
}

TEST_F(Reading, TellsThatNoMoreFilesCanBeOpened) {
  write("a.toml", "x");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int next = ::open("/dev/null", O_RDONLY);
  ASSERT_EQ(::close(next), 0);
  rlimit few = before;
  few.rlim_cur = static_cast<rlim_t>(next);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  const std::vector<std::string> messages = messages_of_all_readers(path("a.toml"));
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  for (const std::string& message : messages) {
    EXPECT_EQ(message, path("a.toml") + ": cannot be read (Too many open files)");
  }
}

TEST_F(Reading, TellsThatAFileIsForOthers) {
  write("a.toml", "x");
  std::filesystem::permissions(path("a.toml"), std::filesystem::perms::none);
  // The superuser may read everything.
  constexpr uid_t unprivileged = 65534;
  const bool root = ::geteuid() == 0;
  if (root && ::seteuid(unprivileged) != 0) GTEST_SKIP() << "cannot become another user";
  const std::string message = error_of<InputError>([&] { (void)load_scene(path("a.toml")); });
  if (root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  EXPECT_EQ(message, path("a.toml") + ": cannot be read (Permission denied)");
}

TEST_F(Reading, EndsWhereAFileIsTooLarge) {
  write("a", std::string(1000, 'x'));
  EXPECT_EQ(InputFile(path("a")).read_all(1000).size(), 1000U);
  const std::string message =
      error_of<InputError>([&] { (void)InputFile(path("a")).read_all(999); });
  EXPECT_EQ(message, path("a") + ": too large (allowed: files of up to 999 bytes)");
  const std::string endless =
      error_of<InputError>([] { (void)InputFile("/dev/zero").read_all(std::size_t{1} << 20); });
  EXPECT_TRUE(has_all(endless, {"too large"}));
}

std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += text;
  return result;
}

TEST(TextLimits, NothingIsNestedSoDeepThatAParserOverflows) {
  const auto scene = [](const std::string& text) {
    return error_of<InputError>([&] { (void)parse_scene(text, "s.toml"); });
  };
  constexpr int many = 100'000;
  const std::string dots = "s.toml:2: a key of too many dotted parts (allowed: 32 levels)";
  EXPECT_EQ(scene("\na" + repeated(".a", many) + " = 1"), dots);
  EXPECT_EQ(scene("\n[a" + repeated(".a", many) + "]"), dots);
  EXPECT_EQ(scene("\n\"a\"" + repeated(" . \"a\"", many) + " = 1"), dots);
  const std::string brackets = "s.toml:2: brackets within brackets (allowed: 32 levels)";
  EXPECT_EQ(scene("\na = " + repeated("[", many) + repeated("]", many)), brackets);
  EXPECT_EQ(scene("\na = " + repeated("{a = ", many) + "1" + repeated("}", many)), brackets);
  // The largest allowed depth reaches the parser.
  const std::string unknown = ": unknown key (allowed: distributed_load, ";
  EXPECT_TRUE(has_all(scene("a" + repeated(".a", 31) + " = 1"), {unknown}));
  EXPECT_TRUE(has_all(scene("a = " + repeated("[", 32) + repeated("]", 32)), {unknown}));
}

TEST(TextLimits, StringsAndCommentsNestNothing) {
  const auto reads = [](const std::string& line) {
    const std::string text = line + "\n" + steel_rod + level_clamp;
    return error_of<InputError>([&] { (void)parse_scene(text, "s.toml"); });
  };
  const std::string deep = repeated("[.{", 50);
  EXPECT_EQ(reads("# " + deep), "no error");
  EXPECT_EQ(reads("name = \"" + deep + "\\\" " + deep + "\""), "no error");
  EXPECT_EQ(reads("name = '" + deep + "\\'"), "no error");
  EXPECT_EQ(reads("name = \"\"\"" + deep + "\"\n" + deep + "\"\"\"\"\""), "no error");
  EXPECT_EQ(reads("name = '''" + deep + "''\n" + deep + "'''''"), "no error");
  EXPECT_EQ(reads("name = \"1e-400\""), "no error");
}

TEST(TextLimits, NumbersBeyondADoubleAreSaidToBe) {
  const auto scene = [](const std::string& number) {
    return error_of<InputError>(
        [&] { (void)parse_scene("[rod]\nlength = " + number + "\n", "s.toml"); });
  };
  const auto expect = [&](const std::string& number, const std::string& words) {
    const std::string message = scene(number);
    EXPECT_EQ(message.find("s.toml:2: "), 0U) << message;
    EXPECT_TRUE(has_all(message, {words}));
  };
  expect("1e-400", "1e-400 is too small");
  expect("1e400", "1e400 is too large");
  expect("\"1e-400 m\"", "rod.length = '1e-400 m': 1e-400 is too small");
  expect("\"1e-99999999999999999999 m\"", "too small");
  expect("\"0." + std::string(400, '0') + "1 m\"", "too small");
  expect("\"1" + std::string(400, '0') + " m\"", "too large");
  expect("2,5", "a number has a decimal point");
  expect("\"2,5 m\"", "\"2,5 m\" has a comma (allowed: a decimal point)");
}

TEST(TextLimits, OfShapesAndSweeps) {
  const auto shape = [](const std::string& text) {
    return error_of<InputError>([&] { (void)parse_shape(text, "s.json", 1); });
  };
  EXPECT_EQ(shape(repeated("[\n", 300'000)),
            "s.json:33: brackets within brackets (allowed: 32 levels)");
  EXPECT_EQ(shape("[" + repeated("0,", 3'000'000) + "0]"),
            "s.json: too many values (allowed: 3000000)");
  EXPECT_EQ(
      shape(R"({"a": "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[\"", "points": [[0, 0], [1, 0]]})"),
      "no error");
  const std::string large(std::size_t{5} << 20, ' ');
  EXPECT_EQ(error_of<InputError>([&] { (void)parse_scene(large, "s.toml"); }),
            "s.toml: 5242880 bytes (allowed: up to 4194304 of TOML)");
}

TEST(TextLimits, OfThePartsOfAScene) {
  const std::string rod = "[rod]\nlength = 1\ndiameter = 0.01\nmaterial = \"copper\"\n";
  const std::string gripper = "[[gripper]]\nat = 0\nposition = [0, 0, 0]\nhold = \"pin\"\n";
  const std::string load = "[[load]]\nat = 1\nforce = [0, 1, 0]\n";
  const std::string plane = "[[obstacle]]\npoint = [0, -1, 0]\nnormal = [0, 1, 0]\n";
  const auto scene = [&](int grippers, int loads, int planes) {
    const std::string text =
        rod + repeated(gripper, grippers) + repeated(load, loads) + repeated(plane, planes);
    return error_of<InputError>([&] { (void)parse_scene(text, "s.toml"); });
  };
  EXPECT_EQ(scene(500, 10'000, 1'000), "no error");
  EXPECT_EQ(scene(501, 0, 0), "s.toml:5: gripper: 501 given (allowed: 1 to 500)");
  EXPECT_EQ(scene(1, 10'001, 0), "s.toml:9: load: 10001 given (allowed: 0 to 10000)");
  EXPECT_EQ(scene(1, 0, 1'001), "s.toml:9: obstacle: 1001 given (allowed: 0 to 1000)");
}

TEST(TextLimits, OfVariedFields) {
  const SceneTemplate scene("[rod]\nlength = 1\n", "s.toml");
  const auto vary = [&](const std::string& field, const std::string& value) {
    return error_of<InputError>([&] { (void)scene.with({{field, value}}); });
  };
  EXPECT_TRUE(has_all(vary("a" + repeated(".a", 60'000), "1"), {"too many dotted parts"}));
  EXPECT_TRUE(has_all(vary("gravity", repeated("[", 60'000)), {"brackets within brackets"}));
}

}  // namespace
}  // namespace dlo::compare
