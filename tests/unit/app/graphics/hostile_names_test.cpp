// A name from outside goes to many targets. None of them may take a part of it for its own
// language.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/graphics/drawing.h"
#include "app/graphics/html.h"
#include "app/platform/gnuplot.h"
#include "app/platform/json_text.h"
#include "app/platform/shell.h"
#include "app/replay/compare.h"
#include "app/replay/gaze_in_scene.h"
#include "app/replay/recordings.h"
#include "app/study/framing.h"
#include "base/text.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

std::vector<std::string> hostileNames(const std::string& file = "x") {
  return {"`touch " + file + "`",
          "$(touch " + file + ")",
          "'; system(\"touch " + file + "\"); print '",
          "\"; system('touch " + file + "'); print \"",
          "<script>document.title=1</script>",
          "\"><img src=x onerror=alert(1)>",
          "'><svg onload=alert(1)>",
          "a\tb\nc\rd",
          "\x1b]0;title\x07\x1b[2J",
          "a\\nb\\",
          "%s%n{}",
          "@macro #comment",
          "\xff\xfe not UTF-8",
          "right to left \xe2\x80\xae"
          "gnp.exe",
          std::string("NUL \0 inside", 12),
          "]]>--><!--",
          "-rf"};
}

bool isPlainLine(const std::string& text) {
  return std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return c >= 0x20 && c != 0x7f; });
}

/// Numbers of fields between tabs, by line.
std::vector<std::ptrdiff_t> fieldCounts(const std::string& table) {
  std::vector<std::ptrdiff_t> counts(1, 1);
  for (const char c : table) {
    counts.back() += c == '\t';
    if (c == '\n') counts.push_back(1);
  }
  counts.pop_back();  // after the last line's end
  return counts;
}

void expectRectangular(const std::string& table, std::size_t lines) {
  const auto counts = fieldCounts(table);
  EXPECT_EQ(counts.size(), lines) << table;
  for (const auto count : counts) EXPECT_EQ(count, counts.front()) << table;
}

TEST(HostileNames, GnuplotPrintsThemAndRunsNothing) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "touched").string();
  if (!runGnuplot("set print '-'\nprint 1\n").image) GTEST_SKIP() << "gnuplot is not installed";
  for (const std::string& name : hostileNames(file)) {
    const auto printed = runGnuplot("set print '-'\nprint " + gnuplotString(name) + "\n").image;
    EXPECT_EQ(*printed, visible(name) + "\n");
    Drawing drawing{.size_px = {600.0, 300.0}};
    drawing.discs.push_back({.at_px = {5.0, 15.0}, .radius_px = 3.0, .color = "#000000"});
    drawing.texts.push_back({.at_px = {5.0, 15.0}, .words = name});
    EXPECT_TRUE(pngOf(drawing).image->starts_with("\x89PNG")) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(HostileNames, AreTextInHtmlAndSvg) {
  for (const std::string& name : hostileNames()) {
    for (const std::string& html : {escaped(name), hrefOf(name)}) {
      EXPECT_EQ(html.find_first_of("<>\"'"), std::string::npos) << html;
      EXPECT_TRUE(isPlainLine(html)) << html;
    }
    Drawing drawing{.size_px = {60.0, 30.0}, .title = name, .description = name};
    drawing.texts.push_back({.at_px = {5.0, 15.0}, .words = name});
    drawing.discs.push_back({.at_px = {5.0, 15.0},
                             .radius_px = 3.0,
                             .color = "#000000",
                             .title = name,
                             .link = hrefOf(name),
                             .data = hrefOf(name)});
    const std::string svg = svgOf(drawing);
    EXPECT_EQ(std::count(svg.begin(), svg.end(), '<'), 14) << svg;
    EXPECT_EQ(std::count(svg.begin(), svg.end(), '>'), 14) << svg;
  }
  EXPECT_EQ(hrefOf("a b/\xc3\xa4#?.html"), "a%20b/%C3%A4%23%3F.html");
  EXPECT_EQ(hrefOf("javascript:alert(1)"), "javascript%3Aalert%281%29");
}

TEST(HostileNames, AreWordsOfAShell) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "touched").string();
  for (const std::string& name : hostileNames(file)) {
    if (name.find('\0') != name.npos) continue;  // no argument has one
    const auto script = folder.write("s.sh", "printf %s " + shellWord(name) + "\n");
    std::FILE* const shell = popen(("bash " + script.string()).c_str(), "r");
    std::array<char, 256> printed{};
    const std::size_t count = std::fread(printed.data(), 1, printed.size(), shell);
    EXPECT_EQ(pclose(shell), 0);
    EXPECT_EQ(std::string(printed.data(), count), name);
    EXPECT_TRUE(isPlainLine(shellWord(name)));
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(HostileNames, AreStringsOfJson) {
  for (const std::string& name : hostileNames()) {
    const std::string json = jsonText({{"name", name}}), quoted = quotedText(name);
    EXPECT_TRUE(isPlainLine(json)) << json;
    EXPECT_TRUE(isPlainLine(quoted)) << quoted;
    if (name.find('\xff') != name.npos) continue;  // JSON has no other bytes than UTF-8
    EXPECT_EQ(nlohmann::json::parse(json).at("name"), name);
    EXPECT_EQ(nlohmann::json::parse(quoted), name);
  }
}

TEST(HostileNames, AreFieldsOfTables) {
  for (const std::string& name : hostileNames()) {
    GazeInScene gaze;
    gaze.objects = {{.name = {}}, {.name = name, .dwell_s = 1.0}};
    gaze.samples = {{.valid = true, .hit = SightHit{.distance_m = 1.0, .object = 1}}, {}};
    gaze.fixations = {{.duration_s = 1.0, .hit = SightHit{.object = 1}}, {}};
    const std::vector<TraceTrial> trials{{.name = name, .first_s = 0.0, .last_s = 1.0}};
    expectRectangular(sightTable(gaze, trials, name), 3);
    expectRectangular(objectTable(gaze, trials), 2);

    ComparedRun run{.folder = name, .name = name};
    run.frames.resize(2);
    run.frames[1].time_s = 1.0;
    run.dwell_s[name] = 2.0;
    run.fixations.resize(1);
    expectRectangular(compareTable({run, run}, gazeOverlaps({run, run})), 3);

    BatchResult good{.recording = {.trace = name, .name = name}}, bad = good;
    bad.problem = name;
    expectRectangular(recordingsTable({good, bad}), 3);
  }
}

TEST(HostileNames, AreLinesOfATerminal) {
  for (const std::string& name : hostileNames()) {
    SceneFacts facts;
    facts.remarks = {name};
    facts.materials = {{.name = name, .textures = {{.name = name}}}};
    std::string text = sceneText(facts, {});
    std::erase(text, '\n');
    EXPECT_TRUE(isPlainLine(text)) << text;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
