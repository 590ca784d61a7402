#include "app/study/study_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "app/study/study.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

TEST(StudyText, AsTomlIsTheSameStudy) {
  const TemporaryFolder scratch;
  Study study;
  study.eye.path = {
      {.time_s = 0.5, .position_m = {0, 1, 2}, .look_at_m = {0, 0, 0}, .up = {}},
      {.time_s = 1.5, .position_m = {0, 1, 3}, .look_at_m = {0, 0, 0}, .up = glm::dvec3(0, 1, 0)}};
  study.observer.ipd_mm = 100.0 / 1.7;
  study.output.seconds = glm::dvec2(0.1, 1e5);
  study.scene.file = "/somewhere/with \"quotes\".ply";
  study.trials = {{.name = "a", .first_s = 1.0, .last_s = 2.0},
                  {.name = "b", .first_s = 2.0, .last_s = 3.0, .type = "near"}};
  const std::filesystem::path file = scratch.path() / "written.toml";
  std::ofstream(file, std::ios::binary) << studyToml(study);
  const auto before = resolvedKeys(study), after = resolvedKeys(readStudy(file));
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(before[i].json, after[i].json) << before[i].name;
  }
}

TEST(StudyText, AnnotatedIsTheSameStudyWithItsMeaning) {
  const TemporaryFolder scratch;
  Study study;
  study.scene.file = scratch.path() / "scans/lion.ply";
  study.scene.scale_m = 0.01;
  study.eye.position_m = glm::dvec3(0.1, 1.0 / 3.0, 2e-7);
  study.eye.look_at_m = glm::dvec3(0.0);
  study.eye.up = {0, 0, 1};
  study.observer.pupil_mm = 6.5;
  study.seed = 7;  // a key above the first section
  const std::string text = annotatedStudyToml(study, scratch.path(), "first\nsecond");
  EXPECT_TRUE(text.starts_with("# first\n# second\n")) << text;
  EXPECT_NE(text.find("file = \"scans/lion.ply\""), std::string::npos) << text;
  EXPECT_EQ(text.find("fps"), std::string::npos) << text;  // as by default
  EXPECT_NE(text.find("pupil_mm = 6.5  # diameter"), std::string::npos) << text;
  const auto before = resolvedKeys(study),
             after = resolvedKeys(readStudy(scratch.write("study.toml", text)));
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(before[i].json, after[i].json) << before[i].name;
  }
}

TEST(StudyKeys, PageIsCurrent) {
  EXPECT_EQ(textOf(std::filesystem::path(FOCI_SOURCE_DIR) / "docs/studies.md"), studyKeysMarkdown())
      << "foci keys --markdown > docs/studies.md";
}

}  // namespace FOCI_FILE
}  // namespace foci
