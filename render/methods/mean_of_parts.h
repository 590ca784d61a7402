// The mean of the frames that the sub-apertures see, with the halos of diffraction.
#pragma once

#include <vector>

#include "render/image/frame.h"
#include "render/optics/pupil.h"

namespace foci {

/// Collects what the parts of a lens see, and spreads it along the parts' radii, in linear RGBA:
/// light near the rim of the pupil spreads across the rim (`DiffractionHalo`).
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

/// The fewest parts, of `least`, 7, 19, 37 and 61, over which the wavefront's slope is linear up to
/// `kNonlinear_px`: the number follows from the variance of the slope.
std::vector<LensPart> partsFor(const Defocus& defocus, const Pupil& pupil, int least);

/// Root mean square over the lens. On the scenes of the chart, 7 parts of 0.18 px err by up to 1.4
/// just-noticeable differences, and 19 parts of less than 0.1 px by 0.7, as without aberrations.
inline constexpr float kNonlinear_px = 0.1f;

/// Adds `weight` times a part's frame to the sum. Distances count by their coverage. Adds on the
/// GPU where the part lies there and has no distances, which it first reads otherwise.
/// @param first  replaces the sum
void addPart(Frame& part, float weight, bool first, Frame& sum);

/// Divides the sums of distances by the coverage.
void finishDepth(Frame& sum);

/// With the halos of diffraction, where the parts have cores and diffraction shows.
/// @param diffraction_px  that of `lensParts`; 0: no halos
/// @param part            keeps the buffers of one part's frame
/// @param render          (const LensPart&, Frame&) renders one part
template <typename Render>
void meanOfParts(std::vector<LensPart> parts, float diffraction_px, Frame& part, Frame& mean,
                 const Render& render) {
  if (parts.size() == 1) {
    render(parts.front(), mean);
    return;
  }
  Halos halos(diffraction_px, parts);
  part.resize(mean.size_px, !mean.depth_m.empty());
  for (const LensPart& each : parts) {
    render(each, part);
    addPart(part, each.weight, &each == parts.data(), mean);
    if (halos) halos.add(each, part);
  }
  if (!mean.gpu) finishDepth(mean);
  if (halos) halos.spreadInto(mean);
}

}  // namespace foci
