#include "render/methods/raytrace/embree_scene.h"

#include <stdexcept>

namespace foci {
namespace {

#ifdef FOCI_TSAN
constexpr const char* kDevice = "threads=1";  // the sanitizer cannot follow Embree's own threads
#else
constexpr const char* kDevice = nullptr;
#endif

}  // namespace

EmbreeScene::EmbreeScene() : device_(rtcNewDevice(kDevice)) {
  if (!device_) throw std::runtime_error("Embree: cannot be started");
}

EmbreeScene::~EmbreeScene() {
  if (scene_) rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeScene::build(RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree: cannot build the scene");
  }
}

}  // namespace foci
