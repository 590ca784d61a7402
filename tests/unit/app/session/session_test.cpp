#include "app/session/session.h"

#include <gtest/gtest.h>

#include "app/session/observer_eye.h"
#include "app/study/session_settings_of.h"
#include "base/input_error.h"
#include "tests/unit/render/gaussian_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;
constexpr float kFloatRounding = 1e-5f;

glm::vec3 eyePosition(const EyePath& path, double time_s) {
  return glm::vec3(glm::inverse(path.eyeFromWorldAt(time_s))[3]);
}

TEST(EyePath, InterpolatesBetweenKeyframesAndStandsStillOutside) {
  Study study;
  study.eye.path = {{.time_s = 1.0, .position_m = {0, 0, 0}, .look_at_m = {0, 0, -5}, .up = {}},
                    {.time_s = 3.0, .position_m = {2, 0, 0}, .look_at_m = {2, 0, -5}, .up = {}}};
  const EyePath path = eyePathOf(study);
  EXPECT_NEAR(eyePosition(path, 0.0).x, 0.0f, kFloatRounding);
  EXPECT_NEAR(eyePosition(path, 1.5).x, 0.5f, kFloatRounding);
  EXPECT_NEAR(eyePosition(path, 3.0).x, 2.0f, kFloatRounding);
  EXPECT_NEAR(eyePosition(path, 99.0).x, 2.0f, kFloatRounding);
}

TEST(EyePath, RefusesToPassThroughThePointItLooksAt) {
  Study study;
  study.eye.path = {{.time_s = 0.0, .position_m = {0, 0, 0}, .look_at_m = {0, 0, -1}, .up = {}},
                    {.time_s = 2.0, .position_m = {0, 0, -2}, .look_at_m = {0, 0, -1}, .up = {}}};
  EXPECT_THROW(eyePathOf(study).eyeFromWorldAt(1.0), InputError);
}

TEST(OnOtherScreen, KeepsTheAngle) {
  const Screen near{.size_px = {1000, 1000}, .size_m = {0.4, 0.4}, .distance_m = 0.5};
  const Screen far{.size_px = {500, 500}, .size_m = {0.4, 0.4}, .distance_m = 1.0};
  // 0.1 m right of the centre at 0.5 m is 0.2 m at 1 m: 250 of the other's pixels.
  const auto point_px = onOtherScreen_px(near, far, {750.0, 500.0});
  ASSERT_TRUE(point_px.has_value());
  EXPECT_NEAR(point_px->x, 500.0, kRounding);
  EXPECT_NEAR(point_px->y, 250.0, kRounding);
}

TEST(OnOtherScreen, OfTheSameScreenIsTheSamePoint) {
  const Screen screen{.size_px = {1024, 768}, .size_m = {0.38, 0.30}, .distance_m = 0.67};
  const auto point_px = onOtherScreen_px(screen, screen, {12.5, 700.25});
  ASSERT_TRUE(point_px.has_value());
  EXPECT_NEAR(point_px->x, 12.5, kRounding);
  EXPECT_NEAR(point_px->y, 700.25, kRounding);
}

/// A wall across the line of sight, 2 m away.
Scene wall() {
  SurfelCloud cloud;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      appendSurfel(cloud, glm::vec3(0.02f * (glm::vec2(i, j) - 29.5f), -2.0f), {0, 0, 1},
                   0.02f * kSigmaPerSpacing, 4e-4f, glm::vec3(0.5f));
    }
  }
  return {cloud};
}

Study wallStudy() {
  Study study;
  study.eye.position_m = glm::dvec3(0.0);
  study.eye.look_at_m = glm::dvec3(0.0, 0.0, -1.0);
  study.output.size_px = glm::ivec2(64, 36);
  return study;
}

TEST(Session, FindsTheSurfaceUnderAPointAndShowsItThere) {
  const Study study = wallStudy();
  const Scene scene = wall();
  const Screen screen = study.screenInForce();
  const Session session(sessionSettingsOf(study), scene, screen, 100.0, 0.0);
  const glm::dvec2 point_px = glm::dvec2(0.55, 0.45) * glm::dvec2(screen.size_px);
  const auto point_m = session.surfaceUnder_m(0.0, point_px);
  ASSERT_TRUE(point_m);
  const glm::dvec2 on_screen_m = glm::dvec2(0.05, 0.05) * screen.size_m;
  EXPECT_NEAR(point_m->x, on_screen_m.x / screen.distance_m * 2.0, 1e-3);
  EXPECT_NEAR(point_m->y, on_screen_m.y / screen.distance_m * 2.0, 1e-3);
  EXPECT_NEAR(point_m->z, -2.0, 1e-3);
  const glm::vec3 at_m(*point_m);
  const std::vector<glm::vec3> ends_m{
      at_m, at_m, at_m, {0.0f, 0.0f, 1.0f}};  // one is behind the eye
  const auto ends_px = session.linesInImage_px(0.0, ends_m);
  ASSERT_EQ(ends_px.size(), 2u);
  EXPECT_NEAR(ends_px[0].x, 0.55 * 64, 0.01);
  EXPECT_NEAR(ends_px[0].y, 0.45 * 36, 0.01);
  EXPECT_FALSE(session.surfaceUnder_m(0.0, {-2000.0, -2000.0}));
}

