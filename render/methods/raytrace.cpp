// The other reference: N rays a pixel through points all over the lens, the focus kept (distributed
// ray tracing, Cook, Porter and Carpenter 1984), against the surfels' discs (Embree). It estimates
// what `accumulate:N` does, with the same kernels and layers, but each pixel has lens points of its
// own: it errs by noise where `accumulate` shows ghosts. Known failure: noise, which falls slowly,
// and time. The frame's own split-half error says how far it can be trusted.
//
// Rays are traced through the image, not the world: a point at x px on the pinhole image and v
// dioptres away is seen through the lens point l at x + r l (P - v) (r: radius_px_per_D, P: focus).
// So what a pixel sees through l is a straight line in (x, y, v), for a camera and for the eye,
// whose distances count along the sight; all of a pixel's lines meet at v = P. (Through an
// astigmatic lens, each is moved aside by r J l, J the astigmatism, whatever v.) There a splat's
// footprint, prefilter included, is a flat ellipse at its own v. An oriented disc across v holds
// it, also where the surfel is seen at a grazing angle, which no disc in the surfel's own plane
// could. What a ray hits is weighed as the projection weighs it (project.cpp).
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/parallel.h"
#include "render/image/metrics.h"
#include "render/kernel/kernel.h"
#include "render/kernel/limits.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"

