// foci reports any bad input in one line, exits with 2 and leaves no folder behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

struct BadInput {
  std::string name;
  std::string says;  ///< part of the message
  std::string study = smallStudy(), scene = squarePly(8, 1.0), trace = steadyTrace();
  std::string monitor = {};
  std::vector<std::string> options = {};
};

void PrintTo(const BadInput& input, std::ostream* out) { *out << input.name; }

class BadInputs : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputs, AreRefusedInOneLineAndNothingIsLeft) {
  const BadInput& bad = GetParam();
  const TemporaryFolder folder;
  folder.write("study.toml", bad.study);
  folder.write("scene.ply", bad.scene);
  folder.write("trace.tsv", bad.trace);
  if (!bad.monitor.empty()) folder.write("monitor.json", bad.monitor);

  std::vector<std::string> arguments = {"replay", "study.toml", "--out", "made/out"};
  arguments.insert(arguments.end(), bad.options.begin(), bad.options.end());
  const Outcome outcome = runFoci(arguments, folder.path());

  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("foci: ")) << outcome.err;
  EXPECT_LE(outcome.err.size(), 600u);
  EXPECT_NE(outcome.err.find(bad.says), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "made"));
}

BadInput inStudy(const char* name, const char* says, std::string study) {
  BadInput bad{name, says};
  bad.study = std::move(study);
  return bad;
}

BadInput added(const char* name, const char* says, const std::string& lines) {
  return inStudy(name, says, smallStudy() + lines);
}

BadInput withMonitor(const char* name, const char* says, std::string study, std::string monitor) {
  BadInput bad = inStudy(name, says, std::move(study));
  bad.monitor = std::move(monitor);
  return bad;
}

BadInput inScene(const char* name, const char* says, std::string scene) {
  BadInput bad{name, says};
  bad.scene = std::move(scene);
  return bad;
}

BadInput inTrace(const char* name, const char* says, std::string trace) {
  BadInput bad{name, says};
  bad.trace = std::move(trace);
  return bad;
}

BadInput withOptions(const char* name, const char* says, std::vector<std::string> options) {
  BadInput bad{name, says};
  bad.options = std::move(options);
  return bad;
}

