// The halos of diffraction (render/optics/diffraction.h). Light near the rim of the pupil spreads
// across the rim, which is along the radius.
#pragma once

#include <vector>

#include "render/image/frame.h"
#include "render/optics/pupil.h"

namespace foci {

/// Collects what the parts of a lens see, and spreads it along the parts' radii, in linear RGBA.
/// Halos are wider than what surfaces in front hide, so frames are spread as a whole. The border of
/// a frame continues beyond it.
class Halos {
 public:
  /// Sorts the parts by the direction of their radius: frames of one direction are spread together.
  Halos(float diffraction_px, std::vector<LensPart>& parts);

  /// False where diffraction does not show.
  explicit operator bool() const { return shown_; }

  /// Call it for each part, in the order of the parts.
  void add(const LensPart& part, Frame& frame);

  /// @param mean  of the parts' frames, which have the core's light (`lensParts`). The light is
  ///              read from the GPU if it lies there.
  void spreadInto(Frame& mean);

 private:
  struct Halo {
    float share = 0.0f;
    double sigma_px = 0.0;  ///< in pixels of `light`
    int step_px = 1;        ///< width of these
    Frame light = {};
  };
  void spreadGroup();

  bool shown_ = false;
  float all_weight_ = 0.0f;
  std::vector<Halo> halos_;
  int direction_ = -1;
  Frame group_;  ///< of one direction
};

}  // namespace foci
