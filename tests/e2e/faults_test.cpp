// Faults from outside: a full disk, a folder without rights, a kill at any moment, input that
// vanishes, a missing encoder. The run reports the fault in one clear line, or succeeds. No file
// with a final name is ever incomplete.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;

#ifdef FOCI_SANITIZED
constexpr int kKills = 6;  // a sanitizer makes the binary ten times slower
#else
constexpr int kKills = 12;
#endif

class Faults : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("study.toml", smallStudy());
    folder.write("scene.ply", squarePly(24, 1.0));
    folder.write("trace.tsv",
                 "# screen_width_px=640 screen_height_px=480 screen_width_m=0.4 "
                 "screen_height_m=0.3 viewing_distance_m=0.5 units=px\n" +
                     steadyTrace());  // so that foci assumes nothing, and says little
  }

  /// The files of a folder, hidden ones left out, by name.
  std::map<std::string, std::string> filesIn(const std::string& name) const {
    std::map<std::string, std::string> files;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(folder.path() / name, absent)) {
      const std::string file = entry.path().filename();
      if (!file.starts_with('.')) files[file] = folder.read(name + "/" + file);
    }
    return files;
  }

  static std::vector<std::string> replayTo(const std::string& out) {
    return {"replay", "study.toml", "--threads", "1", "--out", out};
  }
  static std::vector<std::string> prepareTo(const std::string& out) {
    return {"prepare", "scene.ply", "--threads", "1", "--out", out + "/scene.foci"};
  }

  /// Exit code 1, one line, nothing written.
  void expectRefused(const Outcome& outcome, const std::string& out) const {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("cannot"), std::string::npos) << outcome.err;
    EXPECT_TRUE(filesIn(out).empty());
  }

  TemporaryFolder folder;
};

TEST_F(Faults, AFullDiskIsReportedAndLeavesNothing) {
  ASSERT_EQ(runFoci(replayTo("whole"), folder.path()).exit_code, 0);
  ASSERT_EQ(runFoci(prepareTo("whole"), folder.path()).exit_code, 0);
  const auto whole = filesIn("whole");
  // Set the limit below each file's size in turn, so that each file fails once. The margin of an
  // eighth covers timings with a digit more or less.
  for (const auto& [name, bytes] : whole) {
    const bool prepared = name.starts_with("scene");
    if (bytes.size() < 100) continue;  // the limit would cut standard error, too
    const Outcome outcome =
        runFociUnder({.max_file_bytes = bytes.size() - 1 - bytes.size() / 8},
                     prepared ? prepareTo("out") : replayTo("out"), folder.path());
    SCOPED_TRACE(name + " of " + std::to_string(bytes.size()));
    expectRefused(outcome, "out");
    EXPECT_FALSE(fs::exists(folder.path() / "out"));
  }
}

TEST_F(Faults, AFullDiskIsNoBadInputOfABatch) {
  folder.write("other.tsv", folder.read("trace.tsv"));
  ASSERT_EQ(runFoci(replayTo("whole"), folder.path()).exit_code, 0);
  const std::vector<std::string> batch = {"replay",    "study.toml", "--threads", "1",  "--trace",
                                          "trace.tsv", "other.tsv",  "--out",     "out"};
  const Outcome outcome = runFociUnder(
      {.max_file_bytes = folder.read("whole/report.html").size() / 2}, batch, folder.path());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("without a run: trace.tsv, other.tsv"), std::string::npos)
      << outcome.err;
}

TEST_F(Faults, AFolderWithoutRightsIsReported) {
  fs::permissions(folder.path(), fs::perms(0755));
  fs::create_directory(folder.path() / "shut");
  fs::permissions(folder.path() / "shut", fs::perms(0555));
  const Fault nobody{.as_nobody = true};
  for (const std::string out : {"shut", "shut/deeper"}) {
    for (const auto& command : {replayTo(out), prepareTo(out)}) {
      const Outcome outcome = runFociUnder(nobody, command, folder.path());
      expectRefused(outcome, out);
      EXPECT_NE(outcome.err.find("Permission denied"), std::string::npos) << outcome.err;
    }
  }
}

TEST_F(Faults, AFullStandardOutputIsReported) {
  const Outcome outcome = runFociUnder({.max_file_bytes = 200}, {"methods"}, folder.path());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("standard output cannot be written"), std::string::npos)
      << outcome.err;
}

TEST_F(Faults, AMissingEncoderIsReported) {
  const Outcome outcome = runFociUnder({.environment = {"OPENCV_VIDEOIO_PRIORITY_FFMPEG=0"}},
                                       replayTo("out"), folder.path());
  expectRefused(outcome, "out");
  EXPECT_NE(outcome.err.find("H.264"), std::string::npos) << outcome.err;
}

TEST_F(Faults, InputMayVanishOnceTheRunHasReadIt) {
  ASSERT_EQ(runFoci(replayTo("whole"), folder.path()).exit_code, 0);
  // The run makes its folder after it has read all input.
  const Fault fault{.appears = folder.path() / "out",
                    .vanish = {folder.path() / "scene.ply", folder.path() / "trace.tsv",
                               folder.path() / "study.toml"}};
  const Outcome outcome = runFociUnder(fault, replayTo("out"), folder.path());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto hashOf = [&](const std::string& out) {
    return nlohmann::json::parse(folder.read(out + "/manifest.json")).at("frames_sha256").dump();
  };
  EXPECT_EQ(hashOf("out"), hashOf("whole"));
}

// After a kill at any moment, every file with a final name is complete. The next run succeeds and
// removes temporary files.
TEST_F(Faults, AKillAtAnyMomentLeavesOnlyCompleteFiles) {
  std::mt19937 random(1);
  for (const bool prepare : {false, true}) {
    const auto arguments = prepare ? prepareTo("out") : replayTo("out");
    // The shorter of two runs: on a busy machine one of them may be slow.
    auto took_ms = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < 2; ++i) {
      fs::remove_all(folder.path() / "out");
      const auto start = std::chrono::steady_clock::now();
      ASSERT_EQ(runFoci(arguments, folder.path()).exit_code, 0);
      const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(
          std::chrono::steady_clock::now() - start);
      took_ms = std::min(took_ms, std::int64_t{took.count()});
    }
    const auto whole = filesIn("out");
    int killed = 0;
    for (int i = 0; i < kKills; ++i) {
      fs::remove_all(folder.path() / "out");
      const int after_ms = static_cast<int>(random() % static_cast<unsigned>(took_ms + 2));
      const Outcome outcome = runFociUnder({.killed_after_ms = after_ms}, arguments, folder.path());
      killed += outcome.exit_code != 0;
      for (const auto& [name, bytes] : filesIn("out")) {
        // Reports and tables hold timings: compare only their ends.
        const auto& expected = whole.at(name);
        SCOPED_TRACE(name + " after " + std::to_string(after_ms) + " ms");
        if (name == "video.mp4" || name == "scene.foci" || name == "events.tsv") {
          EXPECT_EQ(bytes, expected);
        } else {
          ASSERT_GE(bytes.size(), 8u);
          EXPECT_EQ(bytes.back(), expected.back());
        }
      }
    }
    EXPECT_GT(killed, kKills / 3);
    ASSERT_EQ(runFoci(arguments, folder.path()).exit_code, 0);
    for (const auto& entry : fs::directory_iterator(folder.path() / "out")) {
      const std::string name = entry.path().filename();
      EXPECT_TRUE(!name.starts_with('.') || name == ".foci-outputs") << name;
    }
    fs::remove_all(folder.path() / "out");
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
