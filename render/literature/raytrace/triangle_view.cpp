#include "render/literature/raytrace/triangle_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "base/parallel.h"
#include "render/kernel/kernel.h"
#include "render/literature/raytrace/embree_scene.h"

namespace foci {
namespace {

// Rays along a side of a pixel: where nothing changes, where colours do, and at outlines. Two leave
// an edge that runs along the pixels up to 1/4 px off its place; four leave 1/8 px.
constexpr int kRays = 1, kColorRays = 2, kEdgeRays = 4;
constexpr float kSameColor = 0.02f;    // linear; chosen by eye
constexpr float kFootprint_px = 0.5f;  // of textures; a whole pixel would soften them twice
constexpr float kOpaque = 0.9999f;

/// The mean of a pixel's rays.
struct TracedPixel {
  glm::vec4 rgba{0.0f};  ///< colour times coverage, and coverage
  float hit = 0.0f;      ///< share of the rays that meet a surface
};

class Tracer {
 public:
  Tracer(const MeshRays& mesh, const View& view)
      : mesh_(mesh),
        view_(view),
        world_from_eye_(glm::inverse(view.eye_from_world)),
        traced_(static_cast<std::size_t>(view.size_px.x) * view.size_px.y) {}

  std::vector<TracedPixel> trace() {
    forEachPixel([&](int x, int y) { traced_[at(x, y)] = pixel(x, y, kRays); });
    std::vector<int> across(traced_.size());
    forEachPixel([&](int x, int y) { across[at(x, y)] = raysFor(x, y); });
    forEachPixel([&](int x, int y) {
      if (across[at(x, y)] != kRays) traced_[at(x, y)] = pixel(x, y, across[at(x, y)]);
    });
    return std::move(traced_);
  }

 private:
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * view_.size_px.x + x; }

  template <class Body>
  void forEachPixel(const Body& body) const {
    parallelFor(static_cast<std::size_t>(view_.size_px.y), [&](std::size_t y) {
      for (int x = 0; x < view_.size_px.x; ++x) body(x, static_cast<int>(y));
    });
  }

  TracedPixel pixel(int x, int y, int across) const {
    const glm::vec3 eye_m(world_from_eye_[3]);
    const glm::mat3 rotation(world_from_eye_);
    const float side = 1.0f / static_cast<float>(across), share = side * side;
    TracedPixel mean;
    for (int i = 0; i < across * across; ++i) {
      const glm::dvec2 point_px(x + (i % across + 0.5) * side, y + (i / across + 0.5) * side);
      const glm::vec3 sight = rotation * glm::vec3(directionThrough(view_, point_px));
      const RaySeen seen = mesh_.trace(eye_m, sight, kFootprint_px / view_.focal_px.x);
      mean.rgba += share * glm::vec4(seen.color, seen.coverage);
      mean.hit += seen.hit ? share : 0.0f;
    }
    return mean;
  }

  /// Rays along a side of the pixel, by what its neighbours see.
  int raysFor(int x, int y) const {
    const TracedPixel& middle = traced_[at(x, y)];
    int across = kRays;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, view_.size_px.y - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, view_.size_px.x - 1); ++u) {
        const TracedPixel& other = traced_[at(u, v)];
        if (other.hit != middle.hit) return kEdgeRays;
        const glm::vec4 apart = glm::abs(other.rgba - middle.rgba);
        if (std::max({apart.r, apart.g, apart.b, apart.a}) > kSameColor) across = kColorRays;
      }
    }
    return across;
  }

  const MeshRays& mesh_;
  const View& view_;
  glm::mat4 world_from_eye_;
  std::vector<TracedPixel> traced_;
};

/// 1 where the mask is 1 somewhere within `kFilterReach_px`, along rows and columns.
std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& mask,
                                  const glm::ivec2& size_px) {
  std::vector<std::uint8_t> from = mask, to(mask.size());
  const glm::ivec2 step(1, size_px.x);  // along rows, along columns
  for (int axis = 0; axis < 2; ++axis) {
    parallelFor(static_cast<std::size_t>(size_px.y), [&](std::size_t y) {
      for (int x = 0; x < size_px.x; ++x) {
        const int at = axis == 0 ? x : static_cast<int>(y);
        const std::size_t p = y * size_px.x + x;
        std::uint8_t any = 0;
        for (int k = std::max(-kFilterReach_px, -at);
             k <= std::min(kFilterReach_px, size_px[axis] - 1 - at); ++k) {
          any |= from[p + std::ptrdiff_t{k} * step[axis]];
        }
        to[p] = any;
      }
    });
    std::swap(from, to);
  }
  return from;
}

float filterWeight(int dx, int dy) {
  const float rest = 1.0f - static_cast<float>(dx * dx + dy * dy) / kWidestSupport2;
  return rest > 0.0f ? rest * rest : 0.0f;
}

