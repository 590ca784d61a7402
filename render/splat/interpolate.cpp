#include "render/splat/interpolate.h"

#include <algorithm>
#include <array>

namespace foci {
namespace {

constexpr int kWidest = kTile + 2 * kApron;
using Taps = std::array<float, 4>;

Taps catmullRom(float t) {
  return {0.5f * t * (-1.0f + t * (2.0f - t)), 0.5f * (2.0f + t * t * (-5.0f + 3.0f * t)),
          0.5f * t * (1.0f + t * (4.0f - 3.0f * t)), 0.5f * t * t * (t - 1.0f)};
}

/// A pixel's place among the samples: the first of four samples, and their taps.
struct Place {
  int first;
  Taps taps;
};

std::array<Place, kTile * kMaxStep_px> placesOf(const Tile& tile) {
  std::array<Place, kTile * kMaxStep_px> places{};
  for (int i = 0; i < tile.side_px; ++i) {
    const float at =
        (static_cast<float>(i) + 0.5f) / static_cast<float>(tile.step_px) - 0.5f + kApron;
    const int below = static_cast<int>(at);
    places[i] = {below - 1, catmullRom(at - static_cast<float>(below))};
  }
  return places;
}

}  // namespace

void interpolateTile(const Tile& tile, const glm::vec4* rgba, const float* depth_m, Frame& frame) {
  const int width = std::min(tile.side_px, frame.size_px.x - tile.x_px);
  const int height = std::min(tile.side_px, frame.size_px.y - tile.y_px);
  const int samples = tile.samplesWithApron();
  const auto rowOf = [&](int y) {
    return static_cast<std::size_t>(tile.y_px + y) * frame.size_px.x + tile.x_px;
  };
  const auto depthOf = [](float weighted_m, float coverage) {
    return coverage > 0.0f ? std::max(weighted_m / coverage, 0.0f) : 0.0f;
  };
  if (tile.step_px == 1) {
    for (int y = 0; y < height; ++y) {
      std::copy_n(rgba + y * samples, width, frame.rgba.data() + rowOf(y));
      if (!depth_m) continue;
      for (int x = 0; x < width; ++x) {
        frame.depth_m[rowOf(y) + x] = depthOf(depth_m[y * samples + x], rgba[y * samples + x].a);
      }
    }
    return;
  }

  const auto places = placesOf(tile);
  std::array<glm::vec4, kWidest> row;
  std::array<float, kWidest> depth_row;
  for (int y = 0; y < height; ++y) {
    const auto& [first_y, ty] = places[y];
    const glm::vec4* from = rgba + first_y * samples;
    for (int x = 0; x < samples; ++x) {
      row[x] = ty[0] * from[x] + ty[1] * from[samples + x] + ty[2] * from[2 * samples + x] +
               ty[3] * from[3 * samples + x];
    }
    glm::vec4* to = frame.rgba.data() + rowOf(y);
    for (int x = 0; x < width; ++x) {
      const auto& [first, t] = places[x];
      glm::vec4 value =
          t[0] * row[first] + t[1] * row[first + 1] + t[2] * row[first + 2] + t[3] * row[first + 3];
      value.a = std::clamp(value.a, 0.0f, 1.0f);
      to[x] = value;
    }
    if (!depth_m) continue;
    const float* depth_from = depth_m + first_y * samples;
    for (int x = 0; x < samples; ++x) {
      depth_row[x] = ty[0] * depth_from[x] + ty[1] * depth_from[samples + x] +
                     ty[2] * depth_from[2 * samples + x] + ty[3] * depth_from[3 * samples + x];
    }
    for (int x = 0; x < width; ++x) {
      const auto& [first, t] = places[x];
      frame.depth_m[rowOf(y) + x] =
          depthOf(t[0] * depth_row[first] + t[1] * depth_row[first + 1] +
                      t[2] * depth_row[first + 2] + t[3] * depth_row[first + 3],
                  to[x].a);
    }
  }
}

}  // namespace foci
