#include "render/scene/mesh/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/image_codec.h"
#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "render/image/srgb.h"

namespace foci {
namespace {

constexpr float kInvisible = 0.5f / 255.0f;  // below half a step of 8 bits

/// The corners of a triangle, the least one first, in their winding.
std::array<glm::vec3, 3> turnedCorners(const TriangleMesh& mesh, std::uint32_t triangle) {
  const glm::vec3* const from = &mesh.corners_m[3 * std::size_t{triangle}];
  std::array<glm::vec3, 3> corners{from[0], from[1], from[2]};
  std::rotate(corners.begin(), std::ranges::min_element(corners, precedes), corners.end());
  return corners;
}

/// See `colorAt`.
float lightOn(const glm::vec3* corners_m) {
  const glm::dvec3 a(corners_m[0]), b(corners_m[1]), c(corners_m[2]);
  static const glm::dvec3 kTowardsLight = glm::normalize(glm::dvec3(1.0, 2.0, 1.5));
  const double cosine = glm::dot(glm::normalize(glm::cross(b - a, c - a)), kTowardsLight);
  return static_cast<float>(1.0 - kPlainShading * (0.5 - 0.5 * cosine));
}

/// @param alpha  product of the alphas of texture, mask and corners
float opacityOf(const MeshMaterial& material, float alpha) {
  switch (material.alpha) {
    case AlphaUse::cut:
      return alpha < material.cutoff ? 0.0f : material.opacity;
    case AlphaUse::blend: {
      const float opacity = alpha * material.opacity;
      return opacity < kInvisible ? 0.0f : opacity;
    }
    case AlphaUse::none:
      break;
  }
  return material.opacity;
}

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

bool precedes(const glm::vec3& a, const glm::vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

std::size_t dropUseless(TriangleMesh& mesh) {
  struct Key {
    std::array<glm::vec3, 3> corners;
    std::uint32_t material, triangle;
  };
  const auto order = [](const Key& a, const Key& b) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (a.corners[i] != b.corners[i]) return precedes(a.corners[i], b.corners[i]);
    }
    return std::tie(a.material, a.triangle) < std::tie(b.material, b.triangle);
  };
  std::vector<Key> keys(mesh.size());
  parallelFor(keys.size(), [&](std::size_t i) {
    const auto triangle = static_cast<std::uint32_t>(i);
    keys[i] = {turnedCorners(mesh, triangle), mesh.material[i], triangle};
  });
  parallelSort(keys.begin(), keys.end(), order);
  std::vector<std::uint8_t> useful(mesh.size());
  std::size_t repeats = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto& [a, b, c] = keys[i].corners;
    const glm::dvec3 first(a);
    const bool flat = glm::cross(glm::dvec3(b) - first, glm::dvec3(c) - first) == glm::dvec3(0.0);
    const bool repeat =
        i > 0 && keys[i].material == keys[i - 1].material && keys[i].corners == keys[i - 1].corners;
    useful[keys[i].triangle] = !flat && !repeat;
    repeats += repeat && !flat;
  }
  keepMarked(mesh.corners_m, useful, 3);
  keepMarked(mesh.uv, useful, 3);
  keepMarked(mesh.color, useful, 3);
  keepMarked(mesh.alpha, useful, 3);
  keepMarked(mesh.objects.of.own(), useful);
  keepMarked(mesh.material, useful);
  return repeats;
}

MeshColor colorAt(const TriangleMesh& mesh, const MeshPoint& point, float footprint_m) {
  static const MeshMaterial plain;
  const std::uint32_t m = mesh.material[point.triangle];
  const MeshMaterial& material = m < mesh.materials.size() ? mesh.materials[m] : plain;
  const std::size_t first = 3 * std::size_t{point.triangle};
  const auto blend = [&](const auto& values) {
    return values[first] + point.weights.x * (values[first + 1] - values[first]) +
           point.weights.y * (values[first + 2] - values[first]);
  };
  const bool has_color = !mesh.color.empty() && mesh.color[first].x >= 0.0f;
  const glm::vec3 tint = has_color && material.tinted ? blend(mesh.color) : glm::vec3(1.0f);
  float alpha = mesh.alpha.empty() ? 1.0f : blend(mesh.alpha);
  const auto texelOf = [&](const MeshTexture& texture) {
    const glm::vec2 a = (mesh.uv[first + 1] - mesh.uv[first]) * texture.size_px();
    const glm::vec2 b = (mesh.uv[first + 2] - mesh.uv[first]) * texture.size_px();
    const float area_px = std::abs(a.x * b.y - a.y * b.x);
    const float area_m2 =
        glm::length(glm::cross(mesh.corners_m[first + 1] - mesh.corners_m[first],
                               mesh.corners_m[first + 2] - mesh.corners_m[first]));
    return texture.at(blend(mesh.uv), footprint_m * std::sqrt(area_px / area_m2), material.wrap);
  };
  if (material.mask) alpha *= texelOf(*material.mask).w;
  if (material.texture) {
    const glm::vec4 texel = texelOf(*material.texture);
    return {glm::vec3(texel) * material.factor * tint, opacityOf(material, alpha * texel.w)};
  }
  const float opacity = opacityOf(material, alpha);
  if (has_color && !material.tinted) return {blend(mesh.color), opacity};
  const bool shaded = material.shaded && !has_color;
  return {material.factor * tint * (shaded ? lightOn(&mesh.corners_m[first]) : 1.0f), opacity};
}

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
