// Embree's device and a scene of one geometry.
#pragma once

#include <embree3/rtcore.h>

namespace foci {

class EmbreeScene {
 public:
  /// Throws std::runtime_error where Embree cannot be started.
  EmbreeScene();
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCDevice device() const { return device_; }
  RTCScene get() const { return scene_; }

  /// Builds the scene from the geometry, which then belongs to it.
  /// Throws std::runtime_error where Embree fails.
  void build(RTCGeometry geometry);

 private:
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace foci
