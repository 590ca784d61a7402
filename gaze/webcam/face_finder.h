// Finds a face and its eyes in a single image. The boosted cascades of Viola and Jones (2001), from
// Debian's package opencv-data, find faces and eyes. Then the pair of irises is taken that suits a
// face best.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

namespace cv {
class Mat;
}

namespace foci {

struct FoundFace {
  /// Centres of the irises, px. Index 0 is the observer's left eye, at the image's right.
  std::array<glm::dvec2, 2> eyes_px{};
};

class FaceFinder {
 public:
  /// @throws InputError if the cascades are not installed
  FaceFinder();
  ~FaceFinder();
  FaceFinder(FaceFinder&& other) noexcept;

  /// Finds a face that is at least an eighth of the image wide and has open eyes.
  /// @param grey  8 bits, one channel
  std::optional<FoundFace> find(const cv::Mat& grey);

 private:
  struct Cascades;
  std::unique_ptr<Cascades> cascades_;
};

}  // namespace foci
