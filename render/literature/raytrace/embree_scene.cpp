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

RTCRayHit EmbreeScene::trace(EmbreeContext& context, const glm::vec3& from, const glm::vec3& along,
                             float begin, float end) const {
  RTCRayHit ray{};
  ray.ray.org_x = from.x;
  ray.ray.org_y = from.y;
  ray.ray.org_z = from.z;
  ray.ray.dir_x = along.x;
  ray.ray.dir_y = along.y;
  ray.ray.dir_z = along.z;
  ray.ray.tnear = begin;
  ray.ray.tfar = end;
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  rtcIntersect1(scene_, &ray, &arguments);
#else
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_, &context, &ray);
#endif
  return ray;
}

}  // namespace foci
