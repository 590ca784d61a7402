#include "render/scene/mesh/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "render/image/srgb.h"

namespace foci {
namespace {

using Pixel = cv::Vec<std::uint16_t, 4>;

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

}  // namespace

MeshTexture::MeshTexture(const cv::Mat& image) {
  cv::Mat bgra, eight;
  image.convertTo(eight, CV_8U, image.depth() == CV_16U ? 1.0 / 257.0 : 1.0);
  if (eight.channels() == 1) cv::cvtColor(eight, bgra, cv::COLOR_GRAY2BGRA);
  if (eight.channels() == 3) cv::cvtColor(eight, bgra, cv::COLOR_BGR2BGRA);
  if (eight.channels() == 4) bgra = eight;
  std::array<std::uint16_t, 256> linear{};
  for (std::size_t i = 0; i < linear.size(); ++i) {
    linear[i] = static_cast<std::uint16_t>(
        std::lround(65535.0f * linearFromSrgb(static_cast<float>(i) / 255.0f)));
  }
  cv::Mat level(bgra.size(), CV_16UC4);
  for (int y = 0; y < bgra.rows; ++y) {
    const auto* from = bgra.ptr<cv::Vec4b>(y);
    auto* to = level.ptr<Pixel>(y);
    for (int x = 0; x < bgra.cols; ++x) {
      to[x] = {linear[from[x][2]], linear[from[x][1]], linear[from[x][0]],
               static_cast<std::uint16_t>(257 * from[x][3])};
    }
  }
  const auto keep = [&] {
    Level kept{level.cols, level.rows, {}};
    kept.pixels.reserve(level.total());
    for (int y = 0; y < level.rows; ++y) {
      const auto* from = level.ptr<Pixel>(y);
      for (int x = 0; x < level.cols; ++x) {
        kept.pixels.push_back({from[x][0], from[x][1], from[x][2], from[x][3]});
      }
    }
    levels_.push_back(std::move(kept));
  };
  keep();
  while (level.cols > 1 || level.rows > 1) {
    const cv::Size half((level.cols + 1) / 2, (level.rows + 1) / 2);
    cv::Mat smaller;
    cv::resize(level, smaller, half, 0.0, 0.0, cv::INTER_AREA);
    level = smaller;
    keep();
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
