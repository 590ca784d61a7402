// One message of Pupil Core's network interface.
#define MSGPACK_NO_BOOST
#include <algorithm>
#include <cmath>
#include <msgpack.hpp>

#include "gaze/geometry/line_of_sight.h"
#include "gaze/live/pupil_source.h"

namespace foci {
namespace {

using Object = msgpack::object;

/// The value of a key in a map. A key made of digits may also be an integer in the map.
const Object* find(const Object& map, std::string_view key) {
  if (map.type != msgpack::type::MAP) return nullptr;
  for (std::uint32_t i = 0; i < map.via.map.size; ++i) {
    const auto& [name, value] = map.via.map.ptr[i];
    if (name.type == msgpack::type::STR &&
        std::string_view(name.via.str.ptr, name.via.str.size) == key) {
      return &value;
    }
    if (name.type == msgpack::type::POSITIVE_INTEGER && std::to_string(name.via.u64) == key) {
      return &value;
    }
  }
  return nullptr;
}

std::optional<double> numberIn(const Object* object) {
  if (!object) return std::nullopt;
  try {
    const double value = object->as<double>();
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  } catch (const msgpack::type_error&) {
    return std::nullopt;
  }
}

/// A list of `count` numbers.
std::optional<glm::dvec3> vectorIn(const Object* object, std::uint32_t count) {
  if (!object || object->type != msgpack::type::ARRAY || object->via.array.size != count) {
    return std::nullopt;
  }
  glm::dvec3 result{0.0};
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto value = numberIn(&object->via.array.ptr[i]);
    if (!value) return std::nullopt;
    result[static_cast<int>(i)] = *value;
  }
  return result;
}

/// From the scene camera's frame (x right, y down, z forward) to the eye frame.
glm::dvec3 inEyeFrame(const glm::dvec3& camera) { return {camera.x, -camera.y, -camera.z}; }

void readEye(const Object* direction, const Object* origin_mm, EyeSample& eye) {
  if (const auto normal = vectorIn(direction, 3)) {
    const double length = glm::length(*normal);
    if (length > 0.5 && length < 2.0) eye.direction = inEyeFrame(*normal) / length;
  }
  if (const auto centre_mm = vectorIn(origin_mm, 3)) eye.origin_m = 1e-3 * inEyeFrame(*centre_mm);
}

}  // namespace

std::optional<GazeSample> parsePupilMessage(std::string_view topic, std::string_view payload,
                                            const Screen& screen) {
  constexpr std::size_t kMaxBytes = 1 << 20;   // a message has a few kilobytes
  constexpr double kMinPupilConfidence = 0.6;  // as in Pupil Core's own software
  constexpr double kMaxClock_s = 1e11, kMaxGaze_px = 1e5;
  if (!topic.starts_with("gaze.") || payload.size() > kMaxBytes) return std::nullopt;
  msgpack::object_handle handle;
  try {
    const msgpack::unpack_limit limit(4096, 4096, 1 << 16, 1 << 16, 1 << 16, 16);
    handle = msgpack::unpack(payload.data(), payload.size(), nullptr, nullptr, limit);
  } catch (const msgpack::unpack_error&) {
    return std::nullopt;
  } catch (const std::bad_alloc&) {
    return std::nullopt;
  }
  const Object& map = handle.get();
  const auto time_s = numberIn(find(map, "timestamp"));
  if (!time_s || std::abs(*time_s) > kMaxClock_s) return std::nullopt;
  GazeSample sample{.time_s = *time_s};
  if (const auto confidence = numberIn(find(map, "confidence"))) {
    sample.confidence = std::clamp(*confidence, 0.0, 1.0);
    if (*confidence < kMinPupilConfidence) return sample;
  }

  if (topic.starts_with("gaze.3d.01")) {
    for (const bool right : {false, true}) {
      const std::string_view key = right ? "0" : "1";
      const Object* normals = find(map, "gaze_normals_3d");
      const Object* centres = find(map, "eye_centers_3d");
      readEye(normals ? find(*normals, key) : nullptr, centres ? find(*centres, key) : nullptr,
              sample.eyes[right]);
    }
  } else if (topic.starts_with("gaze.3d.")) {
    readEye(find(map, "gaze_normal_3d"), find(map, "eye_center_3d"),
            sample.eyes[topic.starts_with("gaze.3d.0")]);
  }
  glm::dvec3 sum{0.0};
  for (const EyeSample& eye : sample.eyes) sum += eye.direction.value_or(glm::dvec3(0.0));
  if (glm::length(sum) > 0.5) {
    sample.point_px = pointOnScreen_px(screen, glm::normalize(sum));
  } else if (const auto norm = vectorIn(find(map, "norm_pos"), 2)) {
    sample.point_px = glm::dvec2(norm->x, 1.0 - norm->y) * glm::dvec2(screen.size_px);
  }
  if (sample.point_px && !(glm::length(*sample.point_px) <= kMaxGaze_px)) sample.point_px.reset();
  return sample;
}

}  // namespace foci
