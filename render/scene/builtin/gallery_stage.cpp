#include "render/scene/builtin/gallery_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "render/scene/builtin/pattern.h"

namespace foci {
namespace {

struct Lamp {
  glm::vec3 position_m, aim_m;
  glm::vec3 power;  // linear RGB at 1 m
  float cos_outer, cos_inner;
  float radius_m;
};

const std::array<Lamp, 5> kLamps{{
    {{-1.1f, 3.0f, -0.3f}, {0.0f, 1.25f, -1.4f}, {4.3f, 3.8f, 3.1f}, 0.72f, 0.95f, 0.10f},
    {{1.2f, 3.0f, -2.9f}, {0.1f, 1.3f, -1.9f}, {2.6f, 2.5f, 2.6f}, 0.70f, 0.95f, 0.10f},
    {{-0.2f, 3.3f, -4.5f}, {-0.1f, 1.7f, -6.0f}, {4.6f, 4.0f, 3.2f}, 0.62f, 0.9f, 0.08f},
    {{-0.7f, 3.2f, -2.3f}, {-0.75f, 1.1f, -3.2f}, {3.6f, 3.2f, 2.7f}, 0.80f, 0.96f, 0.08f},
    {{0.7f, 3.2f, -3.3f}, {0.85f, 0.9f, -4.3f}, {4.2f, 3.7f, 3.0f}, 0.80f, 0.96f, 0.08f},
}};

/// Share of a lamp's light that passes a sphere: a ramp over the penumbra.
float lit(const glm::vec3& p, const glm::vec3& to_lamp, float distance_m, float lamp_radius_m,
          const Occluder& occluder) {
  const glm::vec3 d = occluder.center_m - p;
  const float along = glm::dot(d, to_lamp);
  if (along <= 0.0f || along >= distance_m) return 1.0f;
  const float aside = std::sqrt(std::max(glm::dot(d, d) - along * along, 0.0f));
  const float penumbra_m = std::max(lamp_radius_m * along / distance_m, 0.25f * occluder.radius_m);
  return glm::smoothstep(-penumbra_m, penumbra_m, aside - occluder.radius_m);
}

constexpr float kTurn = glm::two_pi<float>();

float bump(float x, float width) { return std::exp(-0.5f * x * x / (width * width)); }

glm::vec2 catmullRom(const std::vector<glm::vec2>& points, float t) {
  const auto last = static_cast<int>(points.size()) - 1;
  const float at = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(last);
  const int i = std::min(static_cast<int>(at), last - 1);
  const float f = at - static_cast<float>(i);
  const auto point = [&](int k) {
    return points[static_cast<std::size_t>(std::clamp(k, 0, last))];
  };
  const glm::vec2 a = point(i - 1), b = point(i), c = point(i + 1), d = point(i + 2);
  return b + 0.5f * f *
                 (c - a + f * (2.0f * a - 5.0f * b + 4.0f * c - d + f * (3.0f * (b - c) + d - a)));
}

/// Distance of a head's surface from its middle, metres, in the direction azimuth, elevation.
float headRadius(float azimuth, float elevation, bool hair) {
  const glm::vec3 d(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                    std::cos(azimuth) * std::cos(elevation));
  const float jaw = 1.0f + 0.35f * glm::smoothstep(0.0f, 1.1f, -elevation);
  float radius = 1.0f / std::sqrt(std::pow(d.x * jaw / 0.079f, 2.0f) +
                                  std::pow(d.y / 0.122f, 2.0f) + std::pow(d.z / 0.098f, 2.0f));
  const float side = std::abs(azimuth);
  const float mouth = elevation + 0.45f * azimuth * azimuth;  // its corners hang
  const float bridge =
      glm::smoothstep(0.30f, -0.22f, elevation) * glm::smoothstep(-0.36f, -0.24f, elevation);
  radius += 0.026f * bump(azimuth, 0.085f + 0.05f * bridge) * bridge;              // nose
  radius += 0.008f * bump(side - 0.17f, 0.06f) * bump(elevation + 0.24f, 0.06f);   // nostrils
  radius += 0.008f * bump(side - 0.34f, 0.22f) * bump(elevation - 0.30f, 0.07f);   // brow
  radius -= 0.014f * bump(side - 0.36f, 0.15f) * bump(elevation - 0.13f, 0.09f);   // sockets
  radius += 0.007f * bump(side - 0.36f, 0.09f) * bump(elevation - 0.11f, 0.055f);  // lids
  radius += 0.006f * bump(side - 0.55f, 0.17f) * bump(elevation + 0.10f, 0.13f);   // cheeks
  radius += 0.008f * bump(azimuth, 0.16f) * bump(mouth + 0.47f, 0.045f);           // lips
  radius += 0.008f * bump(azimuth, 0.14f) * bump(mouth + 0.60f, 0.05f);
  radius -= 0.005f * bump(azimuth, 0.17f) * bump(mouth + 0.535f, 0.022f);
  radius += 0.012f * bump(azimuth, 0.26f) * bump(elevation + 0.84f, 0.13f);       // chin
  radius += 0.012f * bump(side - 1.62f, 0.10f) * bump(elevation - 0.02f, 0.20f);  // ears
  if (hair) {
    const float scalp =
        glm::smoothstep(0.0f, 0.22f, elevation - 0.62f + 0.62f * glm::smoothstep(0.8f, 1.9f, side));
    const float curl = fractalNoise({4.0f * d.x + 3.0f * d.z + 40.0f, 5.0f * d.y + 40.0f}, 2, 21);
    radius += scalp * (0.008f + 0.006f * std::sin(34.0f * curl + 6.0f * d.y));
  }
  return radius;
}

}  // namespace

void GalleryStage::add(Shape shape, Paint paint, const Material& material, float opacity,
                       std::function<bool(const SurfacePoint&)> keep) {
  SampledFor audience = audience_;
  audience.step_rad *= material.coarse;
  const ParametricSurface surface{.at = std::move(shape),
                                  .paint = std::move(paint),
                                  .light =
                                      [&](const SurfacePoint& at, const glm::vec3& paint_there) {
                                        return light_.shade(at, paint_there, material);
                                      },
                                  .keep = std::move(keep),
                                  .opacity = opacity,
                                  .two_sided = material.two_sided};
  appendSurface(cloud_, surface, audience);
}

void GalleryStage::addClosed(Shape shape, Paint paint, const Material& material) {
  cloud_.bodies.of_surfel.resize(cloud_.size(), 0);
  add(std::move(shape), std::move(paint), material);
  cloud_.bodies.of_surfel.resize(cloud_.size(), ++bodies_);
}

glm::vec3 GalleryLight::shade(const SurfacePoint& at, const glm::vec3& paint,
                              const Material& material) const {
  const glm::vec3 p = at.p_world;
  const glm::vec3 to_eye = glm::normalize(eye_m_ - p);
  const bool turned = material.two_sided && glm::dot(at.normal, to_eye) < 0.0f;
  const glm::vec3 n = turned ? -at.normal : at.normal;

  float open = 1.0f;  // share of the sky; each occluder takes cos / (distance / radius)^2
  if (material.shadowed) {
    for (const Occluder& occluder : occluders_) {
      const glm::vec3 d = occluder.center_m - p;
      const float distance_m = std::max(glm::length(d), 1.02f * occluder.radius_m);
      const float ratio = occluder.radius_m / distance_m;
      open *= 1.0f - std::clamp(glm::dot(n, d) / distance_m, 0.0f, 1.0f) * ratio * ratio * 0.9f;
    }
  }
  const float up = 0.5f + 0.5f * n.y;
  glm::vec3 light =
      open * glm::mix(glm::vec3(0.075f, 0.07f, 0.075f), glm::vec3(0.17f, 0.18f, 0.20f), up);
  const float glossy = material.gloss * glm::smoothstep(0.0f, 0.25f, glm::dot(n, to_eye));
  glm::vec3 highlight(0.0f);
  for (const Lamp& lamp : kLamps) {
    const glm::vec3 d = lamp.position_m - p;
    const float distance_m = glm::length(d);
    const glm::vec3 to_lamp = d / distance_m;
    const float facing = glm::dot(n, to_lamp);
    const float beam =
        glm::smoothstep(lamp.cos_outer, lamp.cos_inner,
                        glm::dot(-to_lamp, glm::normalize(lamp.aim_m - lamp.position_m)));
    if (facing <= 0.0f || beam <= 0.0f) continue;
    float seen = beam / (distance_m * distance_m);
    if (material.shadowed) {
      for (const Occluder& occluder : occluders_) {
        seen *= lit(p, to_lamp, distance_m, lamp.radius_m, occluder);
      }
    }
    light += lamp.power * seen * facing;
    const float half = std::max(glm::dot(n, glm::normalize(to_lamp + to_eye)), 0.0f);
    highlight += lamp.power * seen * glossy * std::pow(half, material.hardness);
  }
  const glm::vec3 linear = paint * light + highlight;
  return glm::vec3(1.0f) -
         glm::exp(-1.35f * linear);  // the shoulder of a film curve, so that no light clips
}

Shape rectangle(const glm::vec3& corner, const glm::vec3& edge_u, const glm::vec3& edge_v) {
  return [=](glm::vec2 uv) { return corner + uv.x * edge_u + uv.y * edge_v; };
}

Shape ball(const glm::vec3& center, float radius) {
  return [=](glm::vec2 uv) {
    const float azimuth = kTurn * uv.x, polar = glm::pi<float>() * (1.0f - uv.y);
    return center + radius * glm::vec3(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                       -std::sin(polar) * std::sin(azimuth));
  };
}

Shape lathe(const glm::vec3& foot, std::vector<glm::vec2> profile, int flutes, float flute_depth) {
  return [=, profile = std::move(profile)](glm::vec2 uv) {
    const glm::vec2 p = catmullRom(profile, uv.y);
    const float azimuth = kTurn * uv.x;
    const float groove =
        1.0f - flute_depth *
                   std::pow(std::abs(std::sin(0.5f * static_cast<float>(flutes) * azimuth)), 3.0f);
    const float radius = std::max(p.x, 1e-4f) * (flutes > 0 ? groove : 1.0f);
    return foot + glm::vec3(radius * std::cos(azimuth), p.y, -radius * std::sin(azimuth));
  };
}

Shape tube(const Curve& curve, const std::function<float(float)>& radius, const glm::vec3& aside) {
  return [=](glm::vec2 uv) {
    const float step = 2e-3f;
    const glm::vec3 along = glm::normalize(curve(uv.y + step) - curve(uv.y - step));
    const glm::vec3 n = glm::normalize(glm::cross(along, aside)), b = glm::cross(along, n);
    const float azimuth = kTurn * uv.x;
    return curve(uv.y) + radius(uv.y) * (std::cos(azimuth) * n + std::sin(azimuth) * b);
  };
}

Shape leaf(const glm::vec3& base, const glm::vec3& rise, const glm::vec3& side, float droop) {
  return [=](glm::vec2 uv) {
    const float t = uv.y, across = 2.0f * uv.x - 1.0f;
    const float outline = std::sin(glm::pi<float>() * std::pow(t, 0.75f)) * (1.0f - 0.25f * t);
    const glm::vec3 fold =
        0.18f * std::abs(across) * outline * glm::length(side) * glm::vec3(0, 1, 0);
    return base + t * rise + across * (outline + 0.02f) * side + fold +
           glm::vec3(0.0f, -droop * t * t, 0.0f);
  };
}

Shape head(const glm::vec3& center, float scale, glm::vec2 azimuth, glm::vec2 elevation,
           bool hair) {
  return [=](glm::vec2 uv) {
    const float a = glm::mix(azimuth.x, azimuth.y, uv.x),
                e = glm::mix(elevation.x, elevation.y, uv.y);
    const glm::vec3 d(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
    return center + scale * headRadius(a, e, hair) * d;
  };
}

Curve torusKnot(const glm::vec3& center, float scale, int p, int q) {
  return [=](float t) {
    const float a = kTurn * static_cast<float>(p) * t, b = kTurn * static_cast<float>(q) * t;
    const float r = 1.0f + 0.45f * std::cos(b);
    return center + scale * glm::vec3(r * std::cos(a), r * std::sin(a), 0.45f * std::sin(b));
  };
}

}  // namespace foci
