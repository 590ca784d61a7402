#include "tests/faces/eye.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace foci::faces {
namespace {

const double kLimbusPlane_mm = std::sqrt(kEyeball_mm * kEyeball_mm - kLimbus_mm * kLimbus_mm);
const double kCorneaCentre_mm =
    kLimbusPlane_mm - std::sqrt(kCornea_mm * kCornea_mm - kLimbus_mm * kLimbus_mm);

double step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Distance along a ray to its nearer intersection with a sphere.
std::optional<double> meetSphere(const glm::dvec3& origin, const glm::dvec3& direction,
                                 const glm::dvec3& centre, double radius) {
  const glm::dvec3 o = origin - centre;
  const double b = glm::dot(o, direction);
  const double square = b * b - glm::dot(o, o) + radius * radius;
  if (square <= 0.0) return std::nullopt;
  return -b - std::sqrt(square);
}

}  // namespace

glm::vec3 roomLight(const glm::dvec3& d) {
  glm::vec3 light(0.10f, 0.095f, 0.09f);
  if (d.z >= -0.05) return light;
  const double across = glm::degrees(std::atan2(d.x, -d.z));
  const double up = glm::degrees(std::atan2(-d.y, -d.z));
  const auto within = [](double x, double low, double high) { return x > low && x < high; };
  const bool bar = within(across, -43.0, -41.5) || within(up, 24.0, 25.5);
  if (within(across, -54.0, -30.0) && within(up, 10.0, 40.0) && !bar) light += glm::vec3(8.0f);
  if (within(across, -24.0, 24.0) && within(up, -32.0, -4.0)) {
    light += glm::vec3(0.9f, 0.95f, 1.1f);
  }
  if (std::hypot(across - 35.0, up - 48.0) < 5.0) light += glm::vec3(30.0f, 26.0f, 20.0f);
  return light;
}

Eye::Eye(const Person& person, const Moment& moment, int side)
    : person_(person),
      side_(side),
      closed_(moment.closed),
      centre_(side * 0.5 * person.ipd_mm, 0.0, 0.0),
      camera_from_head_(cameraFromHead(moment)) {
  // First the line of sight in the head, then the eye's axis, which is temporal of it and below.
  const glm::dvec3 centre_m = moment.head_m + camera_from_head_ * centre_ / 1000.0;
  const glm::dvec3 sight =
      glm::transpose(camera_from_head_) * glm::normalize(moment.looks_at_m - centre_m);
  const double across = std::atan2(sight.x, -sight.z) + side * glm::radians(person.kappa_deg.x);
  const double up = std::asin(-sight.y) - glm::radians(person.kappa_deg.y);
  upwards_deg_ = glm::degrees(up);
  const glm::dvec3 axis(std::sin(across) * std::cos(up), -std::sin(up),
                        -std::cos(across) * std::cos(up));
  const glm::dvec3 x = glm::normalize(glm::cross(axis, glm::dvec3(0.0, -1.0, 0.0)));
  head_from_eye_ = glm::dmat3(x, glm::cross(axis, x), axis);
}

glm::dvec3 Eye::irisCentre_mm() const { return centre_ + head_from_eye_[2] * kLimbusPlane_mm; }

std::optional<Eye::Lids> Eye::lidsAt(double x) const {
  constexpr double kMiddle_mm = -1.0, kHalf_mm = 14.5;  // so the inner corner is at -15.5
  const double q = (side_ * (x - centre_.x) - kMiddle_mm) / kHalf_mm;
  if (std::abs(q) >= 1.0) return std::nullopt;
  const double line = 0.5 - q;  // the outer corner lies higher
  const double open_upper =
      line - person_.lids * (5.4 + 0.17 * upwards_deg_) * std::pow(1.0 - q * q, 0.75);
  const double lower = line + person_.lids * (4.9 - 0.06 * upwards_deg_ - 0.8 * closed_) *
                                  std::pow(1.0 - q * q, 0.85);
  return Lids{glm::mix(open_upper, lower, closed_), lower};
}

glm::dvec3 Eye::corner_mm(bool inner) const {
  const double across = inner ? -15.5 : 13.5, y = inner ? 1.5 : -0.5;
  const double x = centre_.x + side_ * across;
  return {x, y, -std::sqrt(std::max(0.0, kLids_mm * kLids_mm - across * across))};
}

bool Eye::isOpenAt(double x, double y) const {
  const auto lids = lidsAt(x);
  return lids && y > lids->upper && y < lids->lower;
}

float Eye::lashesAt(double x, double y) const {
  const auto lids = lidsAt(x);
  if (!lids) return 0.0f;
  const float hairs = smoothNoise(static_cast<float>(x) / 0.5f, static_cast<float>(y) / 2.5f,
                                  person_.seed * 16 + 9);
  const double above = lids->upper - y, below = y - lids->lower;
  if (person_.made_up) {
    return static_cast<float>(above >= 0.0
                                  ? 0.9 * step(3.2, 1.4, above) + 0.5 * step(9.0, 3.0, above)
                                  : 0.9 * step(2.2, 0.7, below));
  }
  if (above >= 0.0) {
    return static_cast<float>(step(1.5, 0.3, above)) * 0.9f +
           static_cast<float>(step(3.5, 1.0, above)) * 0.35f * hairs;
  }
  return below >= 0.0 ? static_cast<float>(step(1.5, 0.0, below)) * (0.15f + 0.3f * hairs) : 0.0f;
}

