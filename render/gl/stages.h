// The stages of a frame on the GPU, and their times.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace foci {

/// In their order. `present` interpolates the samples to pixels; reading the frame back is not in
/// it.
enum class GpuStage : std::uint8_t { cut, project, bin, sort, composite, present };
inline constexpr std::array<std::string_view, 6> kGpuStages{"cut",  "project",   "bin",
                                                            "sort", "composite", "present"};

/// The device's times of a frame, ms, by `GpuStage`.
struct GpuTimes {
  std::array<double, kGpuStages.size()> stage_ms{};

  void operator+=(const GpuTimes& other) {
    for (std::size_t s = 0; s < stage_ms.size(); ++s) stage_ms.at(s) += other.stage_ms.at(s);
  }
};

}  // namespace foci
