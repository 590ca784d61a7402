#include "render/methods/post_filter.h"

#include <limits>
#include <numbers>

#include "base/parallel.h"

namespace foci {
namespace {

/// Sums of weights are tabulated up to this radius. From there on they equal the integral of the
/// weight within 0.1 %.
constexpr float kTabulated_px = 24.0f;
constexpr int kSteps = 32;  // a pixel; chosen by hand

/// Within this distance of an outline, depth is a mean of both sides: the footprint of the smallest
/// splat.
constexpr int kOutline_px = 3;
/// If the blur differs by less than this within that distance, the pixels are one surface. Chosen
/// by hand: a pixel of blur is hardly visible.
constexpr float kOneSurface_px = 1.0f;

/// The sum of the weights of a disc. The radii are half a pixel larger than those of the circle of
/// confusion.
float sumOfWeights(const glm::vec2& outer_px) {
  const float slope = std::min(outer_px.x, outer_px.y);
  const glm::ivec2 reach(outer_px);
  double sum = 0.0;
  for (int y = -reach.y; y <= reach.y; ++y) {
    for (int x = -reach.x; x <= reach.x; ++x) {
      const float n = glm::length(glm::vec2(x, y) / outer_px);
      sum += std::clamp((1.0f - n) * slope, 0.0f, 1.0f);
    }
  }
  return static_cast<float>(sum);
}

}  // namespace

std::vector<float> vergences_D(const Frame& image, const Defocus& defocus) {
  const glm::ivec2 size = image.size_px;
  const auto vergence = [](float depth_m) { return depth_m > 0.0f ? 1.0f / depth_m : 0.0f; };
  const float px_per_D = std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);

  // Find the nearest and the farthest distance around each pixel, along rows and then along
  // columns. Empty pixels have no distance.
  struct Ends {
    float nearest = std::numeric_limits<float>::max(), farthest = 0.0f;
    void add(const Ends& other) {
      nearest = std::min(nearest, other.nearest);
      farthest = std::max(farthest, other.farthest);
    }
  };
  std::vector<Ends> along_rows(image.depth_m.size());
  parallelFor(static_cast<std::size_t>(size.y), [&](std::size_t row) {
    const float* depth_m = image.depth_m.data() + row * size.x;
    for (int x = 0; x < size.x; ++x) {
      Ends& ends = along_rows[row * size.x + x];
      for (int i = std::max(0, x - kOutline_px); i <= std::min(size.x - 1, x + kOutline_px); ++i) {
        if (depth_m[i] > 0.0f) ends.add({depth_m[i], depth_m[i]});
      }
    }
  });
  std::vector<float> point_D(image.depth_m.size());
  parallelFor(static_cast<std::size_t>(size.y), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < size.x; ++x) {
      const std::size_t p = row * size.x + x;
      const float depth_m = image.depth_m[p];
      point_D[p] = vergence(depth_m);
      if (depth_m <= 0.0f) continue;
      Ends ends;
      for (int i = std::max(0, y - kOutline_px); i <= std::min(size.y - 1, y + kOutline_px); ++i) {
        ends.add(along_rows[static_cast<std::size_t>(i) * size.x + x]);
      }
      if ((1.0f / ends.nearest - 1.0f / ends.farthest) * px_per_D <= kOneSurface_px) continue;
      const bool nearer = depth_m - ends.nearest < ends.farthest - depth_m;
      point_D[p] = 1.0f / (nearer ? ends.nearest : ends.farthest);
    }
  });
  return point_D;
}

int mirrored(int i, int n) {
  const int twice = 2 * n;
  const int wrapped = ((i % twice) + twice) % twice;
  return wrapped < n ? wrapped : twice - 1 - wrapped;
}