float Eye::lashesOver(double x, double y) const {
  const auto lids = lidsAt(x);
  if (!lids || person_.lashes == 0.0) return 0.0f;
  // Hairs that spread outwards, in front of the eye's upper part and, fewer, of its lower rim.
  const double under = y - lids->upper, over = lids->lower - y;
  const double fan = x + 0.35 * (x - centre_.x) / 14.0 * under;
  const auto hair = static_cast<double>(
      smoothNoise(static_cast<float>(fan) / 0.45f + 300.0f, 7.0f, person_.seed * 16 + 12));
  const double upper = step(3.6 * (0.4 + hair), 0.3, under) * (0.45 + 0.55 * step(0.4, 0.6, hair));
  const double lower = 0.6 * step(1.4, 0.2, over) * step(0.5, 0.7, hair);
  return static_cast<float>(person_.lashes * std::max(upper, lower));
}

glm::vec3 Eye::irisAt(double x, double y) const {
  const double r = std::hypot(x, y);
  const auto angle = static_cast<float>(std::atan2(y, x));
  const double pupil = 0.5 * person_.pupil_mm;
  // Fibres run outwards. The collarette is lighter, the ring at the limbus darker.
  const float fibres = smoothNoise(20.0f + 14.0f * std::cos(angle) + 0.3f * static_cast<float>(r),
                                   20.0f + 14.0f * std::sin(angle), person_.seed * 16 + 10);
  float shade = 0.65f + 0.7f * fibres;
  shade *= static_cast<float>(1.0 + 0.35 * step(1.6, 0.4, std::abs(r - pupil - 1.0)));
  shade *= static_cast<float>(1.0 - 0.65 * step(kLimbus_mm - 1.4, kLimbus_mm, r));
  const glm::vec3 colour = person_.iris * shade;
  return colour * static_cast<float>(step(pupil - 0.1, pupil + 0.1, r)) + glm::vec3(0.004f);
}

glm::vec3 Eye::seenAlong(const glm::dvec3& origin, const glm::dvec3& direction,
                         const glm::vec3& towards_light, float ambient) const {
  const auto t = meetSphere(origin, direction, centre_, kEyeball_mm);
  if (!t) return person_.skin * 0.25f;
  const glm::dvec3 hit = origin + direction * *t;
  const glm::dvec3 local = glm::transpose(head_from_eye_) * (hit - centre_);
  const auto lit = [&](const glm::dvec3& normal, float wrap) {
    const float towards = glm::dot(glm::vec3(normal), towards_light);
    return ambient + (1.0f - ambient) * std::max(0.0f, (towards + wrap) / (1.0f + wrap));
  };
  const auto mirrored = [&](const glm::dvec3& normal) {
    const double facing = std::max(0.0, -glm::dot(direction, normal));
    const auto share = static_cast<float>(0.025 + 0.975 * std::pow(1.0 - facing, 5.0));
    return share * roomLight(camera_from_head_ * glm::reflect(direction, normal));
  };

  // The sclera is pink towards the corners.
  const double nasal = -side_ * (hit.x - centre_.x);
  glm::vec3 white = glm::mix(glm::vec3(0.46f, 0.40f, 0.37f), person_.skin, 0.3f);
  white *=
      0.92f + 0.16f * smoothNoise(static_cast<float>(hit.x) / 1.5f + 50.0f,
                                  static_cast<float>(hit.y) / 1.5f + 50.0f, person_.seed * 16 + 11);
  white =
      glm::mix(white, glm::mix(person_.skin, glm::vec3(0.32f, 0.15f, 0.13f), 0.5f),
               static_cast<float>(std::max(step(9.5, 12.0, nasal), 0.5 * step(9.0, 12.0, -nasal))));
  const double aside = std::abs(hit.x - centre_.x);
  white *= static_cast<float>(1.0 - 0.8 * person_.shade * step(4.5, 11.0, aside));
  const glm::dvec3 outwards = (hit - centre_) / kEyeball_mm;
  glm::vec3 colour = white * lit(outwards, 0.6f);
  glm::vec3 glint = 0.4f * mirrored(outwards);

  const double limbus = local.z > 0.0 ? std::hypot(local.x, local.y) : 2.0 * kLimbus_mm;
  if (limbus < kLimbus_mm + 0.3) {
    const glm::dvec3 cornea = centre_ + head_from_eye_[2] * kCorneaCentre_mm;
    const auto front = meetSphere(origin, direction, cornea, kCornea_mm);
    glm::dvec3 surface = hit, normal = outwards;
    if (front && *front < *t) {
      surface = origin + direction * *front;
      normal = (surface - cornea) / kCornea_mm;
    }
    const glm::dvec3 inside = glm::refract(direction, normal, 1.0 / kCorneaIndex);
    const glm::dvec3 o = glm::transpose(head_from_eye_) * (surface - centre_);
    const glm::dvec3 d = glm::transpose(head_from_eye_) * inside;
    const glm::dvec3 on_iris = o + d * ((kLimbusPlane_mm - o.z) / std::min(d.z, -1e-3));
    const glm::vec3 iris = irisAt(on_iris.x, on_iris.y) * lit(head_from_eye_[2], 0.6f);
    const auto share = static_cast<float>(step(kLimbus_mm + 0.3, kLimbus_mm - 0.3, limbus));
    colour = glm::mix(colour, iris, share);
    glint = glm::mix(glint, mirrored(normal), share);
  }
  // The upper eyelid and its lashes throw a shadow.
  double shadow = 1.0;
  if (const auto lids = lidsAt(hit.x)) {
    const double dark = 0.35 - 0.25 * person_.shade, deep = 4.2 + 3.0 * person_.shade;
    shadow = dark + (1.0 - dark) * step(-0.3, deep, hit.y - lids->upper);
    colour += 0.10f * static_cast<float>(step(0.8, 0.2, lids->lower - hit.y));  // tears
  }
  return colour * static_cast<float>(shadow) + glint * static_cast<float>(step(0.0, 1.2, shadow));
}

}  // namespace foci::faces
