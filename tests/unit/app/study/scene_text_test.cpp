
#include <gtest/gtest.h>

#include "app/study/framing.h"

namespace foci {
namespace FOCI_FILE {

TEST(SceneText, CountsWhatIsLeftOut) {
  const SceneFacts facts{.points = 1, .dropped = 2, .position = {glm::vec3(0.0f)}};
  const std::string text = sceneText(facts, Framing{});
  EXPECT_NE(text.find("contents  1 point, 2 left out (not finite"), std::string::npos) << text;
}

TEST(SceneText, APreparedSceneHasNormals) {
  SceneFacts facts{.kind = SceneKind::prepared, .surfels = 1, .position = {glm::vec3(0.0f)}};
  const std::string text = sceneText(facts, Framing{});
  EXPECT_NE(text.find("normals   yes"), std::string::npos) << text;
  facts.kind = SceneKind::ply_points;
  EXPECT_NE(sceneText(facts, Framing{}).find("normals   no: foci estimates"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
