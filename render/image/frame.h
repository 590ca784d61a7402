// A rendered frame in linear light.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace foci {

/// Row-major, top row first. `rgba` holds linear RGB, already multiplied by coverage and already
/// over the background, and the coverage (0 to 1) itself.
struct Frame {
  glm::ivec2 size_px{0, 0};
  std::vector<glm::vec4> rgba;
  std::vector<float> depth_m;  ///< distance of what is seen, coverage-weighted; 0 where nothing is;
                               ///< empty unless asked for

  /// @param depth  with room for it; otherwise it has none
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

/// What a frame cost.
struct RenderStats {
  std::uint64_t splats = 0;     ///< rendered, after culling
  std::uint64_t fragments = 0;  ///< kernel evaluations inside a footprint
  double ms = 0.0;              ///< wall time
  /// Of a reference: the PSNR between two halves of its samples. The ceiling of any PSNR against
  /// it.
  std::optional<double> split_half_psnr_dB;
  /// Of `auto`: the error that it expects at most in 95 % of the pixels, in just noticeable
  /// differences.
  std::optional<double> tolerance_error;
  /// False of `auto` whose budget of time did not allow what its tolerance wants.
  bool in_full = true;
  /// Of `auto` under a budget of time: the method that renders the same on any machine.
  std::string rendered_as;
};

}  // namespace foci
