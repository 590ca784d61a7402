#include "tests/faces/face.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "tests/faces/eye.h"

namespace foci::faces {
namespace {

constexpr double kHeadReach_mm = 150.0;
constexpr int kSamplesOfEyes = 4, kSamplesOfFace = 2;  // along each axis
constexpr double kLens_mm = -27.0;                     // plane of the glasses, head frame
const glm::dvec2 kLensCentre_mm{33.5, 3.0}, kLensHalf_mm{25.0, 19.0};
constexpr double kRim_mm = 2.2, kLensCurve_mm = 120.0;

double roundedBox(const glm::dvec2& p, const glm::dvec2& half, double corner) {
  const glm::dvec2 q = glm::abs(p) - half + corner;
  return glm::length(glm::max(q, glm::dvec2(0.0))) + std::min(std::max(q.x, q.y), 0.0) - corner;
}

/// Shelves and boxes behind the observer, out of focus.
glm::vec3 background(double u, double v, std::uint32_t seed) {
  const auto cell = [&](double size, std::uint32_t which) {
    return noiseAt(static_cast<std::uint32_t>(u / size + 100.0),
                   static_cast<std::uint32_t>(v / (1.7 * size) + 100.0), seed * 8 + which);
  };
  const float wall = 0.22f + 0.1f * smoothNoise(static_cast<float>(u * 3.0 + 40.0),
                                                static_cast<float>(v * 3.0 + 40.0), seed);
  glm::vec3 colour(wall, wall * 0.95f, wall * 0.88f);
  if (cell(0.13, 0) > 0.55f) {
    colour = glm::vec3(cell(0.13, 1), cell(0.13, 2), cell(0.13, 3)) * 0.3f;
    colour *= 0.7f + 0.5f * cell(0.035, 4);
  }
  return colour;
}

}  // namespace

struct Scene {
  const Person& person;
  const Relief& relief;
  const Moment& moment;
  const Photography& how;
  glm::dmat3 camera_from_head;
  std::array<Eye, 2> eyes;
  glm::vec3 towards_light;  // head frame
  Photography alone{};      // of `beside`
  std::unique_ptr<Scene> beside{};

  Scene(const Person& p, const Relief& r, const Moment& m, const Photography& h)
      : person(p),
        relief(r),
        moment(m),
        how(h),
        camera_from_head(cameraFromHead(m)),
        eyes{Eye(p, m, 1), Eye(p, m, -1)} {
    const glm::dvec3 light(std::sin(h.light_yaw_rad), -0.55, -std::cos(h.light_yaw_rad));
    towards_light = glm::vec3(glm::transpose(camera_from_head) * glm::normalize(light));
    if (!how.beside) return;
    alone = how;
    alone.beside = nullptr;
    beside =
        std::make_unique<Scene>(how.beside->person_, how.beside->relief_, how.beside_at, alone);
  }

  glm::dvec2 project(const glm::dvec3& p_head_mm) const {
    const glm::dvec3 p = moment.head_m + camera_from_head * p_head_mm / 1000.0;
    return how.focal_px * glm::dvec2(p) / p.z + 0.5 * glm::dvec2(how.size_px);
  }

  glm::vec3 skinAt(const glm::dvec3& p, const glm::dvec3& origin, const glm::dvec3& d) const {
    const auto ambient = static_cast<float>(how.ambient);
    const Eye& eye = eyes[p.x > 0.0 ? 0 : 1];
    if (eye.isOpenAt(p.x, p.y)) {
      const glm::vec3 seen = eye.seenAlong(origin, d, towards_light, ambient);
      return glm::mix(seen, person.hair * 0.4f, eye.lashesOver(p.x, p.y));
    }
    const glm::vec3 skin = relief.colourAt(p.x, p.y, towards_light, ambient);
    return glm::mix(skin, person.hair * 0.4f, std::min(0.9f, eye.lashesAt(p.x, p.y)));
  }