TEST(Session, FocusesOnTheSurfaceUnderGaze) {
  const Study study = wallStudy();
  const Scene scene = wall();
  const Screen screen = study.screenInForce();
  Session session(sessionSettingsOf(study), scene, screen, 100.0, 0.0);
  FrameRecord record;
  for (int i = 0; i <= 20; ++i) {
    session.push(
        {.time_s = 0.01 * i, .point_px = 0.5 * glm::dvec2(screen.size_px), .pupil_mm = {}});
    record = session.look(0.01 * i);
  }
  const Frame& frame = session.render("sweep", record);
  constexpr double kCone = 1e-3;  // the wall is flat, the cone half a degree
  EXPECT_EQ(record.eye.state, GazeState::fixation);
  ASSERT_TRUE(record.eye.surface_distance_m.has_value());
  EXPECT_NEAR(*record.eye.surface_distance_m, 2.0, 2.0 * kCone);
  EXPECT_NEAR(record.eye.focus_D, 0.5, kCone);
  EXPECT_EQ(frame.size_px, study.output.size_px);
}

/// Reading a state at each sample, as `foci live` does not, but Python may.
TEST(Session, StatesHoldTheSurfaceOfAFrameWithinAHundredthOfADioptre) {
  const Scene scene = wall();
  Study study = wallStudy();
  study.eye.look_at_m = glm::dvec3(-0.4, 0.0, -2.0);
  const SessionSettings settings = sessionSettingsOf(study);
  Session reader(settings, scene, settings.screen, 1000.0, 0.0);
  Session renderer(settings, scene, settings.screen, 1000.0, 0.0);
  int held = 0;
  double before_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double time_s = 0.001 * i;
    const double jitter_px = i % 3 - 1.0;
    const GazeSample sample{.time_s = time_s,
                            .point_px = glm::dvec2(settings.screen.size_px) * 0.5 +
                                        glm::dvec2(0.05 * i + jitter_px, jitter_px)};
    reader.push(sample);
    renderer.push(sample);
    const FrameRecord state = reader.state(time_s), frame = renderer.look(time_s);
    ASSERT_EQ(state.eye.surface_distance_m.has_value(), frame.eye.surface_distance_m.has_value());
    EXPECT_EQ(state.fixation_px, frame.fixation_px);
    EXPECT_EQ(state.pupil_mm, frame.pupil_mm);
    EXPECT_EQ(state.eye_m, frame.eye_m);
    EXPECT_NEAR(state.eye.focus_D, frame.eye.focus_D, 0.01);
    if (!state.eye.surface_distance_m) continue;
    EXPECT_NEAR(1.0 / *state.eye.surface_distance_m, 1.0 / *frame.eye.surface_distance_m, 0.01);
    if (*state.eye.surface_distance_m == before_m) ++held;
    before_m = *state.eye.surface_distance_m;
  }
  EXPECT_GE(held, 300);

  // The next frame is exact, and a moved eye is noticed.
  EXPECT_EQ(reader.look(0.4).eye.surface_distance_m, renderer.look(0.4).eye.surface_distance_m);
  SessionSettings nearer = settings;
  nearer.path =
      EyePath({{.position_m = {0.0, 0.0, -1.0}, .look_at_m = {-0.4, 0.0, -2.0}, .up = {}}});
  reader.changeSettings(nearer);
  EXPECT_LT(*reader.state(0.401).eye.surface_distance_m, 1.5);
}

TEST(Session, RefusesAMethodThatCannotRenderTheScene) {
  GaussianCloud gaussians;
  addWall(gaussians, 2.0f, 1.2f, 20, 0.9f, glm::vec3(0.5f));
  const Scene scene{std::move(gaussians)};
  Study study = wallStudy();
  const SessionSettings settings = sessionSettingsOf(study);
  Session session(settings, scene, settings.screen, 100.0, 0.0);
  EXPECT_THROW(changeLive(study, session, "render.method", "\"paper\""), InputError);
  EXPECT_EQ(study.render.method, settings.method);
  FrameRecord record = session.look(0.0);
  EXPECT_FALSE(session.render(study.render.method, record).rgba.empty());
  changeLive(study, session, "render.method", "\"sweep\"");
  EXPECT_EQ(study.render.method, "sweep");
}

