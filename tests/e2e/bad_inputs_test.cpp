// Whatever is wrong outside, the program says so in one line, exits 2 and leaves no folder behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace {

struct BadInput {
  std::string name;
  std::string says;  ///< part of the message
  /// What takes the place of the good files' bytes; empty: the good one.
  std::string study = {}, study_adds = {}, scene = {}, trace = {}, monitor = {};
  std::vector<std::string> options = {};
};

void PrintTo(const BadInput& input, std::ostream* out) { *out << input.name; }

class BadInputs : public testing::TestWithParam<BadInput> {};

TEST_P(BadInputs, AreRefusedInOneLineAndNothingIsLeft) {
  const BadInput& bad = GetParam();
  const TemporaryFolder folder;
  folder.write("study.toml", (bad.study.empty() ? smallStudy() : bad.study) + bad.study_adds);
  folder.write("scene.ply", bad.scene.empty() ? squarePly(8, 1.0) : bad.scene);
  folder.write("trace.tsv", bad.trace.empty() ? steadyTrace() : bad.trace);
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
        BadInput{"UnknownKey", "did you mean observer.pupil_mm?",
                 .study_adds = "[observer]\npupil_m = 4\n"},
        BadInput{"UnknownSection", "did you mean", .study_adds = "[observers]\npupil_mm = 4\n"},
        BadInput{"UnknownKeyNamesItsLine",
                 "study.toml:18: ", .study_adds = "\n[observer]\nx = 4\n"},
        BadInput{"UnknownTopKey", "did you mean seed?", .study = "sead = 3\n" + smallStudy()},
        BadInput{"TextForANumber", "observer.pupil_mm = \"4\": expected 0.5 to 12",
                 .study_adds = "[observer]\npupil_mm = \"4\"\n"},
        BadInput{"NumberTooLarge", "observer.pupil_mm = 40: expected 0.5 to 12",
                 .study_adds = "[observer]\npupil_mm = 40\n"},
        BadInput{"NegativeNumber", "expected 0.5 to 12",
                 .study_adds = "[observer]\npupil_mm = -4\n"},
        BadInput{"NotANumber", "expected 0.5 to 12", .study_adds = "[observer]\npupil_mm = nan\n"},
        BadInput{"InfiniteNumber", "expected 0.5 to 12",
                 .study_adds = "[observer]\npupil_mm = inf\n"},
        BadInput{"DateForANumber", "a date or time",
                 .study_adds = "[observer]\npupil_mm = 1979-05-27\n"},
        BadInput{"TableForANumber", "observer.pupil_mm = {...}",
                 .study_adds = "[observer]\npupil_mm = { mm = 4 }\n"},
        BadInput{"NumberForASection", "expected a section", .study = "eye = 3\n"},
        BadInput{"HugeInteger", "expected an integer",
                 .study = "seed = 9223372036854775807\n" + smallStudy()},
        BadInput{"IntegerBeyond64Bits", "study.toml",
                 .study = "seed = 99999999999999999999999\n" + smallStudy()},
        BadInput{"FractionForAnInteger", "expected an integer",
                 .study = "seed = 1.5\n" + smallStudy()},
        BadInput{"TextForAFlag", "expected true or false", .study_adds = "marker = \"yes\"\n"},
        BadInput{"ShortVector", "expected 3 numbers",
                 .study = studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0]")},
        BadInput{"LongVector", "expected 3 numbers",
                 .study = studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0, -1, 4]")},
        BadInput{"MixedVector", "expected 3 numbers",
                 .study = studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0, \"a\"]")},
        BadInput{"EmptyText", "expected a file's name",
                 .study = studyWith("file = \"scene.ply\"", "file = \"\"")},
        BadInput{"UnknownWord", "\"gallery\" \"plane\"",
                 .study = studyWith("file = \"scene.ply\"", "builtin = \"galery\"")},
        BadInput{"UnknownMethod", "expected one of", .study_adds = "[render]\nmethod = \"swep\"\n"},
        BadInput{"DuplicateKey", "study.toml:3",
                 .study = studyWith("[eye]", "file = \"b.ply\"\n[eye]")},
        BadInput{"SyntaxError", "study.toml:2", .study = "seed = 1\n[scene\n"},
        BadInput{"NoValue", "study.toml", .study = "seed =\n"},
        BadInput{"DeepNesting", "nested too deeply", .study = "seed = " + repeated("[", 100000)},
        BadInput{"LongDottedKey", "expected lines of at most",
                 .study = repeated("a.", 100000) + "a = 1\n"},
        BadInput{"Binary", "NUL byte", .study = std::string("seed = 1\n\0\1\2", 12)},
        BadInput{"HugeFile", "not a study", .study = repeated("# a comment of many\n", 400000)},
        BadInput{"SceneTwice", "expected only one of them",
                 .study = studyWith("[eye]", "builtin = \"plane\"\n[eye]")},
        BadInput{"NoPoseForAFile", "eye.position_m",
                 .study = "[scene]\nfile = \"scene.ply\"\n[gaze]\nsource = \"trace.tsv\"\n"},
        BadInput{"HalfAPose", "expected both or neither",
                 .study = studyWith("look_at_m = [0, 0, -1]\n", "")},
        BadInput{"LooksAtItself", "expected look_at_m away from position_m",
                 .study = studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 0, 0]")},
        BadInput{"LooksAlongUp", "expected up not along the line of sight",
                 .study = studyWith("look_at_m = [0, 0, -1]", "look_at_m = [0, 5, 0]")},
        BadInput{"SecondsBackwards", "expected from before to",
                 .study = studyWith("seconds = [0, 0.6]", "seconds = [0.6, 0.2]")},
        BadInput{"SecondsAfterTheEnd", "expected within the recording",
                 .study = studyWith("seconds = [0, 0.6]", "seconds = [10, 20]")},
        BadInput{"OddPictures", "expected even numbers",
                 .study = studyWith("size_px = [96, 72]", "size_px = [97, 72]")},
        BadInput{"ScreenOfNoWidth", "screen.size_m",
                 .study = studyWith("size_m = [0.4, 0.3]", "size_m = [0, 0.3]")},
        BadInput{"PathBackwards", "expected later than the keyframe before",
                 .study = studyWith("position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]",
                                    "path = [{time_s=1, position_m=[0,0,0], look_at_m=[0,0,-1]},"
                                    "{time_s=1, position_m=[0,0,0], look_at_m=[0,0,-1]}]")},
        BadInput{"PathWithoutTime", "expected time_s in each keyframe",
                 .study = studyWith("position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]",
                                    "path = [{position_m=[0,0,0], look_at_m=[0,0,-1]}]")},
        BadInput{"PathWithUnknownKey", "did you mean position_m?",
                 .study = studyWith("position_m = [0, 0, 0]\nlook_at_m = [0, 0, -1]",
                                    "path = [{time_s=1, positon_m=[0,0,0], look_at_m=[0,0,-1]}]")},
        BadInput{"MissingMonitor", "monitor.json",
                 .study = studyWith("size_px = [640, 480]\nsize_m = [0.4, 0.3]\ndistance_m = 0.5",
                                    "monitor = \"monitor.json\"")},
        BadInput{"MonitorNoJson", "monitor.json",
                 .study = studyWith("size_px = [640, 480]\nsize_m = [0.4, 0.3]\ndistance_m = 0.5",
                                    "monitor = \"monitor.json\""),
                 .monitor = "{sizePix"},
        BadInput{"MonitorAndSizes", "expected only one of them",
                 .study = studyWith("size_px = [640, 480]",
                                    "monitor = \"monitor.json\"\nsize_px = [640, 480]"),
                 .monitor = "{\"sizePix\": [640, 480], \"width\": 40, \"distance\": 50}"}),
    [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Scene, BadInputs,
    testing::Values(
        BadInput{"NoPly", "scene.ply", .scene = "solid cube\n"},
        BadInput{"EmptyFile", "scene.ply", .scene = "\n"},
        BadInput{"NoPoints", "scene.ply", .scene = kPlyStart + "element vertex 0\n" + kPlyXyz},
        BadInput{"HugeCount", "scene.ply",
                 .scene = kPlyStart + "element vertex 99999999999\n" + kPlyXyz + "0 0 -1\n"},
        BadInput{"NegativeCount", "scene.ply",
                 .scene = kPlyStart + "element vertex -5\n" + kPlyXyz + "0 0 -1\n"},
        BadInput{"Truncated", "scene.ply",
                 .scene = kPlyStart + "element vertex 3\n" + kPlyXyz + "0 0 -1\n0 0 -2\n"},
        BadInput{
            "TruncatedBinary", "scene.ply",
            .scene = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kPlyXyz + "abc"},
        BadInput{"NoHeaderEnd", "scene.ply",
                 .scene = kPlyStart + "element vertex 1\nproperty float x\n"},
        BadInput{"NoZ", "scene.ply",
                 .scene = kPlyStart + "element vertex 1\nproperty float x\nproperty float y\n"
                                      "end_header\n0 0\n"},
        BadInput{
            "UnknownType", "scene.ply",
            .scene = kPlyStart + "element vertex 1\nproperty quad x\n" + kPlyXyz + "0 0 0 -1\n"},
        BadInput{"UnknownFormat", "scene.ply",
                 .scene = "ply\nformat ebcdic 1.0\nelement vertex 1\n" + kPlyXyz + "0 0 -1\n"},
        BadInput{"WordsForNumbers", "scene.ply",
                 .scene = kPlyStart + "element vertex 1\n" + kPlyXyz + "zero 0 -1\n"},
        BadInput{"NoVertices", "scene.ply",
                 .scene = kPlyStart +
                          "element face 1\nproperty list uchar int i\nend_header\n3 0 1 2\n"},
        BadInput{"OnlyNaN", "scene.ply",
                 .scene = kPlyStart + "element vertex 1\n" + kPlyXyz + "nan nan nan\n"}),
    [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Trace, BadInputs,
    testing::Values(
        BadInput{"Empty", "trace.tsv", .trace = "\n"},
        BadInput{"OnlyAHeader", "trace.tsv", .trace = "time_s\tx_px\ty_px\n"},
        BadInput{"OneSample", "trace.tsv", .trace = "time_s\tx_px\ty_px\n0\t1\t2\n"},
        BadInput{"NoTimeColumn", "trace.tsv", .trace = "a\tx_px\ty_px\n0\t1\t2\n1\t1\t2\n"},
        BadInput{"NamedColumnMissing", "gaze_left_x",
                 .study = studyWith("source = \"trace.tsv\"",
                                    "source = \"trace.tsv\"\nx = \"gaze_left_x\"")},
        BadInput{"WordsForNumbers", "trace.tsv",
                 .trace = "time_s\tx_px\ty_px\n0\tleft\t2\n0.01\t1\t2\n"},
        BadInput{"TimeBackwards", "trace.tsv",
                 .trace = "time_s\tx_px\ty_px\n0.02\t1\t2\n0.01\t1\t2\n0.03\t1\t2\n"},
        BadInput{"ShortRow", "trace.tsv:3",
                 .trace = "time_s\tx_px\ty_px\n0\t1\t2\n0.01\t1\n0.02\t1\t2\n"},
        BadInput{"Binary", "trace.tsv", .trace = std::string("\x7f\x45\x4c\x46\0\0\0\0", 8)},
        BadInput{"Utf16", "trace.tsv", .trace = std::string("\xff\xfet\0i\0m\0e\0\n\0", 12)},
        BadInput{"EndlessLine", "trace.tsv", .trace = repeated("time_s\t", 100000)},
        BadInput{"RateTooLow", "trace.tsv",
                 .trace = "time_s\tx_px\ty_px\n0\t1\t2\n10\t1\t2\n20\t1\t2\n"},
        BadInput{"AscWithoutSamples", "trace.tsv",
                 .trace = "** CONVERTED FROM a.edf using edfapi 3.1\n** DATE: today\n"}),
    [](const auto& param) { return param.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Options, BadInputs,
    testing::Values(
        BadInput{"UnknownOption", "--sise", .options = {"--sise", "3x4"}},
        BadInput{"SizeOfOneNumber", "--size 96: expected WIDTHxHEIGHT",
                 .options = {"--size", "96"}},
        BadInput{"SizeOfWords", "--size axb", .options = {"--size", "axb"}},
        BadInput{"SizeTooLarge", "expected 2 numbers", .options = {"--size", "100000x2"}},
        BadInput{"SizeOfNothing", "--size", .options = {"--size", ""}},
        BadInput{"SecondsOfOneNumber", "--seconds 3: expected FROM:TO",
                 .options = {"--seconds", "3"}},
        BadInput{"SecondsNotANumber", "--seconds nan:1", .options = {"--seconds", "nan:1"}},
        BadInput{"NoThreads", "--threads 0: expected an integer", .options = {"--threads", "0"}},
        BadInput{"NegativeThreads", "--threads -2", .options = {"--threads", "-2"}},
        BadInput{"ThreadsOfWords", "--threads many", .options = {"--threads", "many"}},
        BadInput{"UnknownMethod", "--method swep", .options = {"--method", "swep"}},
        BadInput{"PupilTooLarge", "--pupil 40: expected 0.5 to 12", .options = {"--pupil", "40"}},
        BadInput{"MissingScene", "missing.ply", .options = {"--scene", "missing.ply"}},
        BadInput{"SceneIsAFolder", "expected", .options = {"--scene", "."}},
        BadInput{"MissingTrace", "missing.tsv", .options = {"--trace", "missing.tsv"}},
        BadInput{"TraceIsAFolder", "foci: .", .options = {"--trace", "."}},
        BadInput{"ExtraArgument", "more.toml", .options = {"more.toml"}}),
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

}  // namespace
}  // namespace foci::e2e