  /// Colour seen through the glasses, or on them.
  glm::vec3 throughGlasses(const glm::dvec3& origin, const glm::dvec3& d, glm::vec3 behind) const {
    const glm::dvec3 p = origin + d * ((kLens_mm - origin.z) / d.z);
    const glm::dvec2 lens = glm::dvec2(std::abs(p.x), p.y) - kLensCentre_mm;
    const double rim = roundedBox(lens, kLensHalf_mm, 11.0);
    const bool bridge =
        std::abs(p.x) < kLensCentre_mm.x - kLensHalf_mm.x && std::abs(p.y + 4.0) < 1.8;
    if (bridge || (rim > 0.0 && rim < kRim_mm)) return glm::vec3(0.02f, 0.018f, 0.02f);
    if (rim > 0.0) return behind;
    const double side = p.x > 0.0 ? 1.0 : -1.0;
    const glm::dvec3 normal =
        glm::normalize(glm::dvec3(side * lens.x / kLensCurve_mm, lens.y / kLensCurve_mm, -1.0));
    return behind * (1.0f - person.mirrored) +
           person.mirrored * roomLight(camera_from_head * glm::reflect(d, normal));
  }

  glm::vec3 colourAlong(const glm::dvec2& px) const {
    const glm::dvec2 plane = (px - 0.5 * glm::dvec2(how.size_px)) / how.focal_px;
    const glm::dmat3 head_from_camera = glm::transpose(camera_from_head);
    const glm::dvec3 d = head_from_camera * glm::normalize(glm::dvec3(plane, 1.0));
    const glm::dvec3 origin = head_from_camera * (-1000.0 * moment.head_m);
    if (const auto p = relief.meet(origin, d)) {
      const glm::vec3 skin = skinAt(*p, origin, d);
      return person.glasses && p->z > kLens_mm ? throughGlasses(origin, d, skin) : skin;
    }
    // Neck and shoulders are a flat shape that moves with the head.
    const glm::dvec2 chest = (px - project({0.0, 120.0, 60.0})) / how.focal_px * moment.head_m.z;
    const double outward = std::max(0.0, std::abs(chest.x) - 0.05);
    const double shoulder = 0.02 + 1.2 * outward * std::sqrt(outward);
    glm::vec3 behind = beside ? beside->colourAlong(px) : background(plane.x, plane.y, person.seed);
    if (std::abs(chest.x) < 0.055 && chest.y > -0.08) behind = person.skin * 0.45f;
    if (chest.y > shoulder + 0.02 && std::abs(chest.x) < 0.21) {
      behind = glm::vec3(0.10f, 0.13f, 0.2f) *
               (0.8f + 0.4f * smoothNoise(static_cast<float>(chest.x * 60.0 + 90.0),
                                          static_cast<float>(chest.y * 20.0), person.seed));
    }
    return behind;
  }
};

namespace {

void expose(const Scene& scene, cv::Mat3f& film) {
  const glm::ivec2 size = scene.how.size_px;
  const glm::dvec2 middle = scene.project({0.0, 0.0, 0.0});
  const double px_per_mm = scene.how.focal_px / scene.moment.head_m.z / 1000.0;
  const std::array<glm::dvec2, 2> eyes{scene.project(scene.eyes[0].irisCentre_mm()),
                                       scene.project(scene.eyes[1].irisCentre_mm())};
  parallelFor(static_cast<std::size_t>(size.y), [&](std::size_t row) {
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec2 corner(x, static_cast<double>(row));
      const double from_eye =
          std::min(glm::distance(corner, eyes[0]), glm::distance(corner, eyes[1]));
      const int n = from_eye < 22.0 * px_per_mm                                 ? kSamplesOfEyes
                    : glm::distance(corner, middle) < kHeadReach_mm * px_per_mm ? kSamplesOfFace
                                                                                : 1;
      glm::vec3 sum(0.0f);
      for (int i = 0; i < n * n; ++i) {
        sum +=
            scene.colourAlong(corner + (glm::dvec2(i % n, i / n) + 0.5) / static_cast<double>(n));
      }
      sum /= static_cast<float>(n * n);
      film(static_cast<int>(row), x) += cv::Vec3f(sum.b, sum.g, sum.r);
    }
  });
}

/// sRGB, 0 to 255, by a table.
class Encoding {
 public:
  Encoding() {
    for (std::size_t i = 0; i < levels_.size(); ++i) {
      const double l = static_cast<double>(i) / static_cast<double>(levels_.size() - 1);
      levels_[i] = static_cast<float>(
          255.0 * (l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055));
    }
  }
  float operator()(float linear) const {
    const float at = std::clamp(linear, 0.0f, 1.0f) * static_cast<float>(levels_.size() - 1);
    return levels_[static_cast<std::size_t>(at + 0.5f)];
  }

