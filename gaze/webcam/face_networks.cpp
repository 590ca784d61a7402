#include "gaze/webcam/face_networks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "base/file.h"
#include "base/input_error.h"
#include "base/parallel.h"

namespace foci {
namespace {

constexpr int kFacePixels = 256, kMeshPixels = 192, kEyePixels = 64;
constexpr std::array<const char*, 3> kFiles{"blazeface.onnx", "facemesh.onnx", "iris.onnx"};

// Constants of the publications' own programs.
constexpr double kMinScore = 0.5, kMaxOverlap = 0.3;
constexpr double kMeshMargin = 1.5, kEyeMargin = 2.3;

/// The iris of a real face lies higher than the network sees it, in diameters: 0.04 to 0.09, by
/// marks of people. On rendered faces it lies 0.03 lower. A calibration removes the rest.
constexpr double kTooLow = 0.04;

glm::dvec2 turned(const glm::dvec2& v, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * v.x - s * v.y, s * v.x + c * v.y};
}

/// From a point of the crop, whose side has `pixels`, to the image.
glm::dvec2 onImage(const Crop& crop, int pixels, const glm::dvec2& point) {
  return crop.centre_px +
         turned((point / static_cast<double>(pixels) - 0.5) * crop.side_px, crop.angle_rad);
}

/// The crop, resampled to a square of `pixels`. An image that shrinks by more than a half is
/// smoothed first, or points would jump.
cv::Mat cut(const cv::Mat& image, const Crop& crop, int pixels) {
  // A part of the image that holds the crop, so that only this part is smoothed.
  const int reach = static_cast<int>(std::ceil(0.75 * crop.side_px)) + 16;
  const cv::Point centre(static_cast<int>(crop.centre_px.x), static_cast<int>(crop.centre_px.y));
  const cv::Rect part = cv::Rect(centre.x - reach, centre.y - reach, 2 * reach, 2 * reach) &
                        cv::Rect(0, 0, image.cols, image.rows);
  if (part.empty()) return cv::Mat::zeros(pixels, pixels, image.type());
  cv::Mat from = image(part);
  // In OpenCV's coordinates, where pixel centres are whole numbers.
  double scale = pixels / crop.side_px;
  const glm::dvec2 origin =
      0.5 * pixels - 0.5 -
      scale * turned(crop.centre_px - 0.5 - glm::dvec2(part.x, part.y), -crop.angle_rad);
  while (scale < 0.5 && std::min(from.cols, from.rows) > 8) {
    cv::Mat half;
    cv::pyrDown(from, half);
    from = half;
    scale *= 2.0;
  }
  const double c = scale * std::cos(crop.angle_rad), s = scale * std::sin(crop.angle_rad);
  cv::Mat out;
  cv::warpAffine(from, out, cv::Matx23d(c, s, origin.x, -s, c, origin.y), {pixels, pixels});
  return out;
}

double overlap(const FaceBox& a, const FaceBox& b) {
  const auto area = [](const glm::dvec2& size) {
    return std::max(size.x, 0.0) * std::max(size.y, 0.0);
  };
  const double both = area(glm::min(a.max_px, b.max_px) - glm::max(a.min_px, b.min_px));
  return both / (area(a.max_px - a.min_px) + area(b.max_px - b.min_px) - both);
}

/// Centres of the anchors: 16 x 16 cells with two each, then 8 x 8 cells with six each.
std::vector<glm::dvec2> anchors() {
  std::vector<glm::dvec2> centres;
  for (const auto& [cells, count] : {std::pair(16, 2), std::pair(8, 6)}) {
    for (int cell = 0; cell < cells * cells; ++cell) {
      const glm::dvec2 at(cell % cells, cell / cells);
      centres.insert(centres.end(), static_cast<std::size_t>(count),
                     (at + 0.5) * double{kFacePixels} / static_cast<double>(cells));
    }
  }
  return centres;
}

std::array<glm::dvec2, 76> eyePoints(cv::dnn::Net& net, const cv::Mat& square, bool mirrored) {
  cv::Mat seen = square;
  if (mirrored) cv::flip(square, seen, 1);
  net.setInput(cv::dnn::blobFromImage(seen, 1.0 / 255.0, {}, {}, true));
  const cv::Mat out = net.forward();
  std::array<glm::dvec2, 76> points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float* const at = out.ptr<float>() + 3 * i;
    points[i] = {mirrored ? kEyePixels - at[0] : at[0], at[1]};
  }
  return points;
}

