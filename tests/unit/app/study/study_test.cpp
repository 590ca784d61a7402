#include "app/study/study.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

class StudyFile : public testing::Test {
 protected:
  Study study(const std::string& toml) {
    std::ofstream(folder_ / "study.toml", std::ios::binary) << toml;
    return readStudy(folder_ / "study.toml");
  }

  std::string refusal(const std::string& toml) {
    try {
      study(toml);
    } catch (const InputError& error) {
      const std::string prefix = (folder_ / "study.toml").string() + ":";
      const std::string message = error.what();
      return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
    }
    return "accepted";
  }

  const TemporaryFolder temporary_;
  const std::filesystem::path& folder_ = temporary_.path();
};

TEST_F(StudyFile, OfNothingIsTheDefault) {
  const Study empty = study("");
  EXPECT_EQ(empty.scene.builtin, "gallery");
  EXPECT_TRUE(empty.gazeIsSimulated());
  EXPECT_TRUE(empty.screen.is_default);
  EXPECT_EQ(empty.observer.pupil_mm, 4.0);
  EXPECT_NO_THROW(checkStudy(empty));
}

TEST_F(StudyFile, SetsWhatItNames) {
  const Study read = study(
      "seed = 5\n[scene]\nbuiltin = \"plane\"\nbackground = [0, 0.5, 1]\n"
      "[screen]\ndistance_m = 2\n[gaze]\nunits = \"deg\"\nx = \"x_deg\"\ntime_scale_s = 1e-3\n"
      "[focus]\naccommodation = false\n[output]\nsize_px = [64, 32]\nseconds = [1, 2.5]\n");
  EXPECT_EQ(read.seed, 5);
  EXPECT_EQ(read.scene.builtin, "plane");
  EXPECT_EQ(read.lighting.background, glm::vec3(0, 0.5, 1));
  EXPECT_FALSE(read.screen.is_default);
  EXPECT_EQ(read.screenInForce().distance_m, 2.0);
  EXPECT_EQ(read.gaze.columns.x, "x_deg");
  EXPECT_EQ(read.gaze.columns.time_scale_s, 1e-3);
  EXPECT_FALSE(read.focus.accommodation.on);
  EXPECT_EQ(read.output.size_px, glm::ivec2(64, 32));
  EXPECT_EQ(read.output.seconds, glm::dvec2(1, 2.5));
}

TEST_F(StudyFile, ResolvesPathsFromItsOwnFolder) {
  const Study read = study("[scene]\nfile = \"../a/b.ply\"\n[gaze]\nsource = \"/abs/t.tsv\"\n");
  EXPECT_EQ(*read.scene.file, (folder_ / "../a/b.ply").lexically_normal());
  EXPECT_EQ(read.gaze.source, "/abs/t.tsv");
}

TEST_F(StudyFile, RefusesByLineKeyAndValue) {
  EXPECT_EQ(refusal("[observer]\n\npupil_mm = 40\n"),
            "3: observer.pupil_mm = 40: expected 0.5 to 12");
  EXPECT_EQ(refusal("[observer]\naxis_deg = 200\n"),
            "2: observer.axis_deg = 200: expected 0 to 180");
  EXPECT_EQ(refusal("[observer]\ncorrected = \"no\"\n"),
            "2: observer.corrected = \"no\": expected true or false");
  EXPECT_EQ(refusal("[output]\nfps = [1, 2]\n"), "2: output.fps = [1, 2]: expected 1 to 1000");
  EXPECT_EQ(refusal("[output]\nsize = [1, 2]\n"),
            "2: unknown key output.size: did you mean output.size_px?");
}

TEST_F(StudyFile, RefusesARotationOfLengthZero) {
  EXPECT_NE(refusal("[gaze]\nscene_rotation = [0, 0, 0, 0]\n").find("gaze.scene_rotation"),
            std::string::npos);
  EXPECT_EQ(refusal("[gaze]\nscene_rotation = [0, 0, 0, 0.5]\n"), "accepted");
}

TEST_F(StudyFile, TakesEveryKeyThatTheTableResolves) {
  // What `resolvedKeys` prints of a study reads back as the same study: JSON's values are TOML's.
  const Study before = study("[eye]\nposition_m = [1, 2, 3]\nlook_at_m = [0, 0.1, 0]\n");
  std::string toml;
  for (const ResolvedKey& key : resolvedKeys(before)) {
    const std::string name(key.name);
    if (key.json == "null" || key.json == "[]" || key.json == "\"\"") continue;
    if (name == "screen.monitor") continue;
    toml += name + " = " + key.json + "\n";
  }
  const Study after = study(toml);
  const auto one = resolvedKeys(before), other = resolvedKeys(after);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].json, other[i].json) << one[i].name;
}

TEST_F(StudyFile, HasEveryKeyOnce) {
  std::set<std::string_view> names;
  for (const ResolvedKey& key : resolvedKeys(Study{})) {
    EXPECT_TRUE(names.insert(key.name).second) << key.name;
    EXPECT_FALSE(key.meaning.empty()) << key.name;
  }
}

TEST(OverrideKey, ChecksAsTheFileDoes) {
  Study study;
  overrideKey(study, "observer.pupil_mm", 6.5, "--pupil 6.5");
  EXPECT_EQ(study.observer.pupil_mm, 6.5);
  overrideKey(study, "output.size_px", std::vector<double>{640, 480}, "--size 640x480");
  EXPECT_EQ(study.output.size_px, glm::ivec2(640, 480));
  EXPECT_THROW(overrideKey(study, "observer.pupil_mm", 65.0, "--pupil 65"), InputError);
  EXPECT_THROW(overrideKey(study, "output.size_px", std::vector<double>{640.5, 480}, "--size"),
               InputError);
  EXPECT_THROW(overrideKey(study, "gaze.source", std::string(), "--trace"), InputError);
  EXPECT_EQ(study.observer.pupil_mm, 6.5);
}

TEST(Configs, AreAllValid) {
  int studies = 0;
  for (const auto& entry : std::filesystem::directory_iterator(FOCI_SOURCE_DIR "/configs")) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW(checkStudy(readStudy(entry.path()))) << entry.path();
    ++studies;
  }
  EXPECT_GE(studies, 3);
}

}  // namespace FOCI_FILE
}  // namespace foci
