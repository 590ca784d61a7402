// `foci methods`, and a frame of each method.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/e2e/binary.h"

namespace foci::e2e {
namespace FOCI_FILE {

using Json = nlohmann::json;

TEST(Methods, AreListedInColumnsAndAsJson) {
  const TemporaryFolder folder;
  const Outcome table = runFoci({"methods"}, folder.path());
  ASSERT_EQ(table.exit_code, 0) << table.err;
  const Json list = Json::parse(runFoci({"methods", "--json"}, folder.path()).out);

  std::istringstream lines(table.out);
  std::set<std::size_t> summary_columns, source_columns;
  for (const Json& method : list) {
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    const std::string name = method["name"], summary = method["summary"], source = method["source"];
    EXPECT_FALSE(summary.empty() || source.empty()) << name;
    EXPECT_EQ(line.substr(0, name.size()), name);
    EXPECT_EQ(line.substr(name.size(), 2) == ":N", method.contains("default_n"));
    summary_columns.insert(line.find(summary, name.size()));
    source_columns.insert(line.rfind(source));
    EXPECT_TRUE(line.ends_with(source));
    EXPECT_EQ(line.find("  GPU  ") != std::string::npos, method["gpu"].get<bool>()) << line;
  }
  std::string more;
  EXPECT_FALSE(std::getline(lines, more)) << more;
  EXPECT_EQ(summary_columns.size(), 1u);
  EXPECT_EQ(source_columns.size(), 1u);
}

TEST(Methods, EachRendersAnImage) {
  const TemporaryFolder folder;
  folder.write("study.toml", smallStudy());
  folder.write("scene.ply", squarePly(24, 1.0));
  folder.write("trace.tsv", steadyTrace());
  const Json list = Json::parse(runFoci({"methods", "--json"}, folder.path()).out);
  for (const Json& method : list) {
    std::string spec = method["name"];
    if (method.contains("default_n")) spec += ":2";
    const Outcome outcome = runFoci(
        {"render", "study.toml", "--out", "a.pfm", "--focus", "0.5", "--method", spec, "--json"},
        folder.path());
    ASSERT_EQ(outcome.exit_code, 0) << spec << ": " << outcome.err;
    EXPECT_EQ(Json::parse(outcome.out)["method"], spec);
    EXPECT_TRUE(folder.read("a.pfm").starts_with("PF\n96 72\n")) << spec;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci::e2e