/// @param where  other pixels stay black
Frame filtered(const std::vector<TracedPixel>& traced, const glm::ivec2& size_px,
               const std::vector<std::uint8_t>& where) {
  struct Tap {
    int dx, dy;
    float weight;
  };
  std::vector<Tap> taps;
  float total = 0.0f;
  for (int dy = -kFilterReach_px; dy <= kFilterReach_px; ++dy) {
    for (int dx = -kFilterReach_px; dx <= kFilterReach_px; ++dx) {
      const float weight = filterWeight(dx, dy);
      if (weight > 0.0f) taps.push_back({dx, dy, weight});
      total += weight;
    }
  }
  Frame frame;
  frame.size_px = size_px;
  frame.rgba.assign(traced.size(), glm::vec4(0.0f));
  parallelFor(static_cast<std::size_t>(size_px.y), [&](std::size_t row) {
    for (int x = 0; x < size_px.x; ++x) {
      const std::size_t p = row * size_px.x + x;
      if (where[p] == 0) continue;
      for (const Tap& tap : taps) {
        const int u = x + tap.dx, v = static_cast<int>(row) + tap.dy;
        if (u < 0 || v < 0 || u >= size_px.x || v >= size_px.y) continue;
        frame.rgba[p] +=
            tap.weight / total * traced[static_cast<std::size_t>(v) * size_px.x + u].rgba;
      }
    }
  });
  return frame;
}

constexpr int kMaxLayers = 1000;  // along a ray through transparent ones
constexpr float kBeyond = 1e-6f;  // relative step past a transparent surface; some float steps

}  // namespace

TriangleView triangleView(const MeshRays& mesh, const View& view) {
  const std::vector<TracedPixel> traced = Tracer(mesh, view).trace();
  std::vector<std::uint8_t> hit(traced.size()), miss(traced.size()), clear(traced.size());
  for (std::size_t p = 0; p < traced.size(); ++p) {
    hit[p] = traced[p].hit > 0.0f;
    miss[p] = traced[p].hit < kOpaque;
    clear[p] = traced[p].rgba.a < kOpaque;
  }
  const auto some = dilated(hit, view.size_px), none = dilated(miss, view.size_px);
  const auto not_opaque = dilated(clear, view.size_px);
  TriangleView seen{.frame = filtered(traced, view.size_px, some), .interior = {}, .outline = {}};
  seen.interior.resize(traced.size());
  seen.outline.resize(traced.size());
  const glm::ivec2 last_px = view.size_px - 1 - kFilterReach_px;
  for (std::size_t p = 0; p < traced.size(); ++p) {
    const int x = static_cast<int>(p) % view.size_px.x, y = static_cast<int>(p) / view.size_px.x;
    const bool whole =  // the filter's support lies on the image
        std::min(x, y) >= kFilterReach_px && x <= last_px.x && y <= last_px.y;
    seen.interior[p] = whole && not_opaque[p] == 0;
    seen.outline[p] = whole && some[p] != 0 && none[p] != 0;
    if (whole && none[p] == 0 && clear[p] != 0) ++seen.transparent;
  }
  return seen;
}

double outlineLength_px(const Frame& frame, const std::vector<std::uint8_t>& where) {
  const glm::ivec2 size_px = frame.size_px;
  double length_px = 0.0;
  for (int y = 1; y + 1 < size_px.y; ++y) {
    for (int x = 1; x + 1 < size_px.x; ++x) {
      if (where[static_cast<std::size_t>(y) * size_px.x + x] == 0) continue;
      const double along_x = 0.5 * (frame.at(x + 1, y).a - frame.at(x - 1, y).a);
      const double along_y = 0.5 * (frame.at(x, y + 1).a - frame.at(x, y - 1).a);
      length_px += std::hypot(along_x, along_y);
    }
  }
  return length_px;
}

MeshRays::MeshRays(const TriangleMesh& mesh)
    : mesh_(mesh), scene_(std::make_unique<EmbreeScene>()) {
  RTCGeometry triangles = rtcNewGeometry(scene_->device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners_m = static_cast<glm::vec3*>(
      rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              sizeof(glm::vec3), mesh.corners_m.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.size()));
  if (!corners_m || !indices) {
    rtcReleaseGeometry(triangles);
    throw std::runtime_error("Embree: not enough memory for the triangles");
  }
  std::ranges::copy(mesh.corners_m, corners_m);
  std::iota(indices, indices + mesh.corners_m.size(), 0u);
  scene_->build(triangles);
}

MeshRays::~MeshRays() = default;

RaySeen MeshRays::trace(const glm::vec3& eye_m, const glm::vec3& sight, float footprint) const {
  RaySeen seen;
  float transmittance = 1.0f, from_m = 0.0f;
  for (int surface = 0; surface < kMaxLayers; ++surface) {
    EmbreeContext context;
    const RTCRayHit ray =
        scene_->trace(context, eye_m, sight, from_m, std::numeric_limits<float>::infinity());
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
    const MeshPoint place{ray.hit.primID, glm::vec2(ray.hit.u, ray.hit.v)};
    const MeshColor color = colorAt(mesh_, place, footprint * ray.ray.tfar);
    seen.hit = seen.hit || color.opacity > 0.0f;
    seen.color += transmittance * color.opacity * color.color;
    transmittance *= 1.0f - color.opacity;
    if (transmittance < kHidden) {
      transmittance = 0.0f;
      break;
    }
    from_m = ray.ray.tfar * (1.0f + kBeyond);
  }
  seen.coverage = 1.0f - transmittance;
  return seen;
}

}  // namespace foci
