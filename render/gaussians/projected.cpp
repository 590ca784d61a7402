#include "render/gaussians/projected.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "render/optics/lens_field.h"
#include "render/scene/gaussian_merge.h"
#include "render/scene/harmonics.h"

namespace foci {
namespace {

class Projection {
 public:
  Projection(const View& view, const Defocus& defocus, const std::vector<SubApertureSize>& sizes)
      : view_(view), defocus_(defocus), sizes_(sizes) {
    const glm::mat3 turn(view.eye_from_world);
    world_x_ = glm::transpose(turn)[0];
    world_y_ = glm::transpose(turn)[1];
    world_z_ = glm::transpose(turn)[2];
    eye_m_ = glm::vec3(glm::inverse(view.eye_from_world)[3]);
    const glm::vec2 size(view.size_px);
    for (const SubApertureSize& each : sizes) {
      blurs_ = blurs_ || each.max_radius > 0.0f || each.aperture > 0.0f;
    }
    low_ = -(view.principal_px + (kFieldMargin - 1.0f) * 0.5f * size) / view.focal_px;
    high_ = (size - view.principal_px + (kFieldMargin - 1.0f) * 0.5f * size) / view.focal_px;
  }

  /// @param cloud  the scene's, or its tree's nodes
  /// @param growth_per_m2  of a node (gaussian_tree.h); null: a Gaussian of the scene
  /// @return false if the Gaussian does not reach the image
  bool project(const GaussianCloud& cloud, std::size_t i, const float* growth_per_m2,
               ProjectedGaussian& out, SplatKey& key) const {
    const glm::vec3& p_world = cloud.position_m[i];
    const glm::vec3 p(view_.eye_from_world * glm::vec4(p_world, 1.0f));
    const float depth = -p.z;
    if (!(depth >= view_.near_m)) return false;

    // Image axes: x right, y down. Rows of J times the rotation to the eye, in world axes.
    const float inverse = 1.0f / depth;
    const glm::vec2 tangent = glm::vec2(p.x, -p.y) * inverse;
    const glm::vec2 at = glm::clamp(tangent, low_, high_);
    const glm::vec3 row_x = view_.focal_px.x * inverse * (world_x_ + at.x * world_z_);
    const glm::vec3 row_y = view_.focal_px.y * inverse * (at.y * world_z_ - world_y_);
    const glm::mat3 s = matrixOf(cloud.covariance_m2[i]);
    const glm::vec3 sx = s * row_x, sy = s * row_y;
    const float xx = glm::dot(row_x, sx), xy = glm::dot(row_x, sy), yy = glm::dot(row_y, sy);
    out.x_px = view_.principal_px.x + view_.focal_px.x * tangent.x;
    out.y_px = view_.principal_px.y + view_.focal_px.y * tangent.y;
    out.vxx = xx + kLowPass_px2;
    out.vxy = xy;
    out.vyy = yy + kLowPass_px2;
    out.opacity = cloud.opacity[i];
    if (cloud.preserves_light || growth_per_m2) {
      const float shrinkage =
          std::sqrt(std::max(xx * yy - xy * xy, 0.0f) / (out.vxx * out.vyy - xy * xy));
      const float pixel_m2 = depth * depth / (view_.focal_px.x * view_.focal_px.y);
      out.opacity =
          cloud.preserves_light
              ? out.opacity * shrinkage
              : opacityAfterLowPass(out.opacity, 1.0f + *growth_per_m2 * kLowPass_px2 * pixel_m2,
                                    shrinkage);
    }
    if (!(out.opacity > kMinAlpha)) return false;
    out.cut = 2.0f * std::log(peakOf(out.opacity) / kMinAlpha);

    // The vergence, its gradient in world axes, and the blur.
    const float length = glm::length(p);
    const bool by_sight = defocus_.along == DistanceAlong::sight;
    out.distance_m = by_sight ? length : depth;
    const glm::vec3 gradient =
        by_sight ? (eye_m_ - p_world) / (length * length * length) : world_z_ * inverse * inverse;
    out.sx = glm::dot(sx, gradient);
    out.sy = glm::dot(sy, gradient);
    out.e = std::max(glm::dot(gradient, s * gradient), 0.0f);
    out.off_D = defocus_.focus_D - 1.0f / out.distance_m;
    if (!place(out, depth, key)) return false;

    const glm::vec3 color = colorOf(cloud, i, (p_world - eye_m_) / length);
    out.red = color.r;
    out.green = color.g;
    out.blue = color.b;
    return true;
  }