void DiscImage::set(const glm::ivec2& size_px, const std::vector<glm::vec4>& rgba,
                    const std::vector<float>& point_D, const Defocus& defocus) {
  size_px_ = size_px;
  // Keep it finite: in focus, 0 times infinity would be NaN.
  radius_px_per_D_ = glm::min(defocus.radius_px_per_D, glm::vec2(1e6f));
  const float widest = std::max(radius_px_per_D_.x, radius_px_per_D_.y);
  const float max_D = widest > 0.0f ? kMaxRadius_px / widest : 0.0f;

  float reach_D = 0.0f;
  for (float point : point_D) reach_D = std::max(reach_D, std::abs(roundDefocus_D(defocus, point)));
  const float reach_px = std::min(reach_D, max_D) * widest + 0.5f;
  border_px_ = (static_cast<int>(reach_px) + kTile_px - 1) / kTile_px * kTile_px;

  border_tiles_ = tiles() + 2 * (border_px_ / kTile_px);
  stride_ = static_cast<std::size_t>(border_tiles_.x) * kTile_px;
  const std::size_t rows = static_cast<std::size_t>(border_tiles_.y) * kTile_px;
  rgba_.resize(stride_ * rows);
  defocus_D_.resize(stride_ * rows);
  tile_max_D_.resize(static_cast<std::size_t>(border_tiles_.x) * border_tiles_.y);
  parallelFor(static_cast<std::size_t>(border_tiles_.y), [&](std::size_t ty) {
    float* tile_max = tile_max_D_.data() + ty * border_tiles_.x;
    std::fill_n(tile_max, border_tiles_.x, 0.0f);
    for (std::size_t row = ty * kTile_px; row < (ty + 1) * kTile_px; ++row) {
      const int y = mirrored(static_cast<int>(row) - border_px_, size_px.y);
      for (std::size_t column = 0; column < stride_; ++column) {
        const int x = mirrored(static_cast<int>(column) - border_px_, size_px.x);
        const std::size_t from = static_cast<std::size_t>(y) * size_px.x + x;
        const float blur_D = std::clamp(roundDefocus_D(defocus, point_D[from]), -max_D, max_D);
        rgba_[row * stride_ + column] = rgba[from];
        defocus_D_[row * stride_ + column] = blur_D;
        float& tile = tile_max[column / kTile_px];
        tile = std::max(tile, std::abs(blur_D));
      }
    }
  });

  if (sums_for_ != radius_px_per_D_ && widest > 0.0f) {
    sums_for_ = radius_px_per_D_;
    sums_.resize(static_cast<std::size_t>(kTabulated_px) * kSteps + 2);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const float radius_px = static_cast<float>(i) / kSteps;
      sums_[i] = sumOfWeights(radius_px_per_D_ * (radius_px / widest) + 0.5f);
    }
  }
}

float DiscImage::weightSum(float defocus_D) const {
  const glm::vec2 radius = radius_px(defocus_D);
  const float widest_px = std::max(radius.x, radius.y);
  if (widest_px == 0.0f) return 0.5f;  // the pixel itself
  if (widest_px < kTabulated_px) {
    const float step = widest_px * kSteps;
    const auto i = static_cast<std::size_t>(step);
    return glm::mix(sums_[i], sums_[i + 1], step - static_cast<float>(i));
  }
  const glm::vec2 outer_px = radius + 0.5f;
  const float slope = std::min(outer_px.x, outer_px.y);
  const float flat = std::max(0.0f, 1.0f - 1.0f / slope);
  return std::numbers::pi_v<float> / 3.0f * outer_px.x * outer_px.y * slope *
         (1.0f - flat * flat * flat);
}

void DiscImage::spreadOnto(int tile, std::vector<glm::vec4>& out) const {
  const glm::ivec2 begin = tileAt(tile) * kTile_px;
  const glm::ivec2 end = glm::min(begin + kTile_px, size_px_);
  glm::vec4 sums[kTile_px * kTile_px] = {};
  forEachDiscOn(tile, [&](int x, int y, int row, int first, int last, const float* weights) {
    const glm::vec4& light = rgba(x, y);
    glm::vec4* sum = sums + (row - begin.y) * kTile_px + (first - begin.x);
    for (int i = 0; i <= last - first; ++i) sum[i] += weights[i] * light;
  });
  for (int y = begin.y; y < end.y; ++y) {
    std::copy_n(sums + (y - begin.y) * kTile_px, end.x - begin.x,
                out.data() + static_cast<std::size_t>(y) * size_px_.x + begin.x);
  }
}

}  // namespace foci
