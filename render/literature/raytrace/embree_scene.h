// Embree's device and a scene of one geometry, with Embree 3 or 4.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <glm/glm.hpp>

namespace foci {

/// What a query hands to Embree, and Embree back to the functions of a geometry: a struct that
/// begins with it can carry more.
#if RTC_VERSION_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;
#else
using EmbreeContext = RTCIntersectContext;
#endif

class EmbreeScene {
 public:
  /// Throws std::runtime_error where Embree cannot be started.
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCDevice device() const { return device_; }

  /// Builds the scene from the geometry, which then belongs to it.
  /// Throws std::runtime_error where Embree fails.
  void build(RTCGeometry geometry);

  /// A ray and its nearest hit, if there is one.
  /// @param begin, end  of the ray, times `along`
  RTCRayHit trace(EmbreeContext& context, const glm::vec3& from, const glm::vec3& along,
                  float begin, float end) const;

 private:
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace foci