TEST(Session, LooksSettledAsAfterALongFixation) {
  const Scene scene = wall();
  for (const char* method : {"auto", "sweep"}) {
    Study study = wallStudy();
    study.render.method = method;
    study.observer.pupil = PupilModel::luminance;
    study.focus.accommodation.on = false;  // otherwise focus comes to rest asymptotically
    const SessionSettings settings = sessionSettingsOf(study);
    Session fixating(settings, scene, settings.screen, 100.0, 0.0);
    Session settled(settings, scene, settings.screen, 100.0, 0.0);
    const glm::dvec2 point_px = 0.4 * glm::dvec2(settings.screen.size_px);
    FrameRecord after;
    for (int i = 0; i <= 20; ++i) {
      fixating.push({.time_s = 0.01 * i, .point_px = point_px, .pupil_mm = {}});
      after = fixating.look(0.01 * i);
    }
    FrameRecord at_once = settled.lookSettled(0.2, point_px);
    EXPECT_EQ(at_once.eye.state, after.eye.state);
    EXPECT_NEAR(at_once.eye.focus_D, after.eye.focus_D, kRounding);
    EXPECT_EQ(at_once.pupil_mm, after.pupil_mm);
    EXPECT_EQ(settled.render(method, at_once).rgba, fixating.render(method, after).rgba) << method;
  }
}

TEST(Session, RefusesSettingsAndStaysAsItWas) {
  const Scene scene = wall();
  const SessionSettings good = sessionSettingsOf(wallStudy());
  Session session(good, scene, good.screen, 100.0, 0.0);
  FrameRecord record = session.lookSettled(0.0, {960, 540});
  const Frame before = session.render(good.method, record);
  SessionSettings unknown = good, odd = good;
  unknown.observer.pupil_mm = odd.observer.pupil_mm = 8.0;
  unknown.method = "swep";
  odd.output = {.size_px = {63, 36}, .stereo = StereoView::side_by_side};
  EXPECT_THROW(session.changeSettings(unknown), InputError);
  EXPECT_THROW(session.changeSettings(odd), InputError);
  EXPECT_THROW(Session(odd, scene, odd.screen, 100.0, 0.0), InputError);
  record = session.lookSettled(0.1, {960, 540});
  EXPECT_EQ(record.pupil_mm, good.observer.pupil_mm);
  EXPECT_EQ(session.render(good.method, record).rgba, before.rgba);
}

TEST(Session, SharpHalfIgnoresThePupil) {
  Study study = wallStudy();
  study.output.split = true;
  const Scene scene = wall();
  Frame small, large;
  for (const auto& [pupil_mm, frame] : {std::pair{2.0, &small}, std::pair{8.0, &large}}) {
    study.observer.pupil_mm = pupil_mm;
    Session session(sessionSettingsOf(study), scene, study.screenInForce(), 100.0, 0.0);
    FrameRecord record = session.look(0.0);
    *frame = session.render("sweep", record);
  }
  const auto halves = [](const Frame& frame) {
    std::vector<glm::vec4> left, right;
    for (int y = 0; y < frame.size_px.y; ++y) {
      for (int x = 0; x < frame.size_px.x; ++x) {
        (x < frame.size_px.x / 2 ? left : right).push_back(frame.at(x, y));
      }
    }
    return std::pair(left, right);
  };
  EXPECT_EQ(halves(small).first, halves(large).first);
  EXPECT_NE(halves(small).second, halves(large).second);
}

/// Record and frame of an observer who has looked at the wall, 0.5 D away, for 0.2 s.
std::pair<FrameRecord, Frame> seenBy(const Study& study, const Scene& scene) {
  const Screen screen = study.screenInForce();
  Session session(sessionSettingsOf(study), scene, screen, 100.0, 0.0);
  FrameRecord record;
  for (int i = 0; i <= 20; ++i) {
    session.push(
        {.time_s = 0.01 * i, .point_px = 0.5 * glm::dvec2(screen.size_px), .pupil_mm = {}});
    record = session.look(0.01 * i);
  }
  const Frame& frame = session.render("sweep-lod", record);
  return {record, frame};
}

