// Networks that find a face, its shape and its eyes in a single image: BlazeFace (Bazarevsky et al.
// 2019), Face Mesh (Kartynnik et al. 2019) and Iris (Ablavatski et al. 2020), all of MediaPipe,
// Apache-2.0. OpenCV runs them. Their weights are not part of foci: app/webcam_models.sh gets them.
#pragma once

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace cv {
class Mat;
}

namespace foci {

// Points are in pixels; the image's top-left corner is (0, 0).

struct FaceBox {
  glm::dvec2 min_px{0.0}, max_px{0.0};
  std::array<glm::dvec2, 2> eyes_px{};  ///< at the image's left and right

  double side_px() const { return std::max(max_px.x - min_px.x, max_px.y - min_px.y); }
};

/// A square that a network sees, turned clockwise on the image.
struct Crop {
  glm::dvec2 centre_px{0.0};
  double side_px = 0.0;
  double angle_rad = 0.0;
};

/// The points of a face, in the numbering of Face Mesh.
struct FaceMesh {
  static constexpr std::size_t kPoints = 468;
  /// Corners of the eyes, from the image's left: outer, inner, inner, outer.
  static constexpr std::array<std::size_t, 4> kEyeCorners{33, 133, 362, 263};

  double score = 0.0;              ///< 0 to 1: that the crop shows a face
  std::vector<glm::dvec3> points;  ///< z grows away from the camera, on the scale of x and y

  glm::dvec2 at_px(std::size_t point) const { return glm::dvec2(points[point]); }
  /// The corners of an eye, at the image's left and right.
  /// @param eye  0: the observer's left, at the image's right; 1: right
  std::array<glm::dvec2, 2> corners_px(std::size_t eye) const {
    const std::size_t left = eye == 0 ? 2 : 0;
    return {at_px(kEyeCorners[left]), at_px(kEyeCorners[left + 1])};
  }
  /// The crop in which the network sees this face best.
  Crop crop() const;
};

/// One eye. Each figure is the mean of two runs, of the eye and of its mirror image.
struct EyeInImage {
  glm::dvec2 centre_px{0.0};             ///< of the iris
  double radius_px = 0.0;                ///< of the iris
  double disagreement = 0.0;             ///< between the two centres, iris diameters
  std::array<glm::dvec2, 16> lids_px{};  ///< 0 to 8 along the lower lid, 9 to 15 along the upper
  double opening = 0.0;                  ///< mean distance of the lids over that of the corners
};

class FaceNetworks {
 public:
  /// The user's folder of models: `foci/webcam` in $XDG_DATA_HOME, else in ~/.local/share.
  static std::filesystem::path folder();
  /// The models that are not there.
  static std::vector<std::string> missing();

  /// Absent where a model is missing.
  /// @throws InputError if a file is not the network that its name says
  static std::optional<FaceNetworks> load();
  ~FaceNetworks();
  FaceNetworks(FaceNetworks&& other) noexcept;

  // Images are BGR, 8 bits.

  /// The faces, the largest first. Other things may pass for faces here.
  std::vector<FaceBox> detect(const cv::Mat& image);
  FaceMesh mesh(const cv::Mat& image, const Crop& crop);
  /// The mesh of a face that was just found. The second run sees the crop of the first's mesh.
  FaceMesh mesh(const cv::Mat& image, const FaceBox& face);
  /// The observer's left and right eye, at the same time on two threads.
  std::array<EyeInImage, 2> eyes(const cv::Mat& image, const FaceMesh& mesh);

 private:
  struct Nets;
  explicit FaceNetworks(std::unique_ptr<Nets> nets);
  std::unique_ptr<Nets> nets_;
};

}  // namespace foci
