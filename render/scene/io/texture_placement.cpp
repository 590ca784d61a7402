// KHR_texture_transform (Khronos), and aiUVTransform of Assimp 5.2.
#include "render/scene/io/texture_placement.h"

#include <assimp/mesh.h>

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

constexpr int kMaxSet = AI_MAX_NUMBER_OF_TEXTURECOORDS - 1;
constexpr float kMaxTransform = 1e6f;  // coordinates stay finite

glm::mat3 moved(const glm::vec2& by) {
  return {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {by.x, by.y, 1.0f}};
}

glm::mat3 scaled(const glm::vec2& by) {
  return {{by.x, 0.0f, 0.0f}, {0.0f, by.y, 0.0f}, {0.0f, 0.0f, 1.0f}};
}

/// Counter-clockwise where v points upwards.
glm::mat3 turned(float angle_rad) {
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {{c, s, 0.0f}, {-s, c, 0.0f}, {0.0f, 0.0f, 1.0f}};
}

bool isUsable(const aiUVTransform& t) {
  const auto usable = [](float x) { return std::abs(x) <= kMaxTransform; };  // false for NaN
  return usable(t.mTranslation.x) && usable(t.mTranslation.y) && usable(t.mScaling.x) &&
         usable(t.mScaling.y) && usable(t.mRotation);
}

/// glTF scales, turns and then moves, in a frame whose v points downwards. Assimp restates this as
/// a turn about the middle of the texture and a scale after it, which is the same only for equal
/// scales. So its translation is taken back to glTF's.
glm::mat3 gltfTransform(const aiUVTransform& t) {
  const glm::vec2 scale(t.mScaling.x, t.mScaling.y);
  const float angle_rad = -t.mRotation;
  const float c = std::cos(angle_rad), s = std::sin(angle_rad);
  const glm::vec2 offset(t.mTranslation.x - 0.5f * scale.x * (1.0f - c + s),
                         0.5f * scale.y * (s + c - 1.0f) + 1.0f - scale.y - t.mTranslation.y);
  const glm::mat3 flipped = moved({0.0f, 1.0f}) * scaled({1.0f, -1.0f});
  return flipped * moved(offset) * turned(-angle_rad) * scaled(scale) * flipped;
}

}  // namespace

TexturePlacement shiftedPlacement(const glm::vec2& scale, const glm::vec2& offset) {
  return {.set = 0, .transform = moved(offset) * scaled(scale)};
}

TexturePlacement texturePlacement(const aiMaterial& material, aiTextureType type, bool gltf) {
  TexturePlacement placement;
  int set = 0;
  if (material.Get(AI_MATKEY_UVWSRC(type, 0), set) == aiReturn_SUCCESS) {
    placement.set = static_cast<unsigned>(std::clamp(set, 0, kMaxSet));
  }
  aiUVTransform t;
  if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), t) != aiReturn_SUCCESS || !isUsable(t)) {
    return placement;
  }
  const glm::vec2 middle(0.5f);
  placement.transform = gltf ? gltfTransform(t)
                             : moved({t.mTranslation.x, t.mTranslation.y}) *
                                   scaled({t.mScaling.x, t.mScaling.y}) * moved(middle) *
                                   turned(t.mRotation) * moved(-middle);
  return placement;
}

}  // namespace foci
