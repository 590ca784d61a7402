// A rendered frame in linear light.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace foci {

/// Row-major, top row first. `rgba` holds linear RGB, composited over the background, and the
/// coverage, 0 to 1.
struct Frame {
  glm::ivec2 size_px{0, 0};
  std::vector<glm::vec4> rgba;
  /// Distance of the visible surfaces, coverage-weighted; 0 where there is none. Empty unless asked
  /// for.
  std::vector<float> depth_m;

  /// @param depth  whether the frame has depth
  void resize(const glm::ivec2& to_px, bool depth = false) {
    const std::size_t pixels = static_cast<std::size_t>(to_px.x) * to_px.y;
    size_px = to_px;
    rgba.resize(pixels);
    depth_m.resize(depth ? pixels : 0);
  }

  const glm::vec4& at(int x, int y) const {
    return rgba[static_cast<std::size_t>(y) * size_px.x + x];
  }
};

/// The cost of a frame, and how it was rendered.
struct RenderStats {
  std::uint64_t splats = 0;     ///< rendered, after culling
  std::uint64_t fragments = 0;  ///< kernel evaluations inside a footprint
  double ms = 0.0;              ///< wall time
  /// For a reference, the PSNR between two halves of its samples: no method can show a higher PSNR
  /// against it.
  std::optional<double> split_half_psnr_dB;
  /// For `auto`, the predicted error that 95 % of the pixels stay below, in just-noticeable
  /// differences (JND).
  std::optional<double> tolerance_error;
  /// False if the frame-time budget kept `auto` from the full quality that its tolerance asks for.
  bool in_full = true;
  /// For `auto` with a frame-time budget, the method that renders the same frame on any machine.
  std::string rendered_as;
};

}  // namespace foci
