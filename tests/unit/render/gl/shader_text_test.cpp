// The shaders are what OpenGL's reference compiler takes: each driver has a compiler of its own,
// and this machine has few drivers.
#include "render/gl/shader_text.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

struct Stage {
  std::string name;
  std::vector<std::string> variants{""};  // words that are defined
};

/// Each stage with its switches on and off, in the combinations that foci renders with.
const std::vector<Stage> kStages{
    {"blur_cells"},
    {"cut", {"", "BODIES", "FIELD"}},
    {"encode"},
    {"gather", {"", "FILL"}},
    {"gaussian_blurs", {"", "LISTED"}},
    {"gaussian_composite",
     {"", "DEPTH", "JOBS", "JOBS DEPTH BEHIND", "JOBS FOLLOW", "JOBS DEPTH FOLLOW BEHIND",
      "JOBS FOLLOW JUDGE", "FIELD", "JOBS DEPTH FOLLOW BEHIND FIELD"}},
    {"gaussian_cut", {"", "FIELD"}},
    {"gaussian_errors"},
    {"gaussian_project",
     {"DEGREE=0", "DEGREE=0 CUT", "DEGREE=3", "DEGREE=3 CUT", "DEGREE=0 FIELD"}},
    {"interpolate", {"", "DEPTH", "WEIGHTS", "DEPTH WEIGHTS"}},
    {"lists", {"", "FILL"}},
    {"prefix_cut"},
    {"prefix_lists"},
    {"project",
     {"", "CUT", "BODIES", "CUT LENS BODIES", "LENS ASTIGMATIC", "CUT ASTIGMATIC",
      "CUT ASTIGMATIC FIELD", "CUT LENS SUB_APERTURES", "CUT LENS ASTIGMATIC SUB_APERTURES BODIES",
      "CUT LENS ASTIGMATIC SUB_APERTURES BODIES FIELD"}},
    {"sort"},
    {"sum", {"", "REPLACES"}},
    {"sweep",
     {"WORK_KIND=0u", "WORK_KIND=0u TRANSPARENT DEPTH", "WORK_KIND=1u LENS",
      "WORK_KIND=1u LENS ASTIGMATIC DEPTH TRANSPARENT", "WORK_KIND=2u SUB_APERTURES",
      "WORK_KIND=2u SUB_APERTURES ASTIGMATIC DEPTH TRANSPARENT", "WORK_KIND=0u FIELD",
      "WORK_KIND=1u LENS ASTIGMATIC FIELD", "WORK_KIND=2u SUB_APERTURES ASTIGMATIC FIELD"}},
    {"tiles"},
};

/// "A B=1" as lines of #define.
std::string definesOf(std::string words) {
  std::string lines = "#define TOTALS_BINDING 7\n";
  for (words += ' '; words.size() > 1; words.erase(0, words.find(' ') + 1)) {
    std::string word = words.substr(0, words.find(' '));
    if (const std::size_t is = word.find('='); is != std::string::npos) word[is] = ' ';
    lines += "#define " + word + '\n';
  }
  return lines;
}

TEST(ShaderText, TheReferenceCompilerTakesEachVariant) {
  if (std::system("command -v glslangValidator >/dev/null") != 0) {
    GTEST_SKIP() << "glslangValidator is not installed";
  }
  const TemporaryFolder folder;
  for (const Stage& stage : kStages) {
    for (std::size_t i = 0; i < stage.variants.size(); ++i) {
      folder.write(stage.name + '-' + std::to_string(i) + ".comp",
                   shaderText(stage.name, definesOf(stage.variants[i])));
    }
  }
  const std::string log = (folder.path() / "log").string();
  const int status =
      std::system(("glslangValidator " + folder.path().string() + "/*.comp >" + log).c_str());
  EXPECT_EQ(status, 0) << folder.read("log");
}

}  // namespace FOCI_FILE
}  // namespace foci
