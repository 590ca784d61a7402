#include "app/study/key_table.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "app/study/study.h"

namespace foci {
namespace FOCI_FILE {

std::vector<std::string> allKeys() {
  std::vector<std::string> known;
  for (const ResolvedKey& key : resolvedKeys(Study{})) known.emplace_back(key.name);
  return known;
}

TEST(KeySuggestion, IsNearInSpellingOrMeaningOrAbsent) {
  const std::pair<const char*, const char*> cases[] = {
      // Spelling.
      {"sead", "seed"},
      {"observer.pupil_m", "observer.pupil_mm"},
      {"observer.pupli_mm", "observer.pupil_mm"},
      {"obsever.pupil_mm", "observer.pupil_mm"},
      {"focus.latncy_s", "focus.latency_s"},
      {"eye.postion_m", "eye.position_m"},
      {"output.fsp", "output.fps"},
      {"render.metod", "render.method"},
      // Another unit, or none.
      {"screen.distance_cm", "screen.distance_m"},
      {"screen.size_mm", "screen.size_m"},
      {"observer.ipd", "observer.ipd_mm"},
      {"focus.age", "focus.age_years"},
      {"scene.scale", "scene.scale_m"},
      // Another section.
      {"observer.age", "observer.age_years"},
      {"pupil_mm", "observer.pupil_mm"},
      {"render.tolerance", "quality.tolerance"},
      {"scene.look_at", "eye.look_at_m"},
      // Another word.
      {"observer.pupil_diameter_mm", "observer.pupil_mm"},
      {"observer.aperture", "observer.pupil_mm"},
      {"gaze.file", "gaze.source"},
      {"gaze.trace", "gaze.source"},
      {"scene.path", "scene.file"},
      {"screen.resolution", "screen.size_px"},
      {"output.framerate", "output.fps"},
      {"focus.distance_m", "focus.fixed_D"},
      {"eye.target", "eye.look_at_m"},
      {"camera.position", "eye.position_m"},
      {"render.algorithm", "render.method"},
      // Nothing like it.
      {"observer.x", ""},
      {"observer.name", ""},
      {"output.codec", ""},
      {"camera.iso", ""},
      {"render.samples", ""},
      {"scene.lights", ""},
      {"banana", ""},
      {"gaze.participant", ""}};
  for (const auto& [unknown, expected] : cases) {
    EXPECT_EQ(suggestedKey(unknown, allKeys()).value_or(""), expected) << unknown;
  }
}

TEST(KeySuggestion, SectionsComeOnceAndInOrder) {
  const auto sections = sectionsOf(allKeys());
  ASSERT_GE(sections.size(), 9u);
  EXPECT_EQ(sections[0], "scene");
  EXPECT_EQ(std::count(sections.begin(), sections.end(), "gaze"), 1);
}

}  // namespace FOCI_FILE
}  // namespace foci
