// Man pages and completions say what --help says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

namespace fs = std::filesystem;

class Manual : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(runFoci({"manual", "--out", "manual"}, folder.path()).exit_code, 0);
  }

  /// What bash offers after these words.
  std::set<std::string> completed(const std::vector<std::string>& words) {
    std::string script = "cd '" + folder.path().string() + "'; source manual/completions/foci; " +
                         "COMP_CWORD=" + std::to_string(words.size() - 1) + "; COMP_WORDS=(";
    for (const std::string& word : words) script += "'" + word + "' ";
    folder.write("complete.sh", script + "); _foci; printf '%s\\n' \"${COMPREPLY[@]}\"\n");
    return linesOf("bash '" + (folder.path() / "complete.sh").string() + "'");
  }

  static std::set<std::string> linesOf(const std::string& command) {
    const std::string binaries = fs::path(FOCI_BINARY).parent_path().string();
    FILE* shell = popen(("export PATH='" + binaries + "':\"$PATH\"; " + command).c_str(), "r");
    std::set<std::string> offered;
    char line[4096];
    while (std::fgets(line, sizeof line, shell) != nullptr) {
      offered.insert(std::string(line).substr(0, std::string(line).find('\n')));
    }
    pclose(shell);
    return offered;
  }

  TemporaryFolder folder;
};

TEST_F(Manual, HasAPageForEachCommandOfTheHelp) {
  const std::string help = runFoci({"--help"}, folder.path()).out;
  const std::regex command("\n  ([a-z]+) ");
  std::size_t commands = 0;
  const std::string list = help.substr(help.find("Subcommands:"));
  for (std::sregex_iterator it(list.begin(), list.end(), command), end; it != end; ++it) {
    ++commands;
    EXPECT_TRUE(fs::exists(folder.path() / ("manual/man1/foci-" + (*it)[1].str() + ".1")))
        << (*it)[1];
  }
  EXPECT_GE(commands, 15u);
  EXPECT_TRUE(fs::exists(folder.path() / "manual/man1/foci-calibrate-gaze.1"));
}

TEST_F(Manual, PagesHaveEveryOptionOfTheHelp) {
  for (const std::string command : {"replay", "live", "render", "join", "prepare"}) {
    std::string page = folder.read("manual/man1/foci-" + command + ".1");
    page.erase(std::remove(page.begin(), page.end(), '\\'), page.end());
    const std::string help = runFoci({command, "--help"}, folder.path()).out;
    const std::regex option("--[a-z-]+");
    std::size_t options = 0;
    for (std::sregex_iterator it(help.begin(), help.end(), option), end; it != end; ++it) {
      EXPECT_NE(page.find(it->str()), std::string::npos) << command << it->str();
      ++options;
    }
    EXPECT_GE(options, 3u);
  }
}

TEST_F(Manual, NamesEachCommandWithAWholeSentence) {
  const std::regex name("\n\\.SH NAME\n[a-z\\\\-]+ \\\\- ([^\n]+)\n");
  std::size_t pages = 0;
  for (const auto& file : fs::directory_iterator(folder.path() / "manual/man1")) {
    if (file.path().extension() != ".1") continue;
    const std::string page = folder.read(fs::relative(file.path(), folder.path()).string());
    std::smatch found;
    ASSERT_TRUE(std::regex_search(page, found, name)) << file.path();
    const std::string sentence = found[1];
    EXPECT_EQ(sentence.back(), '.') << file.path() << ": " << sentence;
    EXPECT_EQ(sentence.find(". "), std::string::npos) << file.path() << ": " << sentence;
    ++pages;
  }
  EXPECT_GE(pages, 20u);
}

TEST_F(Manual, CompletesCommandsOptionsKeysAndFiles) {
  EXPECT_EQ(completed({"foci", "repl"}), std::set<std::string>{"replay"});
  EXPECT_EQ(completed({"foci", "replay", "--tra"}), std::set<std::string>{"--trace"});
  EXPECT_EQ(completed({"foci", "calibrate", "gaz"}), std::set<std::string>{"gaze"});
  EXPECT_EQ(completed({"foci", "render", "--set", "focus.fixed"}),
            std::set<std::string>{"focus.fixed_D="});
  EXPECT_EQ(completed({"foci", "render", "--view", "top"}), std::set<std::string>{"top-bottom"});
  EXPECT_EQ(completed({"foci", "live", "--method", "pin"}), std::set<std::string>{"pinhole"});
  EXPECT_EQ(completed({"foci", "replay", "--device", ""}),
            (std::set<std::string>{"auto", "cpu", "gpu"}));
  EXPECT_EQ(completed({"foci", "events", "--units", "d"}), std::set<std::string>{"deg"});
  folder.write("my study.toml", "");
  EXPECT_EQ(completed({"foci", "replay", "my"}), std::set<std::string>{"my study.toml"});
}

TEST_F(Manual, CompletesInFish) {
  if (std::system("command -v fish >/dev/null") != 0) GTEST_SKIP() << "fish is not installed";
  const auto offered = [&](const std::string& typed) {
    return linesOf("cd '" + folder.path().string() + "' && fish --no-config -c 'source " +
                   "manual/completions/foci.fish; complete -C \"" + typed + "\"' | cut -f1");
  };
  EXPECT_EQ(offered("foci repl"), std::set<std::string>{"replay"});
  EXPECT_EQ(offered("foci replay --tra"), std::set<std::string>{"--trace"});
  EXPECT_EQ(offered("foci calibrate gaz"), std::set<std::string>{"gaze"});
  EXPECT_EQ(offered("foci render --set focus.fixed"), std::set<std::string>{"focus.fixed_D="});
  EXPECT_EQ(offered("foci render --view top"), std::set<std::string>{"top-bottom"});
  folder.write("my study.toml", "");
  EXPECT_EQ(offered("foci replay my"), std::set<std::string>{"my study.toml"});
}

TEST_F(Manual, CompletesInZsh) {
  if (std::system("command -v zsh >/dev/null") != 0) GTEST_SKIP() << "zsh is not installed";
  // The completion system's own commands, so that what they are given shows.
  const auto offered = [&](const std::string& words, int current, const std::string& prefix) {
    return linesOf(
        "cd '" + folder.path().string() + "' && zsh -f -c 'compadd() { print -l -- $@ }; " +
        "_files() { print FILES }; words=(" + words + "); CURRENT=" + std::to_string(current) +
        "; PREFIX=" + prefix + "; source manual/completions/_foci'");
  };
  EXPECT_TRUE(offered("foci repl", 2, "repl").contains("replay"));
  EXPECT_TRUE(offered("foci replay --tra", 3, "--tra").contains("--trace"));
  EXPECT_FALSE(offered("foci replay --tra", 3, "--tra").contains("--gaze"));
  EXPECT_TRUE(offered("foci calibrate gaz", 3, "gaz").contains("gaze"));
  EXPECT_TRUE(offered("foci render --set focus", 4, "focus").contains("focus.fixed_D="));
  EXPECT_TRUE(offered("foci render --view top", 4, "top").contains("top-bottom"));
  EXPECT_FALSE(offered("foci render --view top", 4, "top").contains("FILES"));
  EXPECT_EQ(offered("foci replay my", 3, "my"), std::set<std::string>{"FILES"});
}

TEST_F(Manual, TheVersionNamesTheCommit) {
  const std::string version = runFoci({"--version"}, folder.path()).out;
  EXPECT_TRUE(std::regex_match(version, std::regex(R"(foci \d+\.\d+\.\d+( \([0-9a-z.-]+\))?\n)")))
      << version;
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