/// The small study with one of its lines replaced.
std::string studyWith(const std::string& from, const std::string& to) {
  std::string study = smallStudy();
  return study.replace(study.find(from), from.size(), to);
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

const std::string kPlyStart = "ply\nformat ascii 1.0\n";
const std::string kPlyXyz = "property float x\nproperty float y\nproperty float z\nend_header\n";

INSTANTIATE_TEST_SUITE_P(
    Study, BadInputs,
    testing::Values(
        added("UnknownKey", "did you mean observer.pupil_mm?", "[observer]\npupil_m = 4\n"),
        added("UnknownSection", "did you mean", "[observers]\npupil_mm = 4\n"),
        added("PupilOfNothing", "the gaze has no pupil in millimetres",
              "[observer]\npupil = \"recording\"\n"),
        added("PupilOfNoKind", "expected one of \"fixed\" \"recording\" \"luminance\"",
              "[observer]\npupil = \"wide\"\n"),
        added("UnknownKeyNamesItsLine", "study.toml:18: ", "\n[observer]\nx = 4\n"),
        inStudy("UnknownTopKey", "did you mean seed?", "sead = 3\n" + smallStudy()),
        added("TextForANumber", "observer.pupil_mm = \"4\": expected 0.5 to 12",
              "[observer]\npupil_mm = \"4\"\n"),
        added("NumberTooLarge", "observer.pupil_mm = 40: expected 0.5 to 12",
              "[observer]\npupil_mm = 40\n"),
        added("NegativeNumber", "expected 0.5 to 12", "[observer]\npupil_mm = -4\n"),
        added("NotANumber", "expected 0.5 to 12", "[observer]\npupil_mm = nan\n"),
        added("InfiniteNumber", "expected 0.5 to 12", "[observer]\npupil_mm = inf\n"),
        added("DateForANumber", "a date or time", "[observer]\npupil_mm = 1979-05-27\n"),
        added("TableForANumber", "observer.pupil_mm = {...}",
              "[observer]\npupil_mm = { mm = 4 }\n"),
        inStudy("NumberForASection", "expected a section", "eye = 3\n"),
        inStudy("HugeInteger", "expected an integer",
                "seed = 9223372036854775807\n" + smallStudy()),
        inStudy("IntegerBeyond64Bits", "study.toml",
                "seed = 99999999999999999999999\n" + smallStudy()),
        inStudy("FractionForAnInteger", "expected an integer", "seed = 1.5\n" + smallStudy()),
        added("TextForAFlag", "expected true or false", "marker = \"yes\"\n"),
        inStudy("ShortVector", "expected 3 numbers",
                studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0]")),
        inStudy("LongVector", "expected 3 numbers",
                studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0, -1, 4]")),
        inStudy("MixedVector", "expected 3 numbers",
                studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0, \"a\"]")),
        inStudy("EmptyText", "expected a file's name",
                studyWith("file = \"scene.ply\"", "file = \"\"")),
        inStudy("UnknownWord", "\"gallery\" \"plane\"",
                studyWith("file = \"scene.ply\"", "builtin = \"galery\"")),
        added("UnknownMethod",
              "render.method = \"swep\": expected a known method; the nearest is sweep",
              "[render]\nmethod = \"swep\"\n"),
        inStudy("DuplicateKey", "study.toml:3", studyWith("[eye]", "file = \"b.ply\"\n[eye]")),
        inStudy("SyntaxError", "study.toml:2", "seed = 1\n[scene\n"),
        inStudy("NoValue", "study.toml", "seed =\n"),
        inStudy("DeepNesting", "nested too deeply", "seed = " + repeated("[", 100000)),
        inStudy("DeepNestingBehindAText", "strings of several lines",
                "seed = [\"\"\"\n\"\"\", " + repeated("[", 1900)),
        inStudy("LongDottedKey", "nested too deeply", repeated("a.", 100000) + "a = 1\n"),
        inStudy("Binary", "NUL byte", std::string("seed = 1\n\0\1\2", 12)),
        inStudy("NotUtf8", "study.toml:2: a byte that is not UTF-8", "seed = 1\n'\x9e\xa5' = 1\n"),
        inStudy("HugeFile", "expected at most 4,194,304",
                repeated("# a comment of many\n", 400000)),
        inStudy("SceneTwice", "expected only one of them",
                studyWith("[eye]", "builtin = \"plane\"\n[eye]")),
        inStudy("NoPoseForAFile", "eye.position_m",
                "[scene]\nfile = \"scene.ply\"\n[gaze]\nsource = \"trace.tsv\"\n"),
        inStudy("HalfAPose", "expected both or neither", studyWith("look_at_m = [0, 0, -1]\n", "")),
        inStudy("LooksAtItself", "expected look_at_m away from position_m",
                studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0, 0]")),
        inStudy("LooksAlongUp", "expected up not along the line of sight",
                studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 5, 0]")),
        inStudy("SecondsBackwards", "expected from before to",
                studyWith("seconds = [0, 0.6]", "seconds = [0.6, 0.2]")),
        inStudy("SecondsAfterTheEnd", "expected within the recording",
                studyWith("seconds = [0, 0.6]", "seconds = [10, 20]")),
        inStudy("OddImages", "expected even numbers",
                studyWith("size_px = [96, 72]", "size_px = [97, 72]")),
        inStudy("ScreenOfNoWidth", "screen.size_m",
                studyWith("size_m = [0.4, 0.3]", "size_m = [0, 0.3]")),
        inStudy("PathBackwards", "expected later than the keyframe before",
                studyWith("position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]",
                          "path = [{time_s=1, position_m=[0,0,0], look_at_m=[0,0,-1]},"
                          "{time_s=1, position_m=[0,0,0], look_at_m=[0,0,-1]}]")),
        inStudy("PathWithoutTime", "expected time_s in each keyframe",
                studyWith("position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]",
                          "path = [{position_m=[0,0,0], look_at_m=[0,0,-1]}]")),
        inStudy("PathWithUnknownKey", "did you mean position_m?",
                studyWith("position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]",
                          "path = [{time_s=1, positon_m=[0,0,0], look_at_m=[0,0,-1]}]")),
        inStudy("MissingMonitor", "monitor.json",
                studyWith("size_px = [640, 480]\nsize_m = [0.4, 0.3]\ndistance_m = 0.5",
                          "monitor = \"monitor.json\"")),
        withMonitor("MonitorNoJson", "monitor.json",
                    studyWith("size_px = [640, 480]\nsize_m = [0.4, 0.3]\ndistance_m = 0.5",
                              "monitor = \"monitor.json\""),
                    "{sizePix"),
        withMonitor("MonitorAndSizes", "expected only one of them",
                    studyWith("size_px = [640, 480]",
                              "monitor = \"monitor.json\"\nsize_px = [640, 480]"),
                    "{\"sizePix\": [640, 480], \"width\": 40, \"distance\": 50}")),
    [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Scene, BadInputs,
    testing::Values(
        inScene("NoPly", "scene.ply", "solid cube\n"), inScene("EmptyFile", "scene.ply", "\n"),
        inScene("NoPoints", "scene.ply", kPlyStart + "element vertex 0\n" + kPlyXyz),
        inScene("HugeCount", "scene.ply",
                kPlyStart + "element vertex 99999999999\n" + kPlyXyz + "0 0 -1\n"),
        inScene("NegativeCount", "scene.ply",
                kPlyStart + "element vertex -5\n" + kPlyXyz + "0 0 -1\n"),
        inScene("Truncated", "scene.ply",
                kPlyStart + "element vertex 3\n" + kPlyXyz + "0 0 -1\n0 0 -2\n"),
        inScene("TruncatedBinary", "scene.ply",
                "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kPlyXyz + "abc"),
        inScene("NoHeaderEnd", "scene.ply", kPlyStart + "element vertex 1\nproperty float x\n"),
        inScene("NoZ", "scene.ply",
                kPlyStart + "element vertex 1\nproperty float x\nproperty float y\n"
                            "end_header\n0 0\n"),
        inScene("UnknownType", "scene.ply",
                kPlyStart + "element vertex 1\nproperty quad x\n" + kPlyXyz + "0 0 0 -1\n"),
        inScene("UnknownFormat", "scene.ply",
                "ply\nformat ebcdic 1.0\nelement vertex 1\n" + kPlyXyz + "0 0 -1\n"),
        inScene("WordsForNumbers", "scene.ply",
                kPlyStart + "element vertex 1\n" + kPlyXyz + "zero 0 -1\n"),
        inScene("NoVertices", "scene.ply",
                kPlyStart + "element face 1\nproperty list uchar int i\nend_header\n3 0 1 2\n"),
        inScene("OnlyNaN", "scene.ply",
                kPlyStart + "element vertex 1\n" + kPlyXyz + "nan nan nan\n")),
    [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Trace, BadInputs,
    testing::Values(
        inTrace("Empty", "trace.tsv", "\n"),
        inTrace("OnlyAHeader", "trace.tsv", "time_s\tx_px\ty_px\n"),
        inTrace("OneSample", "trace.tsv", "time_s\tx_px\ty_px\n0\t1\t2\n"),
        inTrace("NoTimeColumn", "trace.tsv", "a\tx_px\ty_px\n0\t1\t2\n1\t1\t2\n"),
        inStudy("NamedColumnMissing", "gaze_left_x",
                studyWith("source = \"trace.tsv\"", "source = \"trace.tsv\"\nx = \"gaze_left_x\"")),
        inTrace("WordsForNumbers", "trace.tsv", "time_s\tx_px\ty_px\n0\tleft\t2\n0.01\t1\t2\n"),
        inTrace("TimeBackwards", "trace.tsv",
                "time_s\tx_px\ty_px\n0.02\t1\t2\n0.03\t1\t2\n0.01\t1\t2\n"),
        inTrace("ShortRow", "trace.tsv:3", "time_s\tx_px\ty_px\n0\t1\t2\n0.01\t1\n0.02\t1\t2\n"),
        inTrace("Binary", "trace.tsv", std::string("\x7f\x45\x4c\x46\0\0\0\0", 8)),
        inTrace("Utf16", "trace.tsv", std::string("\xff\xfet\0i\0m\0e\0\n\0", 12)),
        inTrace("EndlessLine", "trace.tsv", repeated("time_s\t", 100000)),
        inTrace("RateTooLow", "trace.tsv", "time_s\tx_px\ty_px\n0\t1\t2\n10\t1\t2\n20\t1\t2\n"),
        inTrace("AscWithoutSamples", "trace.tsv",
                "** CONVERTED FROM a.edf using edfapi 3.1\n** DATE: today\n")),
    [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Options, BadInputs,
    testing::Values(
        withOptions("UnknownOption", "--sise", {"--sise", "3x4"}),
        withOptions("SizeOfOneNumber", "--size 96: expected WIDTHxHEIGHT", {"--size", "96"}),
        withOptions("SizeOfWords", "--size axb", {"--size", "axb"}),
        withOptions("SizeTooLarge", "expected 2 numbers", {"--size", "100000x2"}),
        withOptions("SizeOfNothing", "--size", {"--size", ""}),
        withOptions("SecondsOfOneNumber", "--seconds 3: expected FROM:TO", {"--seconds", "3"}),
        withOptions("SecondsNotANumber", "--seconds nan:1", {"--seconds", "nan:1"}),
        withOptions("NoThreads", "--threads 0: expected an integer", {"--threads", "0"}),
        withOptions("NegativeThreads", "--threads -2", {"--threads", "-2"}),
        withOptions("ThreadsOfWords", "--threads many", {"--threads", "many"}),
        withOptions("UnknownMethod", "--method swep: expected a known method; the nearest is sweep",
                    {"--method", "swep"}),
        withOptions("MethodWithABadNumber", "expected accumulate:1 to",
                    {"--method", "accumulate:0"}),
        withOptions("PupilTooLarge", "--pupil 40: expected 0.5 to 12", {"--pupil", "40"}),
        withOptions("MissingScene", "missing.ply", {"--scene", "missing.ply"}),
        withOptions("SceneIsAFolder", "not a file", {"--scene", "."}),
        withOptions("MissingTrace", "missing.tsv", {"--trace", "missing.tsv"}),
        withOptions("TraceIsAFolder", "foci: .", {"--trace", "."}),
        withOptions("TraceIsADevice", "not a file", {"--trace", "/dev/null"}),
        withOptions("SceneIsADevice", "not a file", {"--scene", "/dev/zero"}),
        withOptions("ExtraArgument", "more.toml", {"more.toml"})),
    [](const auto& param) { return param.param.name; });

TEST(BadUsage, ExitsWithTwoInOneLine) {
  const TemporaryFolder folder;
  folder.write("study.toml", smallStudy());
  folder.write("scene.ply", squarePly(8, 1.0));
  folder.write("trace.tsv", steadyTrace());
  const std::vector<std::vector<std::string>> usages = {
      {},
      {"--nonsense"},
      {"replya"},
      {"replay"},
      {"replay", "missing.toml"},
      {"replay", "."},
      {"render", "study.toml"},
      {"render", "study.toml", "--out", "a.bmp"},
      {"render", "study.toml", "--out", "a"},
      {"render", "study.toml", "--out", "a.png", "--focus", "0"},
      {"render", "study.toml", "--out", "a.png", "--focus", "-1"},
      {"render", "study.toml", "--out", "a.png", "--focus", "near"},
      {"render", "study.toml", "--out", "a.png", "--focus", "1", "--gaze", "3,4"},
      {"render", "study.toml", "--out", "a.png", "--gaze", "3"},
      {"render", "study.toml", "--out", "a.png", "--gaze", "9000,4"},
      {"render", "study.toml", "--out", "a.png", "--depth", "d.png"},
      {"methods", "--all"},
  };
  for (const auto& usage : usages) {
    const Outcome outcome = runFoci(usage, folder.path());
    std::string typed;
    for (const auto& word : usage) typed += word + " ";
    EXPECT_EQ(outcome.exit_code, 2) << typed;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << typed << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.png")) << typed;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