 private:
  /// Fills the key. The box bounds the Gaussian from every lens point: with the deviations of
  /// position and vergence, the sheared variance is at most (sqrt(V) + sqrt(e) |a|)^2.
  bool place(const ProjectedGaussian& g, float depth, SplatKey& key) const {
    glm::vec2 radius = defocus_.radius_px_per_D;
    glm::vec2 blur = blurRadius_px(defocus_, 1.0f / g.distance_m);
    float least_px = std::min(blur.x, blur.y);
    if (const LensField* field = shownField(defocus_)) {
      const glm::vec2 offset_px = glm::vec2(g.x_px, g.y_px) - view_.principal_px;
      const float point_D = 1.0f / g.distance_m;
      const auto [least, most] = field->blurBounds_px(offset_px, 0.0f, defocus_, point_D, 0.0f);
      const LocalLens lens = field->at(offset_px);
      const glm::mat2 per_D = lens.imagePerAngle() * lens.pupil();
      radius = {std::hypot(per_D[0][0], per_D[1][0]), std::hypot(per_D[0][1], per_D[1][1])};
      blur = glm::vec2(most);
      least_px = least;
    }
    const glm::vec2 sharp = glm::sqrt(glm::vec2(g.vxx, g.vyy));
    const float vergence = std::sqrt(g.e);
    glm::vec2 half(0.0f);
    for (const SubApertureSize& each : sizes_) {
      const glm::vec2 sheared = sharp + vergence * each.max_radius * radius;
      const glm::vec2 disc = kDiscVariancePerRadius2 * each.aperture * each.aperture *
                             (blur * blur + g.e * radius * radius);
      half = glm::max(half, each.max_radius * blur + glm::sqrt(g.cut * (sheared * sheared + disc)));
    }
    const glm::vec2 low = glm::vec2(g.x_px, g.y_px) - half, high = low + 2.0f * half;
    const glm::vec2 size(view_.size_px);
    // Also false for values that are not finite.
    if (!(high.x >= 0.0f && high.y >= 0.0f && low.x < size.x && low.y < size.y)) return false;
    const auto pixel = [](float px, float below) {
      return static_cast<std::uint16_t>(std::clamp(px, 0.0f, below - 1.0f));
    };
    key = {.distance_m = depth,
           .sigma_px = blurs_ ? kSigmaPerBlur * least_px : 0.0f,
           .blur_px = std::max(blur.x, blur.y),
           .x0 = pixel(low.x, size.x),
           .x1 = pixel(high.x, size.x),
           .y0 = pixel(low.y, size.y),
           .y1 = pixel(high.y, size.y)};
    return true;
  }

  const View& view_;
  const Defocus& defocus_;
  const std::vector<SubApertureSize>& sizes_;
  glm::vec3 world_x_{0.0f}, world_y_{0.0f}, world_z_{0.0f}, eye_m_{0.0f};  // the eye's axes
  bool blurs_ = false;                // not through a pinhole alone
  glm::vec2 low_{0.0f}, high_{0.0f};  // tangents
};

}  // namespace

void projectGaussians(const GaussianCloud& cloud, const GaussianCut* cut, const View& view,
                      const Defocus& defocus, const std::vector<SubApertureSize>& sizes,
                      ProjectedGaussians& out) {
  SplatChunks& chunks = out.chunks;
  const std::size_t total = cut ? cut->size() : cloud.size();
  const std::size_t size = chunkSize(total);
  const std::size_t count = (total + size - 1) / size;
  chunks.chunk_size = size;
  chunks.count.assign(count, 0);
  if (chunks.capacity < count * size) {
    chunks.capacity = count * size;
    chunks.keys = makeLargeArray<SplatKey>(chunks.capacity);
    out.gaussians.resize(chunks.capacity);
  }
  const Projection projection(view, defocus, sizes);
  parallelFor(count, [&](std::size_t c) {
    std::uint32_t kept = 0;
    const auto add = [&](const GaussianCloud& from, std::size_t i,
                         const float* growth_per_m2 = nullptr) {
      const std::size_t slot = c * size + kept;
      if (projection.project(from, i, growth_per_m2, out.gaussians[slot], chunks.keys[slot]))
        ++kept;
    };
    for (std::size_t i = c * size; i < std::min((c + 1) * size, total); ++i) {
      if (!cut) {
        add(cloud, i);
      } else if (i < cut->nodes.size()) {
        const std::uint32_t node = cut->nodes[i];
        add(cloud.tree->nodes, node, &cloud.tree->growth_per_m2[node]);
      } else {
        add(cloud, cut->gaussians[i - cut->nodes.size()]);
      }
    }
    chunks.count[c] = kept;
  });
}

}  // namespace foci
