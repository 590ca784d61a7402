#include "render/scene/builtin/gallery_light.h"

#include <algorithm>
#include <array>
#include <cmath>

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

}  // namespace

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

}  // namespace foci
