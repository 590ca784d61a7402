// Finds a face and its eyes in an image without knowing anything of the one before: the boosted
// cascades of Viola and Jones (2001) as Debian's opencv-data has them, then irises that make a
// pair.
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
  /// Centres of the irises, px: index 0 is the observer's left one, at the image's right.
  std::array<glm::dvec2, 2> eyes_px{};
};

class FaceFinder {
 public:
  /// @throws InputError where the cascades are not installed
  FaceFinder();
  ~FaceFinder();
  FaceFinder(FaceFinder&& other) noexcept;

  /// The largest face, at least an eighth of the image wide, with its eyes open.
  /// @param grey  8 bits, one channel
  std::optional<FoundFace> find(const cv::Mat& grey);

 private:
  struct Cascades;
  std::unique_ptr<Cascades> cascades_;
};

}  // namespace foci
