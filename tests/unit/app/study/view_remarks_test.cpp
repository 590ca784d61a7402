
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "app/study/load_scene.h"
#include "app/study/session_settings_of.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {
namespace FOCI_FILE {

/// A closed sphere, its surfels facing outwards, or inwards.
SurfelCloud sphere(float radius_m, bool outwards = true) {
  SurfelCloud cloud;
  constexpr int kCount = 8000;
  const float area_m2 = 12.566f * radius_m * radius_m / kCount;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kCount, ring = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    const glm::vec3 n(glm::dvec3(ring * std::cos(angle), ring * std::sin(angle), z));
    appendSurfel(cloud, radius_m * n, outwards ? n : -n, 0.6f * std::sqrt(area_m2), area_m2,
                 glm::vec3(0.5f));
  }
  cloud.oriented = true;
  return cloud;
}

Study studyFrom(const glm::dvec3& eye_m, const glm::dvec3& at_m) {
  Study study;
  study.eye.position_m = eye_m;
  study.eye.look_at_m = at_m;
  return study;
}

std::string remarkOn(const Study& study, const SurfelCloud& cloud) {
  const auto remarks = viewRemarks(study, {cloud});
  EXPECT_LE(remarks.size(), 1u);
  return remarks.empty() ? "" : remarks[0];
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(ViewRemarks, AnOrdinaryViewHasNone) {
  EXPECT_EQ(remarkOn(studyFrom({0, 0, 4}, {0, 0, 0}), sphere(1.0f)), "");
  EXPECT_EQ(remarkOn(studyFrom({0, 0, 1.05}, {0, 0, 0}), sphere(1.0f)), "");      // close by
  EXPECT_EQ(remarkOn(studyFrom({0, 0, 0}, {0, 0, 1}), sphere(2.0f, false)), "");  // in a room
}

TEST(ViewRemarks, SurfelsOfAMeshThatAreFarApartNameTheCommand) {
  SurfelCloud cloud = sphere(1.0f);
  cloud.mesh = std::make_shared<const TriangleMesh>();
  // 40 mm apart, at a distance where a pixel is about 1 mm.
  const std::string remark = remarkOn(studyFrom({0, 0, 4}, {0, 0, 0}), cloud);
  EXPECT_TRUE(has(remark, "px apart in view")) << remark;
  EXPECT_TRUE(has(remark, "foci prepare --points ")) << remark;
  EXPECT_EQ(remarkOn(studyFrom({0, 0, 80}, {0, 0, 0}), cloud), "");
}

TEST(ViewRemarks, NothingInViewNamesTheKeyAndThePlace) {
  const std::string remark = remarkOn(studyFrom({0, 0, 4}, {0, 0, 8}), sphere(1.0f));
  EXPECT_TRUE(has(remark, "nothing is in view")) << remark;
  EXPECT_TRUE(has(remark, "eye.look_at_m")) << remark;
  EXPECT_TRUE(has(remark, "4.00 m from the eye")) << remark;
  // The sphere ends just inside, and just outside, of the image: its tangent cone against the
  // frustum of the default screen, 23.9 degrees to the side.
  const auto turned = [](double deg) {
    const double a = glm::radians(deg);
    return studyFrom({0, 0, 0}, {std::sin(a), 0, std::cos(a)});
  };
  SurfelCloud away = sphere(1.0f);
  for (glm::vec3& p : away.position_m) p.z += 4.0f;  // 14.5 degrees to each side
  EXPECT_TRUE(isSceneInView(turned(37.0), {away}));
  EXPECT_FALSE(isSceneInView(turned(41.0), {away}));
}

TEST(ViewRemarks, WhereTheHeadMovesTheEyeTheKeysOfItsPlaceAreNamed) {
  Study study = studyFrom({0, 0, 4}, {0, 0, 8});
  study.eye.recorded = eyePathOf(study);
  const std::string remark = remarkOn(study, sphere(1.0f));
  EXPECT_TRUE(has(remark, "gaze.scene_offset_m") && has(remark, "scene.scale_m")) << remark;
  EXPECT_FALSE(has(remark, "eye.look_at_m")) << remark;
}

TEST(ViewRemarks, AnEyeInsideASolidIsSaid) {
  const std::string inside = remarkOn(studyFrom({0.2, 0, 0}, {0, 0, 1}), sphere(1.0f));
  EXPECT_TRUE(has(inside, "inside a solid") && has(inside, "eye.position_m")) << inside;
  const std::string near = remarkOn(studyFrom({0, 0, 0}, {0, 0, 1}), sphere(0.015f, false));
  EXPECT_TRUE(has(near, "2 cm") && has(near, "scene.scale_m")) << near;
}

TEST(ViewRemarks, ScenesThatAreTooWideOrTooNarrowAreSaid) {
  const std::string wide = remarkOn(studyFrom({0, 0, 4000}, {0, 0, 0}), sphere(800.0f));
  EXPECT_TRUE(has(wide, "1600 m wide") && has(wide, "scene.scale_m")) << wide;
  const std::string narrow = remarkOn(studyFrom({0, 0, 0.1}, {0, 0, 0}), sphere(2e-6f));
  EXPECT_TRUE(has(narrow, "too small") && has(narrow, "set scene.scale_m")) << narrow;
  // foci itself stands this near, and the image begins behind the scene.
  Study tiny = studyFrom({0, 0, 2e-6}, {0, 0, 0});
  tiny.scene.scale_m = 1e6;
  const std::string smallest = remarkOn(tiny, sphere(2e-7f));
  EXPECT_TRUE(has(smallest, "scene.scale_m is at its limit")) << smallest;
}

TEST(MemoryRemark, NamesTheMethodItsMemoryAndTheMethodsThatTakeLess) {
  Study study = studyFrom({0, 0, 4}, {0, 0, 0});
  const SurfelCloud cloud = sphere(1.0f);
  for (const char* within :
       {"auto", "auto:3", "sweep-lod:19", "pinhole", "sweep", "accumulate:64"}) {
    study.render.method = within;
    EXPECT_EQ(memoryRemark(study, {cloud}, cloud.size() - 1), "") << within;
  }
  for (const char* beyond : {"paper", "paper-lod", "inflate", "layered:8"}) {
    study.render.method = beyond;
    EXPECT_EQ(memoryRemark(study, {cloud}, cloud.size()), "") << beyond;
    const std::string remark = memoryRemark(study, {cloud}, cloud.size() - 1);
    EXPECT_TRUE(has(remark, std::string("render.method = \"") + beyond + "\"")) << remark;
    EXPECT_TRUE(has(remark, "GB")) << remark;
    EXPECT_TRUE(has(remark, "\"auto\"")) << remark;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
