#include "render/scene/mesh/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/image_codec.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

/// The place inside the texture that is shown at `x`, 0 to 1.
float inside(float x, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return std::clamp(x, 0.0f, 1.0f);
  if (wrap == TextureWrap::mirror) return 1.0f - std::abs(2.0f * glm::fract(0.5f * x) - 1.0f);
  return glm::fract(x);
}

/// The pixel that is shown for one beside the edge, which is one too far at most.
int wrapped(int pixel, int count, TextureWrap wrap) {
  return wrap == TextureWrap::repeat ? (pixel + count) % count : std::clamp(pixel, 0, count - 1);
}

/// The pixels that a pixel of half the size covers, with their shares, which sum to 1.
struct Span {
  int first = 0;
  std::array<float, 3> weight{};
};

/// Of a row of `count` pixels, halved to (count + 1) / 2.
std::vector<Span> spansOf(int count) {
  const int half = (count + 1) / 2;
  const double width = static_cast<double>(count) / half;
  std::vector<Span> spans;
  for (int i = 0; i < half; ++i) {
    const double from = i * width, to = from + width;
    Span span{.first = static_cast<int>(from)};
    for (int k = 0; k < 3; ++k) {
      const int pixel = span.first + k;
      const double covered = std::min(to, pixel + 1.0) - std::max(from, static_cast<double>(pixel));
      if (pixel < count && covered > 1e-9) {
        span.weight[static_cast<std::size_t>(k)] = static_cast<float>(covered / width);
      }
    }
    spans.push_back(span);
  }
  return spans;
}

}  // namespace

MeshTexture::Level MeshTexture::halved(const Level& level) {
  Level half{(level.columns + 1) / 2, (level.rows + 1) / 2, {}};
  const std::vector<Span> across = spansOf(level.columns), down = spansOf(level.rows);
  half.pixels.reserve(across.size() * down.size());
  for (const Span& rows : down) {
    for (const Span& columns : across) {
      glm::vec4 mean(0.5f);  // to round
      for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 3; ++x) {
          const float weight = rows.weight[static_cast<std::size_t>(y)] *
                               columns.weight[static_cast<std::size_t>(x)];
          if (weight == 0.0f) continue;
          const auto& p = level.pixels[static_cast<std::size_t>(rows.first + y) * level.columns +
                                       columns.first + x];
          mean += weight * glm::vec4(p[0], p[1], p[2], p[3]);
        }
      }
      half.pixels.push_back({static_cast<std::uint16_t>(mean.x), static_cast<std::uint16_t>(mean.y),
                             static_cast<std::uint16_t>(mean.z),
                             static_cast<std::uint16_t>(mean.w)});
    }
  }
  return half;
}

MeshTexture::MeshTexture(const DecodedImage& image) {
  std::array<std::uint16_t, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i) {
    linear[i] = static_cast<std::uint16_t>(
        std::lround(65535.0f * linearFromSrgb(static_cast<float>(i) / 255.0f)));
  }
  Level level{image.columns, image.rows, {}};
  level.pixels.reserve(image.total());
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const std::uint8_t* p = &image.rgba[i];
    level.pixels.push_back(
        {linear[p[0]], linear[p[1]], linear[p[2]], static_cast<std::uint16_t>(257 * p[3])});
  }
  levels_.push_back(std::move(level));
  while (levels_.back().columns > 1 || levels_.back().rows > 1) {
    levels_.push_back(halved(levels_.back()));
  }
}

glm::vec2 MeshTexture::size_px() const {
  return {static_cast<float>(levels_[0].columns), static_cast<float>(levels_[0].rows)};
}

glm::vec4 MeshTexture::at(const glm::vec2& uv, float footprint_px,
                          const std::array<TextureWrap, 2>& wrap) const {
  const float level = std::clamp(std::round(std::log2(std::max(footprint_px, 1.0f))), 0.0f,
                                 static_cast<float>(levels_.size() - 1));
  const Level& image = levels_[static_cast<std::size_t>(level)];
  const glm::vec2 place(inside(uv.x, wrap[0]), inside(1.0f - uv.y, wrap[1]));
  const glm::vec2 p =
      place * glm::vec2(static_cast<float>(image.columns), static_cast<float>(image.rows)) - 0.5f;
  const glm::vec2 low = glm::floor(p), share = p - low;
  const auto pixel = [&](int dx, int dy) {
    const int x = wrapped(static_cast<int>(low.x) + dx, image.columns, wrap[0]);
    const int y = wrapped(static_cast<int>(low.y) + dy, image.rows, wrap[1]);
    const auto& raw = image.pixels[static_cast<std::size_t>(y) * image.columns + x];
    return glm::vec4(raw[0], raw[1], raw[2], raw[3]) / 65535.0f;
  };
  return glm::mix(glm::mix(pixel(0, 0), pixel(1, 0), share.x),
                  glm::mix(pixel(0, 1), pixel(1, 1), share.x), share.y);
}

}  // namespace foci