 private:
  std::array<float, 16384> levels_;
};

/// Approximately normal, from four uniform numbers. Standard deviation 1.
float normalNoise(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  float sum = -2.0f;
  for (std::uint32_t i = 0; i < 4; ++i) sum += noiseAt(x, y, seed * 4 + i);
  return sum * 1.7320508f;
}

}  // namespace

glm::dmat3 cameraFromHead(const Moment& m) {
  const auto turn = [](double angle, int a, int b) {
    glm::dmat3 r(1.0);
    r[a][a] = r[b][b] = std::cos(angle);
    r[a][b] = std::sin(angle);
    r[b][a] = -std::sin(angle);
    return r;
  };
  return turn(m.yaw_rad, 2, 0) * turn(-m.pitch_rad, 1, 2) * turn(-m.roll_rad, 0, 1);
}

Truth Face::truthOf(const Moment& moment, const Photography& how) const {
  const Scene scene(person_, relief_, moment, how);
  Truth truth{.closed = moment.closed};
  for (std::size_t i = 0; i < 2; ++i) {
    const Eye& eye = scene.eyes[i];
    truth.iris_px[i] = scene.project(eye.irisCentre_mm());
    truth.eye_px[i] = scene.project(eye.centre_mm());
    truth.inner_px[i] = scene.project(eye.corner_mm(true));
    truth.outer_px[i] = scene.project(eye.corner_mm(false));
    const glm::dvec3 iris_m = moment.head_m + scene.camera_from_head * eye.irisCentre_mm() / 1000.0;
    truth.iris_radius_px[i] = how.focal_px * kLimbus_mm / 1000.0 / iris_m.z;
  }
  return truth;
}

cv::Mat Face::photograph(std::span<const Moment> moments, const Photography& how) const {
  cv::Mat3f film(how.size_px.y, how.size_px.x, cv::Vec3f(0.0f, 0.0f, 0.0f));
  for (const Moment& moment : moments) {
    expose(Scene(person_, relief_, moment, how), film);
  }
  // A camera exposes for the image's mean, and the face is part of it. So dark and light skins
  // differ by half (in logarithms) of their real difference.
  const double skin = (person_.skin.r + person_.skin.g + person_.skin.b) / 3.0;
  film *= how.exposure * 1.2 * std::sqrt(0.36 / skin) / static_cast<double>(moments.size());
  if (how.blur_px > 0.0) cv::GaussianBlur(film, film, {}, how.blur_px);
  static const Encoding encoded;
  cv::Mat3b image(film.size());
  parallelFor(static_cast<std::size_t>(film.rows), [&](std::size_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < film.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float level = encoded(film(y, x)[c]);
        // Photon noise grows with the root of the light.
        const float spread =
            static_cast<float>(how.noise) * std::sqrt(0.3f + 0.7f * level / 128.0f);
        const float noise = normalNoise(static_cast<std::uint32_t>(3 * x + c),
                                        static_cast<std::uint32_t>(y), how.seed * 977u + 13u);
        image(y, x)[c] = cv::saturate_cast<unsigned char>(level + spread * noise);
      }
    }
  });
  return image;
}

}  // namespace foci::faces
