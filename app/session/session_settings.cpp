#include "app/session/session_settings.h"

#include "base/input_error.h"
#include "render/methods/method.h"

namespace foci {

void checkSettings(const SessionSettings& settings) {
  if (const auto expected = expectedMethod(settings.method)) {
    throw InputError("method " + settings.method, "expected " + *expected);
  }
  const glm::ivec2& size_px = settings.output.size_px;
  if (size_px.x <= 0 || size_px.y <= 0) throw InputError("output size", "expected 1 px or more");
  const StereoView stereo = settings.output.stereo;
  if ((stereo == StereoView::side_by_side && size_px.x % 2 != 0) ||
      (stereo == StereoView::top_bottom && size_px.y % 2 != 0)) {
    throw InputError("output size", "expected an even number of px, to be halved for two eyes");
  }
}

AccommodationSettings accommodationOf(const SessionSettings& settings) {
  AccommodationSettings accommodation = settings.focus.accommodation;
  accommodation.far_point_D = settings.observer.refraction.far_point_D;
  return accommodation;
}

}  // namespace foci
