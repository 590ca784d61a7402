// The parameters of a frame, as shaders/frame.glsl lays them out (std140).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "render/gl/splats.h"

namespace foci {

struct GpuFrameBlock {
  glm::vec4 right{0.0f}, up{0.0f}, back{0.0f};
  glm::vec4 focal_principal_px{0.0f}, view_px{0.0f}, blur_lens{0.0f}, focus{0.0f}, acuity{0.0f};
  glm::vec4 cut{0.0f}, background_low_pass{0.0f}, meridian_oblong{0.0f};
  glm::vec4 sub_aperture_shading{0.0f};
  glm::ivec4 size{0}, cells{0}, scene{0}, room{0}, cut_switches{0};
};
static_assert(sizeof(GpuFrameBlock) == 17 * sizeof(glm::vec4));

/// What the GPU reads and counts: shaders/totals.glsl (std430).
struct GpuTotals {
  std::uint32_t cut_nodes = 0, cut_entries = 0, cut_whole = 0;
  std::uint32_t nearest = 0xFFFFFFFFu, farthest = 0;
  std::uint32_t list_entries = 0, splats = 0;
  std::uint32_t work[3] = {};
  std::uint32_t fragments_low = 0, fragments_high = 0;
  std::uint32_t longest_list = 0, sweep_rounds = 0;
  std::uint32_t unused[2] = {};
  glm::uvec4 project_groups{0, 1, 1, 0};
  glm::uvec4 sweep_groups[3] = {{0, 1, 1, 0}, {0, 1, 1, 0}, {0, 1, 1, 0}};
};
static_assert(sizeof(GpuTotals) == 128);

inline std::uint64_t fragmentsOf(const GpuTotals& totals) {
  return std::uint64_t{totals.fragments_high} << 32 | totals.fragments_low;
}

/// What surfels and Gaussians have in common: the view, the lens without its aperture, and acuity.
GpuFrameBlock viewBlockOf(const View& view, const Defocus& defocus, const Acuity& acuity);

/// Whether the request blurs.
bool blurs(const GpuRequest& request);

/// Whether samples may be more than a pixel apart.
bool mayBeCoarse(const GpuRequest& request);

/// All but `room`.
GpuFrameBlock frameBlockOf(const GpuRequest& request, const GpuScene& scene);

}  // namespace foci
