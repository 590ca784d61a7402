#include "render/splat/interpolate.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace foci {
namespace {

using Taps = std::array<float, 4>;

/// The channels of a pixel: one vector of the processor.
using Channels [[gnu::vector_size(4 * sizeof(float))]] = float;

Channels channelsOf(const glm::vec4& value) {
  Channels channels;
  std::memcpy(&channels, &value, sizeof channels);
  return channels;
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
  std::array<Channels, kMostSamples> row;
  std::array<float, kMostSamples> depth_row{};
  const auto mix = [](const Taps& taps, const auto& sample) {
    return taps[0] * sample(0) + taps[1] * sample(1) + taps[2] * sample(2) + taps[3] * sample(3);
  };
  for (int y = 0; y < height; ++y) {
    const Place& down = places[y];
    for (int x = 0; x < samples; ++x) {
      const int first = down.first * samples + x;
      row[x] = mix(down.taps, [&](int k) { return channelsOf(rgba[first + k * samples]); });
      if (!depth_m) continue;
      depth_row[x] = mix(down.taps, [&](int k) { return depth_m[first + k * samples]; });
    }
    for (int x = 0; x < width; ++x) {
      const Place& across = places[x];
      const Channels value = mix(across.taps, [&](int k) { return row[across.first + k]; });
      float far_m = 0.0f;
      if (depth_m) far_m = mix(across.taps, [&](int k) { return depth_row[across.first + k]; });
      put(rowOf(y) + x, {value[0], value[1], value[2], std::clamp(value[3], 0.0f, 1.0f)}, far_m);
    }
  }
}

}  // namespace foci
