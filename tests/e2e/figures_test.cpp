// Figures of a finished run: foci figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>
#include <string>

#include "tests/e2e/binary.h"
#include "tests/temporary_folder.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;

/// The whole numbers that an SVG shows as texts.
std::multiset<int> numbersIn(const std::string& svg) {
  std::multiset<int> numbers;
  for (std::size_t at = 0; (at = svg.find("<tspan", at)) != svg.npos; ++at) {
    const std::size_t from = svg.find('>', at) + 1, to = svg.find('<', from);
    const std::string word = svg.substr(from, to - from);
    if (!word.empty() && word.find_first_not_of("0123456789") == word.npos) {
      numbers.insert(std::stoi(word));
    }
  }
  return numbers;
}

/// A run in two trials: gaze rests on eight places of a wall for 0.25 s each.
class Figures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared.emplace();
    const TemporaryFolder& folder = *shared;
    folder.write("scene.ply", squarePly(40, 1.0));
    std::ostringstream trace;
    trace << "time_s\tx_px\ty_px\n";
    for (int i = 0; i < 200; ++i) {
      const int place = i / 25;
      trace << 0.01 * i << '\t' << 200 + 80 * (place % 4) << '\t' << 180 + 100 * (place / 4)
            << '\n';
    }
    folder.write("trace.tsv", trace.str());
    std::string study = smallStudy();
    study.replace(study.find("[0, 0.6]"), 8, "[0, 2.0]");
    folder.write("study.toml", study +
                                   "marker = true\n"
                                   "[[trial]]\nname = \"a\"\nstart_s = 0\nend_s = 0.99\n"
                                   "[[trial]]\nname = \"b\"\nstart_s = 1.0\nend_s = 2\n");
    const Outcome run = runFoci({"replay", "study.toml", "--out", "run"}, folder.path());
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  static void TearDownTestSuite() { shared.reset(); }
  Outcome foci(const std::vector<std::string>& arguments) const {
    return runFoci(arguments, folder.path());
  }
  std::size_t fixations(const std::string& trial = "") const {
    const auto rows = tableOf(folder.read("run/fixations.tsv"));
    return static_cast<std::size_t>(
        std::count_if(rows.begin() + 1, rows.end(),
                      [&](const auto& row) { return trial.empty() || row.at(3) == trial; }));
  }
  static std::optional<TemporaryFolder> shared;
  const TemporaryFolder& folder = *shared;
};
std::optional<TemporaryFolder> Figures::shared;

TEST_F(Figures, ShowEachFixationOfTheTableInTheSizeAskedFor) {
  const Outcome outcome = foci({"figures", "run", "--out", "out", "--width", "90"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  if (outcome.err.find("gnuplot") != outcome.err.npos) GTEST_SKIP() << "gnuplot is absent";
  EXPECT_EQ(outcome.err, "");
  for (const std::string kind : {"scanpath", "gaze-map", "heat-map", "time-series", "focus"}) {
    const std::string svg = folder.read("out/" + kind + ".svg");
    EXPECT_EQ(svg.substr(0, 4), "<svg") << kind;
    EXPECT_NE(svg.find("width=\"90.000mm\""), svg.npos) << kind;
    EXPECT_NE(outcome.out.find(kind), outcome.out.npos);
  }
  EXPECT_NE(folder.read("out/time-series.svg").find("height=\"110.000mm\""), std::string::npos);
  ASSERT_EQ(fixations(), 8u);
  // Beside those of the fixations stand the ends of the scale, 1 and 8.
  EXPECT_EQ(numbersIn(folder.read("out/scanpath.svg")),
            (std::multiset<int>{1, 1, 2, 3, 4, 5, 6, 7, 8, 8}));
  EXPECT_NE(folder.read("out/heat-map.svg").find("s/m²"), std::string::npos);
  EXPECT_NE(folder.read("out/scanpath.svg").find(">5 deg;"), std::string::npos);
}

TEST_F(Figures, OfOneTrialAreMadeWithoutTheRecording) {
  fs::rename(folder.path() / "trace.tsv", folder.path() / "away.tsv");
  const Outcome outcome =
      foci({"figures", "run", "--out", "png", "--format", "png", "--width", "60", "--trial", "b"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  if (outcome.err.find("gnuplot") != outcome.err.npos) GTEST_SKIP() << "gnuplot is absent";
  EXPECT_EQ(outcome.err,
            "foci: no heat-map: trace.tsv: is not there: run this in the folder where the run was "
            "made\n");
  EXPECT_FALSE(fs::exists(folder.path() / "png/heat-map.png"));
  EXPECT_EQ(folder.read("png/scanpath.png").substr(1, 3), "PNG");
  ASSERT_EQ(
      foci({"figures", "run", "--out", "svg", "--trial", "b", "--only", "scanpath"}).exit_code, 0);
  // The table's numbers, and the scale's.
  ASSERT_EQ(fixations("b"), 4u);
  EXPECT_EQ(numbersIn(folder.read("svg/scanpath.svg")), (std::multiset<int>{1, 4, 5, 6, 7, 8}));
  const Outcome wrong = foci({"figures", "run", "--out", "no", "--trial", "c"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("expected a trial of the run: a, b"), std::string::npos) << wrong.err;
  folder.write("trace.tsv", "another");
  const Outcome changed = foci({"figures", "run", "--out", "no", "--only", "heat-map"});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_NE(changed.err.find("trace.tsv: has changed since the run"), std::string::npos)
      << changed.err;
  fs::rename(folder.path() / "away.tsv", folder.path() / "trace.tsv");
}

/// The words of a text that begin behind `mark` and go on up to one of `ends`.
std::set<std::string> wordsBehind(const std::string& mark, const std::string& ends,
                                  const std::string& text) {
  std::set<std::string> words;
  for (std::size_t at = 0; (at = text.find(mark, at)) != text.npos;) {
    at += mark.size();
    words.insert(text.substr(at, text.find_first_of(ends, at) - at));
  }
  return words;
}

TEST_F(Figures, StandBesideMethodsThatCiteTheirSources) {
  const auto check = [&](const std::string& run) {
    const std::string methods = folder.read(run + "/methods.md");
    std::string entries = folder.read(run + "/references.bib");
    for (char& c : entries) c = c == '{' ? '\n' : c;
    std::set<std::string> cited = wordsBehind("@", "];.", methods);
    cited.erase("");  // the example of the comment
    std::set<std::string> listed;
    for (const std::string kind :
         {"@software\n", "@inproceedings\n", "@techreport\n", "@article\n"}) {
      listed.merge(wordsBehind(kind, ",", entries));
    }
    EXPECT_EQ(cited, listed) << methods;
    return methods;
  };
  const std::string plain = check("run");
  EXPECT_NE(plain.find("640 × 480 px and 0.400 × 0.300 m, seen from 0.50 m"), plain.npos) << plain;
  EXPECT_NE(plain.find("found 8 fixations"), plain.npos) << plain;
  EXPECT_NE(plain.find("`output.fps` = 10"), plain.npos) << plain;
  EXPECT_EQ(plain.find("observer.chromatic"), plain.npos) << plain;
  const Outcome run =
      foci({"replay", "study.toml", "--out", "eye", "--set", "observer.chromatic=true", "--set",
            "gaze.detector=\"ivt\"", "--set", "observer.age_years=40"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string other = check("eye");
  for (const char* words : {"@thibos1992", "@salvucci2000", "@berrio2010", "at least 30 deg/s",
                            "`observer.age_years` = 40"}) {
    EXPECT_NE(other.find(words), other.npos) << words << '\n' << other;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
