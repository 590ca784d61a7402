#include "render/literature/raytrace/embree_scene.h"

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

#if RTC_VERSION_MAJOR >= 4
void EmbreeScene::intersect(EmbreeContext& context, RTCRayHit& ray) const {
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(scene_, &ray, &arguments);
}

void EmbreeScene::occlude(EmbreeContext& context, RTCRay& ray) const {
  rtcInitRayQueryContext(&context);
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  rtcOccluded1(scene_, &ray, &arguments);
}
#else
void EmbreeScene::intersect(EmbreeContext& context, RTCRayHit& ray) const {
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &ray);
}

void EmbreeScene::occlude(EmbreeContext& context, RTCRay& ray) const {
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_, &context, &ray);
}
#endif

}  // namespace foci