/// @param left_px, right_px  the corners of the eye on the image
EyeInImage eyeBetween(cv::dnn::Net& net, const cv::Mat& image, const glm::dvec2& left_px,
                      const glm::dvec2& right_px) {
  const glm::dvec2 along = right_px - left_px;
  const Crop crop{0.5 * (left_px + right_px), std::max(kEyeMargin * glm::length(along), 4.0),
                  std::atan2(along.y, along.x)};
  const cv::Mat square = cut(image, crop, kEyePixels);
  const auto plain = eyePoints(net, square, false);
  const auto mirrored = eyePoints(net, square, true);
  constexpr std::size_t kIris = 71;  // its centre; then four points on its edge
  const auto radius = [](const std::array<glm::dvec2, 76>& p) {
    return 0.25 *
           (glm::distance(p[kIris + 1], p[kIris + 3]) + glm::distance(p[kIris + 2], p[kIris + 4]));
  };
  const double per_pixel = crop.side_px / kEyePixels;
  EyeInImage eye;
  const double radius_crop = 0.5 * (radius(plain) + radius(mirrored));
  eye.radius_px = per_pixel * radius_crop;
  eye.disagreement =
      glm::distance(plain[kIris], mirrored[kIris]) / std::max(2.0 * radius_crop, 1e-3);
  eye.centre_px = onImage(
      crop, kEyePixels,
      0.5 * (plain[kIris] + mirrored[kIris]) - glm::dvec2(0.0, 2.0 * kTooLow * radius_crop));
  for (std::size_t i = 0; i < eye.lids_px.size(); ++i) {
    const std::size_t other = i < 9 ? 8 - i : 24 - i;  // the same point of the mirror image
    eye.lids_px[i] = onImage(crop, kEyePixels, 0.5 * (plain[i] + mirrored[other]));
  }
  double apart = 0.0;
  for (std::size_t i = 1; i < 8; ++i) apart += glm::distance(eye.lids_px[i], eye.lids_px[8 + i]);
  eye.opening = apart / 7.0 / std::max(glm::distance(eye.lids_px[0], eye.lids_px[8]), 1e-3);
  return eye;
}

}  // namespace

struct FaceNetworks::Nets {
  cv::dnn::Net face, mesh;
  std::array<cv::dnn::Net, 2> iris;  // one for each eye
};

FaceNetworks::FaceNetworks(std::unique_ptr<Nets> nets) : nets_(std::move(nets)) {}
FaceNetworks::~FaceNetworks() = default;
FaceNetworks::FaceNetworks(FaceNetworks&& other) noexcept = default;

std::filesystem::path FaceNetworks::folder() {
  return userFolder("XDG_DATA_HOME", ".local/share").value_or(".local/share") / "foci" / "webcam";
}

std::vector<std::string> FaceNetworks::missing() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const char* name : kFiles) {
    if (!std::filesystem::is_regular_file(folder() / name, ignored)) names.emplace_back(name);
  }
  return names;
}

std::optional<FaceNetworks> FaceNetworks::load() {
  if (!missing().empty()) return std::nullopt;
  // The layers of these networks are too small for OpenCV's threads, which only take time.
  cv::setNumThreads(1);
  auto nets = std::make_unique<Nets>();
  const std::array<cv::dnn::Net*, 4> all{&nets->face, &nets->mesh, &nets->iris[0], &nets->iris[1]};
  const std::array<int, 4> pixels{kFacePixels, kMeshPixels, kEyePixels, kEyePixels};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::filesystem::path file = folder() / kFiles[std::min(i, kFiles.size() - 1)];
    try {
      *all[i] = cv::dnn::readNetFromONNX(file.string());
      all[i]->setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
      all[i]->setInput(cv::dnn::blobFromImage(cv::Mat::zeros(pixels[i], pixels[i], CV_8UC3)));
      all[i]->forward();
    } catch (const cv::Exception&) {
      throw InputError(file.string(),
                       "is no network of the webcam tracker; app/webcam_models.sh gets it again");
    }
  }
  return FaceNetworks(std::move(nets));
}

Crop FaceMesh::crop() const {
  const glm::dvec2 along = at_px(kEyeCorners[3]) - at_px(kEyeCorners[0]);
  const double angle_rad = std::atan2(along.y, along.x);
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const glm::dvec3& point : points) {
    const glm::dvec2 upright = turned(glm::dvec2(point), -angle_rad);
    low = glm::min(low, upright);
    high = glm::max(high, upright);
  }
  return {turned(0.5 * (low + high), angle_rad),
          kMeshMargin * std::max(high.x - low.x, high.y - low.y), angle_rad};
}