TEST(ObserverEye, WithGlassesIsAnEmmetropeByteForByte) {
  const Scene scene = wall();
  Study study = wallStudy();
  study.focus.fixed_D = 3.0;  // some blur
  const Frame emmetrope = seenBy(study, scene).second;
  study.observer.sphere_D = -4.0;
  study.observer.cylinder_D = -2.0;
  study.observer.axis_deg = 70.0;
  EXPECT_EQ(seenBy(study, scene).second.rgba, emmetrope.rgba);
  study.observer.corrected = false;
  EXPECT_NE(seenBy(study, scene).second.rgba, emmetrope.rgba);
}

TEST(ObserverEye, ShortSightedSeesNothingSharpBeyondItsFarPoint) {
  const Scene scene = wall();
  Study study = wallStudy();
  study.observer.sphere_D = -2.0;
  study.observer.corrected = false;
  const FrameRecord record = seenBy(study, scene).first;
  EXPECT_NEAR(*record.eye.target_D, 0.5, 1e-3);  // the cone of half a degree
  EXPECT_EQ(record.eye.focus_D, 2.0);
  // The blur is that of an emmetrope who focuses on half a metre.
  Study near_study = wallStudy();
  near_study.focus.fixed_D = 2.0;
  EXPECT_EQ(seenBy(study, scene).second.rgba, seenBy(near_study, scene).second.rgba);
}

TEST(ObserverEye, GlassesComeOffWhileItRuns) {
  Study study = wallStudy();
  const Scene scene = wall();
  const Screen screen = study.screenInForce();
  Session session(sessionSettingsOf(study), scene, screen, 100.0, 0.0);
  for (int i = 0; i <= 20; ++i) {
    session.push(
        {.time_s = 0.01 * i, .point_px = 0.5 * glm::dvec2(screen.size_px), .pupil_mm = {}});
    session.look(0.01 * i);
  }
  changeLive(study, session, "observer.sphere_D", "-2");
  const double worn_D = session.look(0.3).eye.focus_D;
  changeLive(study, session, "observer.corrected", "false");
  EXPECT_EQ(session.look(0.4).eye.focus_D, worn_D + 2.0);
  EXPECT_NEAR(session.look(9.0).eye.focus_D, 2.0, 1e-6);  // relaxed
  EXPECT_THROW(changeLive(study, session, "observer.axis_deg", "181"), InputError);
}

TEST(ObserverEye, APrescriptionOfNextToNothingMovesNoFarPoint) {
  Study study = wallStudy();
  study.observer.corrected = false;
  study.observer.pupil_mm = 3.0;
  study.observer.wavefront.zernike_um = {0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.2};
  study.observer.wavefront_pupil_mm = 6.0;
  for (const double sphere_D : {0.0, -0.01}) {
    study.observer.sphere_D = sphere_D;
    EXPECT_NEAR(sessionSettingsOf(study).observer.refraction.far_point_D, -sphere_D, 1e-6);
  }
}

TEST(ObserverEye, WithoutGlassesHasTheMeasuredWavefrontWithinItsPupil) {
  Study study = wallStudy();
  study.observer.corrected = false;
  study.observer.wavefront.zernike_um = {0, 0, 0, 0.1, 0.5, -0.2, 0, 0, 0, 0, 0, -0.05, 0.2, 0.07};
  study.observer.wavefront_pupil_mm = 6.0;
  const Wavefront measured{.zernike_um = study.observer.wavefront.zernike_um, .pupil_m = 6e-3};
  const auto at_um = [](const Wavefront& w, double x_mm, double y_mm) {
    const double scale = 2e-3 / w.pupil_m;
    double sum = 0.0;
    for (int j = 3; j < static_cast<int>(w.zernike_um.size()); ++j) {
      sum += w.zernike_um[static_cast<std::size_t>(j)] *
             (zernike(zernikeOrder(j), scale * glm::dvec2(x_mm, y_mm)) -
              zernike(zernikeOrder(j), {0, 0}));
    }
    return sum;
  };
  for (const double pupil_mm : {3.0, 6.0}) {
    study.observer.pupil_mm = pupil_mm;
    const ObserverSettings observer = sessionSettingsOf(study).observer;
    const Refraction& eye = observer.refraction;
    const Wavefront rest =
        pupilOfEye(observer, false, pupil_mm, glm::vec2(1000.0f), eye.far_point_D).wavefront;
    const glm::dvec3 refraction_D(eye.far_point_D, eye.astigmatism_D);
    const Wavefront seen = withPower(rest, power_D(rest) + refraction_D);
    for (const double x_mm : {-1.2, 0.0, 0.4}) {
      for (const double y_mm : {-0.7, 0.9}) {
        EXPECT_NEAR(at_um(seen, x_mm, y_mm), at_um(measured, x_mm, y_mm), 1e-6) << pupil_mm;
      }
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
