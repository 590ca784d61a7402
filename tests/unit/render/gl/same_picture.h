// Whether the GPU renders the same picture as the CPU: at most 2/255 apart in 99.9 % of the pixels,
// and at least 50 dB, the goals of docs/gpu.md.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "render/image/metrics.h"
#include "render/image/srgb.h"
#include "render/methods/method.h"
#include "render/optics/lens_field.h"

namespace foci {

inline constexpr double kMinPsnr_dB = 50.0, kShare = 0.999;
inline constexpr float kStep = 2.0f / 255.0f;

/// Share of the pixels whose display values are at most kStep apart.
inline double shareAlike(const Frame& a, const Frame& b) {
  std::size_t alike = 0;
  for (std::size_t p = 0; p < a.rgba.size(); ++p) {
    bool close = true;
    for (int channel = 0; channel < 3; ++channel) {
      close &= std::abs(srgbFromLinear(a.rgba[p][channel]) - srgbFromLinear(b.rgba[p][channel])) <=
               kStep;
    }
    alike += close;
  }
  return static_cast<double>(alike) / static_cast<double>(a.rgba.size());
}

/// A left eye with the typical field, whose line of sight is 32 degrees beside the middle of a
/// view of 64 px with the focal length of 64 px. The pupil is wide, so that the blur spans pixels.
inline RenderSettings besideTheGaze(const View& view, float focus_D) {
  RenderSettings settings;
  settings.defocus = defocusOfLens(60e-3, view.focal_px, focus_D, DistanceAlong::sight);
  settings.defocus.astigmatism_D = {0.3f, -0.2f};
  settings.defocus.field = std::make_shared<const LensField>(
      typicalField(), true, view, view.principal_px + glm::vec2(-40, 10), settings.defocus);
  settings.pupil.diameter_m = 60e-3;
  return settings;
}

struct SamePicture {
  RenderStats cpu, gpu;
};

inline SamePicture expectSamePicture(const std::string& method, const auto& cloud, const View& view,
                                     const RenderSettings& settings, const SharedGpu& gpu) {
  Frame by_cpu, by_gpu;
  const RenderStats cpu = makeMethod(method, cloud)->render(view, settings, by_cpu);
  const RenderStats gpu_stats = makeMethod(method, cloud, gpu)->render(view, settings, by_gpu);
  EXPECT_GE(psnr_dB(by_cpu, by_gpu), kMinPsnr_dB) << method;
  EXPECT_GE(shareAlike(by_cpu, by_gpu), kShare) << method;
  EXPECT_EQ(cpu.quality_level, gpu_stats.quality_level) << method;
  EXPECT_GT(gpu_stats.fragments, 0u) << method;
  EXPECT_FALSE(cpu.gpu) << method;
  EXPECT_TRUE(gpu_stats.gpu) << method;
  EXPECT_GT(
      gpu_stats.gpu.value_or(GpuTimes{}).stage_ms.at(static_cast<std::size_t>(GpuStage::composite)),
      0.0);
  EXPECT_EQ(by_gpu.depth_m.size(), by_cpu.depth_m.size());
  std::size_t apart = 0;
  for (std::size_t p = 0; p < std::min(by_cpu.depth_m.size(), by_gpu.depth_m.size()); ++p) {
    apart += std::abs(by_cpu.depth_m[p] - by_gpu.depth_m[p]) > 0.01f * by_cpu.depth_m[p] + 1e-4f;
  }
  EXPECT_LE(static_cast<double>(apart),
            (1.0 - kShare) * static_cast<double>(by_cpu.depth_m.size()) + 1.0)
      << method;
  return {cpu, gpu_stats};
}

}  // namespace foci