std::vector<FaceBox> FaceNetworks::detect(const cv::Mat& image) {
  static const std::vector<glm::dvec2> kAnchors = anchors();
  const double scale = double{kFacePixels} / std::max(image.cols, image.rows);
  const cv::Size size(std::max(1, static_cast<int>(std::lround(scale * image.cols))),
                      std::max(1, static_cast<int>(std::lround(scale * image.rows))));
  cv::Mat square = cv::Mat::zeros(kFacePixels, kFacePixels, CV_8UC3), part = square({{0, 0}, size});
  cv::resize(image, part, size, 0.0, 0.0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  nets_->face.setInput(
      cv::dnn::blobFromImage(square, 1.0 / 127.5, {}, cv::Scalar::all(127.5), true));
  std::vector<cv::Mat> out;
  const std::vector<cv::String> names{"classificators_1", "classificators_2", "regressors_1",
                                      "regressors_2"};
  nets_->face.forward(out, names);
  struct Found {
    FaceBox box;
    double score;
  };
  std::vector<Found> found;
  const std::size_t first = out[0].total();
  for (std::size_t i = 0; i < kAnchors.size(); ++i) {
    const bool coarse = i >= first;
    const std::size_t at = coarse ? i - first : i;
    const double score = 1.0 / (1.0 + std::exp(-double{out[coarse ? 1 : 0].ptr<float>()[at]}));
    if (!(score > kMinScore)) continue;
    const float* const r = out[coarse ? 3 : 2].ptr<float>() + 16 * at;
    const auto pair = [&](int k) { return glm::dvec2(r[2 * k], r[2 * k + 1]); };
    const glm::dvec2 centre = kAnchors[i] + pair(0), half = 0.5 * pair(1);
    found.push_back({{(centre - half) / scale,
                      (centre + half) / scale,
                      {(kAnchors[i] + pair(2)) / scale, (kAnchors[i] + pair(3)) / scale}},
                     score});
  }
  std::ranges::stable_sort(found, std::greater(), &Found::score);
  std::vector<FaceBox> faces;
  for (const Found& each : found) {
    if (!(each.box.side_px() > 1.0)) continue;
    if (std::ranges::none_of(
            faces, [&](const FaceBox& f) { return overlap(f, each.box) > kMaxOverlap; })) {
      faces.push_back(each.box);
    }
  }
  std::ranges::stable_sort(faces, std::greater(), &FaceBox::side_px);
  return faces;
}

FaceMesh FaceNetworks::mesh(const cv::Mat& image, const Crop& crop) {
  const cv::Mat square = cut(image, crop, kMeshPixels);
  nets_->mesh.setInput(cv::dnn::blobFromImage(square, 1.0 / 255.0, {}, {}, true));
  std::vector<cv::Mat> out;
  nets_->mesh.forward(out, std::vector<cv::String>{"output_faceflag", "output_mesh"});
  FaceMesh mesh{out[0].ptr<float>()[0], {}};
  mesh.points.reserve(FaceMesh::kPoints);
  for (std::size_t i = 0; i < FaceMesh::kPoints; ++i) {
    const float* const p = out[1].ptr<float>() + 3 * i;
    mesh.points.emplace_back(onImage(crop, kMeshPixels, {p[0], p[1]}),
                             p[2] * crop.side_px / kMeshPixels);
  }
  return mesh;
}

FaceMesh FaceNetworks::mesh(const cv::Mat& image, const FaceBox& face) {
  const glm::dvec2 along = face.eyes_px[1] - face.eyes_px[0];
  const FaceMesh rough =
      mesh(image, Crop{0.5 * (face.min_px + face.max_px), kMeshMargin * face.side_px(),
                       std::atan2(along.y, along.x)});
  const Crop better = rough.crop();
  return better.side_px > 8.0 ? mesh(image, better) : rough;
}

std::array<EyeInImage, 2> FaceNetworks::eyes(const cv::Mat& image, const FaceMesh& mesh) {
  std::array<EyeInImage, 2> both;
  parallelFor(both.size(), [&](std::size_t i) {
    const auto [left_px, right_px] = mesh.corners_px(i);
    both[i] = eyeBetween(nets_->iris[i], image, left_px, right_px);
  });
  return both;
}

}  // namespace foci
