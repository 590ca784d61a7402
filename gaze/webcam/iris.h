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
  double radius_px = 0.0;     ///< of the limbus
  double contrast = 0.0;      ///< grey levels between iris and sclera
  double confidence = 0.0;    ///< 0 to 1: how well a dark disk on a white ground explains the image
};

struct IrisCandidate {
  glm::dvec2 centre_px{0.0};
  double score = 0.0;  ///< relative to the best candidate, whose score is 1
};

/// Finds centres from which the gradients of the image point away (Timm and Barth 2011). They
/// maximise
///   sum of w (d . g)^2 over the edges between 0.7 and 1.35 radii with d . g > 0.
/// Here d is the unit direction from the centre to the edge, and g the unit gradient. The weight w
/// grows with the strength of the gradient and with the darkness of the centre.
///
/// Two changes are ours: the band of radii, and a larger weight for lateral edges, which the
/// eyelids leave free.
/// @param grey       8 bits, one channel
/// @param near_px    place of the eye
/// @param reach_px   how far from there to search, along each axis
/// @param radius_px  of the limbus, known to a fifth
/// @param max_count  number of candidates, at least a radius apart
/// @return the best candidate first; empty beside the image
std::vector<IrisCandidate> coarseIrises(const cv::Mat& grey, const glm::dvec2& near_px,
                                        const glm::dvec2& reach_px, double radius_px,
                                        std::size_t max_count);

/// Fits a dark disk of radius r with a blurred edge S between two whites, left and right of it:
///   I = (1 + slope y / r) (in + (out_side - in) S(|p - c| - r)).
/// A robust least-squares fit (Huber's weights) over the rows that the eyelids leave free.
/// @param near_px    within half a radius of the centre
/// @param radius_px  of the limbus, known to a fifth
/// @return nothing if the image has no such disk there
std::optional<Iris> refineIris(const cv::Mat& grey, const glm::dvec2& near_px, double radius_px);

}  // namespace foci
