// Properties of every scene, checked on random scenes (RapidCheck).
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <random>

#include "render/image/metrics.h"
#include "tests/unit/render/method_scenes.h"
#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

// A fixed seed, and few cases: each case renders frames.
[[maybe_unused]] const int kFew = setenv("RC_PARAMS", "max_success=12 seed=1", 0);

constexpr double kRounding_dB = 70.0;  // float sums in another order, 16-bit normals of the tree
constexpr int kSize_px = 48;

struct Drawing {
  SurfelCloud cloud;
  View view = squareView(kSize_px, 60.0f);
  RenderSettings settings;
};

int between(int low, int high) { return *rc::gen::inRange(low, high + 1); }

Drawing anyDrawing() {
  return {.cloud = scattered(between(1, 120), static_cast<unsigned>(between(0, 1 << 20)),
                             between(0, 1) == 1),
          .settings = lens(0.1f * static_cast<float>(between(0, 80)),
                           0.01f * static_cast<float>(between(0, 250)))};
}

const char* anyMethod() {
  return *rc::gen::element<const char*>("sweep", "sweep-lod", "paper", "paper-lod", "accumulate:9");
}

template <class T>
void permute(MappedVector<T>& values, const std::vector<std::size_t>& order) {
  if (values.empty()) return;
  std::vector<T> permuted;
  for (const std::size_t i : order) permuted.push_back(values[i]);
  values = std::move(permuted);
}

RC_GTEST_PROP(AnyScene, IsDrawnTheSameInAnyOrderOfItsSurfels, ()) {
  const Drawing a = anyDrawing();
  SurfelCloud shuffled = a.cloud;
  std::vector<std::size_t> order(a.cloud.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  for (auto* array :
       {&shuffled.position_m, &shuffled.axis_u_m, &shuffled.axis_v_m, &shuffled.color})
    permute(*array, order);
  permute(shuffled.opacity, order);
  permute(shuffled.area_m2, order);
  const char* method = anyMethod();
  RC_ASSERT(psnr_dB(render(method, a.cloud, a.view, a.settings),
                    render(method, shuffled, a.view, a.settings)) > kRounding_dB);
}

RC_GTEST_PROP(AnyScene, IsDrawnToTheSameBytesByAnyNumberOfThreads, ()) {
  const Drawing a = anyDrawing();
  const char* method = anyMethod();
  const Frame many = render(method, a.cloud, a.view, a.settings);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  RC_ASSERT(render(method, a.cloud, a.view, a.settings).rgba == many.rgba);
}

RC_GTEST_PROP(AnyScene, IsDrawnTheSameWhereverItAndTheEyeAreMoved, ()) {
  const Drawing a = anyDrawing();
  Drawing b = a;
  const glm::vec3 axis = glm::normalize(glm::vec3(between(-9, 9), between(-9, 9), 0.5f));
  const glm::mat4 moved =
      glm::translate(glm::mat4(1.0f), glm::vec3(between(-3, 3), 1.0f, -2.0f)) *
      glm::rotate(glm::mat4(1.0f), 0.1f * static_cast<float>(between(0, 60)), axis);
  for (glm::vec3& p : b.cloud.position_m) p = glm::vec3(moved * glm::vec4(p, 1.0f));
  for (auto* axes : {&b.cloud.axis_u_m, &b.cloud.axis_v_m}) {
    for (glm::vec3& v : *axes) v = glm::mat3(moved) * v;
  }
  b.view.eye_from_world = glm::inverse(moved);
  const char* method = *rc::gen::element<const char*>("sweep", "accumulate:9");
  constexpr double kFloats_dB = 55.0;  // positions a few metres from the origin, in floats
  RC_ASSERT(psnr_dB(render(method, a.cloud, a.view, a.settings),
                    render(method, b.cloud, b.view, b.settings)) > kFloats_dB);
}

// A change by a ten-thousandth of a dioptre, of a pixel a dioptre or of a millimetre is invisible.
RC_GTEST_PROP(AnyScene, ChangesLittleWithAnyParameter, ()) {
  const Drawing a = anyDrawing();
  Drawing b = a;
  constexpr float kLittle = 1e-4f;
  switch (between(0, 2)) {
    case 0:
      b.settings.defocus.focus_D += kLittle;
      break;
    case 1:
      b.settings.defocus.radius_px_per_D += glm::vec2(kLittle);
      break;
    default:
      b.view.eye_from_world[3].x += 0.001f * kLittle;
  }
  const char* method = anyMethod();
  RC_ASSERT(psnr_dB(render(method, a.cloud, a.view, a.settings),
                    render(method, b.cloud, b.view, b.settings)) > 50.0);
}

RC_GTEST_PROP(APointOfLight, IsBlurredMoreByALargerPupilAndByMoreDefocus, ()) {
  const float pupil = 0.5f + 0.1f * static_cast<float>(between(0, 100));
  const float focus_D = 1.0f + 0.02f * static_cast<float>(between(1, 100));  // the point is at 1 D
  const bool pupil_grows = between(0, 1) == 1;
  const char* method = *rc::gen::element<const char*>("sweep", "sweep-lod", "paper");
  const SurfelCloud cloud = pointOfLight(glm::vec2(0.0f));
  const auto variance_px2 = [&](float more) {
    const auto settings =
        pupil_grows ? lens(pupil * more, focus_D) : lens(pupil, 1.0f + (focus_D - 1.0f) * more);
    const Moments m = momentsOf(render(method, cloud, squareView(129, kPointFocal_px), settings));
    return m.variance_x_px2 + m.variance_y_px2;
  };
  RC_ASSERT(variance_px2(1.1f) > variance_px2(1.0f));
}

}  // namespace FOCI_FILE
}  // namespace foci