namespace foci {
namespace {

/// A surfel on the pinhole image. With l the lens point in pixels a dioptre: its centre moves by
/// l (P - v), its axes by l times how they change v.
struct SeenSurfel {
  glm::vec2 center_px;
  glm::vec2 u_px, v_px;  // one standard deviation
  float u_D, v_D;        // change of the vergence along them
  float vergence_D;
  float area_per_axes;  // weight over |u x v|
  glm::vec3 color;      // shaded, times opacity
  float opacity;
  bool from_behind;
  float distance_m, near_m, far_m;
};

/// The kernel's weight at an offset from the splat's centre as seen through a lens point.
float weightAt(const SeenSurfel& surfel, const glm::vec2& lens_px_per_D, const glm::vec2& offset) {
  const glm::vec2 u = surfel.u_px + lens_px_per_D * surfel.u_D;
  const glm::vec2 v = surfel.v_px + lens_px_per_D * surfel.v_D;
  static const KernelShape shape = kernelShape(kMaxExponent);
  const float vxx = u.x * u.x + v.x * v.x + 1.0f, vyy = u.y * u.y + v.y * v.y + 1.0f;
  const float area_px = surfel.area_per_axes * std::abs(u.x * v.y - u.y * v.x);
  if (!(area_px > 0.0f && area_px < kLargest_px2 && vxx < kLargest_px2 && vyy < kLargest_px2)) {
    return 0.0f;
  }
  const float vxy = u.x * u.y + v.x * v.y, det = vxx * vyy - vxy * vxy;
  const float q_det =
      vyy * offset.x * offset.x - 2.0f * vxy * offset.x * offset.y + vxx * offset.y * offset.y;
  if (!(q_det < shape.support2 * det)) return 0.0f;
  const float t = 1.0f - q_det / (shape.support2 * det);
  return (shape.k0 + t * (shape.k1 + t * shape.k2)) * area_px / (shape.support2 * std::sqrt(det));
}

struct Hit {
  std::uint32_t surfel;
  float weight;
};

/// A ray with what it gathers on its way, as Embree hands it back to the filter.
struct Gathering {
  RTCIntersectContext context;  // first: Embree knows no more of it
  const std::vector<SeenSurfel>* surfels;
  glm::vec2 lens_px_per_D;
  glm::vec2 pixel;
  float focus_D;
  std::vector<Hit>* hits;
};

/// Notes what a ray meets, and lets it pass on.
void gather(const RTCFilterFunctionNArguments* arguments) {
  arguments->valid[0] = 0;
  const auto& ray = *reinterpret_cast<const Gathering*>(arguments->context);
  const auto index = RTCHitN_primID(arguments->hit, arguments->N, 0);
  const SeenSurfel& surfel = (*ray.surfels)[index];
  const glm::vec2 center = surfel.center_px + ray.lens_px_per_D * (ray.focus_D - surfel.vergence_D);
  const float weight = weightAt(surfel, ray.lens_px_per_D, ray.pixel - center);
  if (weight > 0.0f) ray.hits->push_back({index, weight});
}

/// Seen from the eye, in order of their distances (ties: of the surfels); one that
/// renders nothing is not there.
std::vector<SeenSurfel> look(const SurfelCloud& cloud, const View& view,
                             const RenderSettings& settings) {
  const glm::mat3 rotation(view.eye_from_world);
  std::vector<SeenSurfel> all(cloud.size());
  std::vector<std::uint8_t> kept(cloud.size());
  parallelFor(cloud.size(), [&](std::size_t i) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(cloud.position_m[i], 1.0f));
    const glm::vec3 u = rotation * cloud.axis_u_m[i], v = rotation * cloud.axis_v_m[i];
    const float depth_m = -p.z;
    if (!(depth_m >= view.near_m)) return;
    const glm::vec2 tangent = glm::vec2(p) / depth_m;
    const glm::vec2 px_per_m = view.focal_px * glm::vec2(1.0f, -1.0f) / depth_m;
    const bool along_axis = settings.defocus.along == DistanceAlong::axis;
    const float distance_m = along_axis ? depth_m : glm::length(p);
    const float u_m = along_axis ? -u.z : glm::dot(u, p) / distance_m;
    const float v_m = along_axis ? -v.z : glm::dot(v, p) / distance_m;
    const float vergence_D = 1.0f / distance_m;
    const float uu = glm::dot(u, u), vv = glm::dot(v, v), parallelogram = std::sqrt(uu * vv);
    const float reach_m = std::sqrt(kReach2 * (u_m * u_m + v_m * v_m) + std::max(uu, vv));
    const float away = glm::dot(glm::cross(u, v), p) / (parallelogram * glm::length(p));
    const float opacity = cloud.opacity.empty() ? 1.0f : cloud.opacity[i];
    const float shade = 1.0f + settings.shading * (std::abs(away) - 1.0f);
    all[i] = {.center_px = project(view, p),
              .u_px = px_per_m * (glm::vec2(u) + u.z * tangent),
              .v_px = px_per_m * (glm::vec2(v) + v.z * tangent),
              .u_D = u_m * vergence_D * vergence_D,
              .v_D = v_m * vergence_D * vergence_D,
              .vergence_D = vergence_D,
              .area_per_axes = cloud.area_m2[i] / parallelogram,
              .color = shade * opacity * cloud.color[i],
              .opacity = opacity,
              .from_behind = cloud.oriented && away > kBackFacing,
              .distance_m = distance_m,
              .near_m = std::max(distance_m - reach_m, 0.0f),
              .far_m = distance_m + reach_m};
    // Sums with what is not finite are not finite.
    kept[i] = std::isfinite(all[i].center_px.x + all[i].center_px.y + all[i].far_m +
                            all[i].area_per_axes + all[i].u_D + all[i].v_D);
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (kept[i]) all[count++] = all[i];
  }
  all.resize(count);
  std::stable_sort(all.begin(), all.end(), [](const SeenSurfel& a, const SeenSurfel& b) {
    return a.distance_m < b.distance_m;
  });
  return all;
}

#if defined(__SANITIZE_THREAD__)
constexpr const char* kDevice = "threads=1";  // the sanitizer cannot follow Embree's own
#else
constexpr const char* kDevice = nullptr;
#endif

/// The discs in (x px, y px, v scaled), and the lines through them.
class DiscScene {
 public:
  DiscScene(const std::vector<SeenSurfel>& surfels, const Defocus& defocus)
      : surfels_(surfels), defocus_(defocus) {
    // A dioptre as long as the most that a line moves aside over it.
    const float steepest = std::max(defocus.radius_px_per_D.x, defocus.radius_px_per_D.y);
    px_per_D_ = steepest > 0.0f && std::isfinite(steepest) ? steepest : 1.0f;
    device_ = rtcNewDevice(kDevice);
    if (!device_) throw std::runtime_error("Embree: cannot be started");
    RTCGeometry discs = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    auto* vertices = static_cast<glm::vec4*>(rtcSetNewGeometryBuffer(
        discs, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), surfels.size()));
    auto* normals = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        discs, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), surfels.size()));
    for (std::size_t i = 0; i < surfels.size(); ++i) {
      const glm::vec4 disc = discOf(surfels[i]);
      vertices[i] = disc;
      normals[i] = {0.0f, 0.0f, 1.0f};
      nearest_ = std::min(nearest_, disc.z - 4.0f * disc.w);
      furthest_ = std::max(furthest_, disc.z + 1.0f);
    }
    rtcSetGeometryOccludedFilterFunction(discs, gather);
    rtcCommitGeometry(discs);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene_, discs);
    rtcReleaseGeometry(discs);
    rtcCommitScene(scene_);
    const bool failed = rtcGetDeviceError(device_) != RTC_ERROR_NONE;
    if (failed) {
      release();
      throw std::runtime_error("Embree: cannot build the scene of discs");
    }
  }
  ~DiscScene() { release(); }
  DiscScene(const DiscScene&) = delete;
  DiscScene& operator=(const DiscScene&) = delete;

  /// What the pixel centre sees through a point of the lens (in lens radii), front to back.
  void trace(const glm::vec2& pixel, const glm::vec2& lens, std::vector<Hit>& hits) const {
    hits.clear();
    Gathering line{.context = {},
                   .surfels = &surfels_,
                   .lens_px_per_D = lens * defocus_.radius_px_per_D,
                   .pixel = pixel,
                   .focus_D = defocus_.focus_D,
                   .hits = &hits};
    const glm::vec2 j = defocus_.astigmatism_D;
    line.pixel -= defocus_.radius_px_per_D *
                  glm::vec2(j.x * lens.x + j.y * lens.y, j.y * lens.x - j.x * lens.y);
    rtcInitIntersectContext(&line.context);
    const glm::vec2 slope = line.lens_px_per_D / px_per_D_;
    const glm::vec2 from = line.pixel - line.lens_px_per_D * defocus_.focus_D + slope * nearest_;
    RTCRay ray{};
    ray.org_x = from.x;
    ray.org_y = from.y;
    ray.org_z = nearest_;
    ray.dir_x = slope.x;
    ray.dir_y = slope.y;
    ray.dir_z = 1.0f;
    ray.tfar = furthest_ - nearest_;
    ray.mask = ~0u;
    rtcOccluded1(scene_, &line.context, &ray);
    std::sort(hits.begin(), hits.end(),
              [](const Hit& a, const Hit& b) { return a.surfel < b.surfel; });
  }

 private:
  /// Holds the footprint through every lens point, and what rounding may add.
  glm::vec4 discOf(const SeenSurfel& surfel) const {
    const float lens_px_per_D = std::max(defocus_.radius_px_per_D.x, defocus_.radius_px_per_D.y);
    const float u = glm::length(surfel.u_px) + lens_px_per_D * std::abs(surfel.u_D);
    const float v = glm::length(surfel.v_px) + lens_px_per_D * std::abs(surfel.v_D);
    const float radius = std::sqrt(kWidestSupport2 * (u * u + v * v + 1.0f));
    const float z = surfel.vergence_D * px_per_D_;
    const float rounding =
        1e-5f * (std::abs(surfel.center_px.x) + std::abs(surfel.center_px.y) + z);
    return {surfel.center_px, z, 1.001f * radius + rounding};
  }

  void release() {
    if (scene_) rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  const std::vector<SeenSurfel>& surfels_;
  const Defocus& defocus_;
  float px_per_D_ = 1.0f;
  float nearest_ = 0.0f, furthest_ = 0.0f;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

/// Sums over splats.
struct Sums {
  float weight = 0.0f, opacity = 0.0f, distance = 0.0f;
  glm::vec3 color{0.0f};

  void add(const SeenSurfel& surfel, float w) {
    weight += w;
    opacity += w * surfel.opacity;
    distance += w * surfel.opacity * 0.5f * (surfel.near_m + surfel.far_m);
    color += w * surfel.color;
  }

  void add(const Sums& other, float f) {
    weight += f * other.weight;
    opacity += f * other.opacity;
    distance += f * other.distance;
    color += f * other.color;
  }
};

/// An open layer: what came until the side that is seen was whole, and later.
struct Layer {
  Sums facing, behind, later;

  void add(const SeenSurfel& surfel, float w) {
    Sums& side = surfel.from_behind ? behind : facing;
    const float joins = std::min(w, std::max(kOpaqueWeight - side.weight, 0.0f));
    side.add(surfel, joins);
    if (!surfel.from_behind && w > joins) later.add(surfel, w - joins);
  }
};

/// What one ray sees.
struct Seen {
  glm::vec3 color{0.0f};
  float distance = 0.0f;  // times coverage
  float through = 1.0f;

  void close(Layer layer, bool transparent) {
    if (!transparent) layer.later = {};
    const float covered = coverageOf(layer.facing.weight, kSharpRamp);
    const float left = std::max(coverageOf(layer.behind.weight, kSharpRamp) - covered, 0.0f);
    const float less = (kAnother - layer.later.weight) / (kAnother - kNoise);
    const float same = std::clamp(less, 0.0f, 1.0f);  // of noise and another surface, the first
    layer.facing.add(layer.later, same);
    layer.later.add(layer.later, -same);
    const float facing_scale = covered / std::max(layer.facing.weight, 1e-20f);
    const float behind_scale = left / std::max(layer.behind.weight, 1e-20f);
    compose(layer.facing, facing_scale, layer.behind, behind_scale);
    compose(layer.later, 1.0f / std::max(layer.later.weight, 1.0f), {}, 0.0f);
  }

 private:
  void compose(const Sums& a, float a_scale, const Sums& b, float b_scale) {
    color += through * (a_scale * a.color + b_scale * b.color);
    distance += through * (a_scale * a.distance + b_scale * b.distance);
    through *= 1.0f - std::min(a_scale * a.opacity + b_scale * b.opacity, 1.0f);
  }
};

/// Layers as the sweep makes them (sweep.h), of one ray.
Seen compose(const std::vector<SeenSurfel>& surfels, bool transparent,
             const std::vector<Hit>& hits) {
  Seen seen;
  Layer open;
  float open_far_m = -1.0f;
  for (const Hit& hit : hits) {
    const SeenSurfel& surfel = surfels[hit.surfel];
    if (surfel.near_m > open_far_m || open.later.weight >= 1.0f) {
      seen.close(open, transparent);
      open = {};
      open_far_m = -1.0f;
      if (seen.through < kHidden) return seen;
    }
    open_far_m = std::max(open_far_m, surfel.far_m);
    open.add(surfel, hit.weight);
  }
  seen.close(open, transparent);
  return seen;
}

/// Two numbers, 0 to 1, of a pixel (finaliser of SplitMix64, Steele, Lea and Flood 2014).
glm::vec2 randomOf(std::uint64_t pixel) {
  std::uint64_t h = (pixel + 1) * 0x9e3779b97f4a7c15u;
  h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
  h = (h ^ h >> 27) * 0x94d049bb133111ebu;
  h ^= h >> 31;
  return {static_cast<float>(h >> 40) * 0x1p-24f, static_cast<float>(h & 0xffffffu) * 0x1p-24f};
}

class RaytraceMethod final : public Method {
 public:
  RaytraceMethod(const SurfelCloud& cloud, int rays) : cloud_(cloud), rays_(rays) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const auto width = static_cast<std::size_t>(view.size_px.x);
    const auto height = static_cast<std::size_t>(view.size_px.y);
    for (Frame* one : {&frame, &even_, &odd_}) {
      one->size_px = view.size_px;
      one->rgba.resize(width * height);
    }
    frame.depth_m.assign(settings.depth ? width * height : 0, 0.0f);

    const std::vector<SeenSurfel> surfels = look(cloud_, view, settings);
    const DiscScene scene(surfels, settings.defocus);
    // Through a pinhole all rays of a pixel are one.
    const int rays = settings.defocus.radius_px_per_D == glm::vec2(0.0f) ? 1 : rays_;
    std::vector<std::uint64_t> fragments(height);
    parallelFor(height, [&](std::size_t y) {
      std::vector<Hit> hits;
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t p = y * width + x;
        const glm::vec2 random = randomOf(p);
        glm::vec4 halves[2] = {glm::vec4(0.0f), glm::vec4(0.0f)};
        float distance = 0.0f;
        for (int i = 0; i < rays; ++i) {
          scene.trace({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f},
                      lensSampleOfPixel(i, rays, random.x, random.y), hits);
          fragments[y] += hits.size();
          const Seen seen = compose(surfels, !cloud_.opacity.empty(), hits);
          halves[i % 2] +=
              glm::vec4(seen.color + seen.through * settings.background, 1.0f - seen.through);
          distance += seen.distance;
        }
        const glm::vec4 sum = halves[0] + halves[1];
        frame.rgba[p] = sum / static_cast<float>(rays);
        if (settings.depth && sum.a > 0.0f) frame.depth_m[p] = distance / sum.a;
        even_.rgba[p] = halves[0] / static_cast<float>((rays + 1) / 2);
        odd_.rgba[p] = halves[1] / static_cast<float>(std::max(1, rays / 2));
      }
    });
    RenderStats stats;
    stats.splats = surfels.size();
    for (const std::uint64_t row : fragments) stats.fragments += row;
    if (rays > 1) {
      stats.split_half_psnr_dB = psnr_dB(even_, odd_);
    } else if (rays_ > 1) {
      stats.split_half_psnr_dB = std::numeric_limits<double>::infinity();
    }
    return stats;
  }

 private:
  const SurfelCloud& cloud_;
  int rays_;
  Frame even_, odd_;
};

}  // namespace

MethodEntry raytraceMethod() {
  return {.info = {.name = "raytrace",
                   .summary = "N rays a pixel through the lens, against discs: the other reference",
                   .source = "Cook, Porter and Carpenter 1984",
                   .most = 100000,
                   .standard = 64},
          .make = makeAs<RaytraceMethod>};
}

}  // namespace foci
