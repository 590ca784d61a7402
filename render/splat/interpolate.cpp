#include "render/splat/interpolate.h"

#include <algorithm>
#include <array>

namespace foci {
namespace {

using Taps = std::array<float, 4>;

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

void interpolateTile(const Tile& tile, const glm::vec4* rgba, const float* depth_m, float weight,
                     Frame& frame) {
  const int width = std::min(tile.side_px, frame.size_px.x - tile.x_px);
  const int height = std::min(tile.side_px, frame.size_px.y - tile.y_px);
  const int samples = tile.samplesWithApron();
  // Takes a pixel, and its depth times coverage.
  const auto put = [&](std::size_t pixel, glm::vec4 value, float weighted_m) {
    glm::vec4& to = frame.rgba[pixel];
    if (depth_m) {
      float& far_m = frame.depth_m[pixel];
      if (weight < 1.0f) weighted_m = glm::mix(far_m * to.a, weighted_m, weight);
      const float coverage = weight < 1.0f ? glm::mix(to.a, value.a, weight) : value.a;
      far_m = coverage > 0.0f ? std::max(weighted_m / coverage, 0.0f) : 0.0f;
    }
    to = weight < 1.0f ? glm::mix(to, value, weight) : value;
  };
  const auto rowOf = [&](int y) {
    return static_cast<std::size_t>(tile.y_px + y) * frame.size_px.x + tile.x_px;
  };
  if (tile.step_px == 1) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int from = y * samples + x;
        put(rowOf(y) + x, rgba[from], depth_m ? depth_m[from] : 0.0f);
      }
    }
    return;
  }

  const auto places = placesOf(tile);
  std::array<glm::vec4, kMostSamples> row;
  std::array<float, kMostSamples> depth_row{};
  for (int y = 0; y < height; ++y) {
    const auto& [first_y, ty] = places[y];
    const auto down = [&, &first_y = first_y, &ty = ty](const auto* from, int x) {
      from += first_y * samples + x;
      return ty[0] * from[0] + ty[1] * from[samples] + ty[2] * from[2 * samples] +
             ty[3] * from[3 * samples];
    };
    for (int x = 0; x < samples; ++x) {
      row[x] = down(rgba, x);
      if (depth_m) depth_row[x] = down(depth_m, x);
    }
    for (int x = 0; x < width; ++x) {
      const auto& [first, t] = places[x];
      const auto across = [&, &first = first, &t = t](const auto& from) {
        return t[0] * from[first] + t[1] * from[first + 1] + t[2] * from[first + 2] +
               t[3] * from[first + 3];
      };
      glm::vec4 value = across(row);
      value.a = std::clamp(value.a, 0.0f, 1.0f);
      put(rowOf(y) + x, value, depth_m ? across(depth_row) : 0.0f);
    }
  }
}

}  // namespace foci
