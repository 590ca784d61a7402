// The iris in visible light, to a fraction of a pixel.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace cv {
class Mat;
}

namespace foci {

struct Iris {
  glm::dvec2 centre_px{0.0};  ///< of the limbus; the image's top-left corner is (0, 0)
  double radius_px = 0.0;
  double contrast = 0.0;  ///< grey levels from iris to white
  /// 0 to 1: how well a dark disk between two whites explains what is seen.
  double confidence = 0.0;
};

struct IrisCandidate {
  glm::dvec2 centre_px{0.0};
  double score = 0.0;  ///< the best one's is 1
};

/// Where the gradients of an image point away from: the centres that maximise
///   sum of w (d . g)^2 over the edges at 0.7 to 1.35 radii, d . g > 0
/// with unit directions d from the centre and g of the gradient, weighted by the gradient's
/// strength and the darkness of the centre (Timm and Barth 2011; the band and the weight of lateral
/// edges, which lids leave free, are ours).
/// @param grey         8 bits, one channel
/// @param near_px      where the eye is
/// @param reach_px     how far from there to look, along each axis
/// @param radius_px    of the limbus, within a fifth
/// @param most         how many, at least a radius apart
/// @return the best first; none where the image ends
std::vector<IrisCandidate> coarseIrises(const cv::Mat& grey, const glm::dvec2& near_px,
                                        const glm::dvec2& reach_px, double radius_px,
                                        std::size_t most);

/// Fits a dark disk with a blurred edge between two whites,
///   I = (1 + slope y / r) (in + (out_side - in) S(|p - c| - r)),
/// by robust least squares over the rows that lids leave free.
/// @param near_px    within half a radius of the centre
/// @param radius_px  of the limbus, within a fifth
/// @return nothing where no such disk is
std::optional<Iris> refineIris(const cv::Mat& grey, const glm::dvec2& near_px, double radius_px);

}  // namespace foci
