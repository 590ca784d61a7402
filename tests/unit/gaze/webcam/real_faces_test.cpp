// The networks on photographs of real faces with marked irises, which are not part of foci:
//
//     FOCI_FACES=DIR foci_tests --gtest_filter='RealFaces.*'
//
// DIR holds the pictures and marks.tsv: file frame state faces face_x face_y ipd left_x left_y
// right_x right_y iris. The state is `open`, `face` (irises not marked), `shut` or `none`; iris is
// a diameter, all in pixels. Skipped without it. The properties go to docs/results.py.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "base/quantile.h"
#include "gaze/webcam/webcam_frames.h"
#include "gaze/webcam/webcam_source.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRight = 0.25;  // an iris is right within this share of itself
constexpr double kDegPerIris = 180.0 / std::numbers::pi * 11.7 / 12.0;  // gaze, a diameter

struct Mark {
  std::string file, state;
  int frame = 0;
  std::array<glm::dvec2, 2> iris_px{};  // left, right
  glm::dvec2 face_px{0.0};
  double ipd_px = 0.0, iris_px_diameter = 0.0;
  cv::Mat image{};
};

class RealFaces : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("FOCI_FACES");
    if (!folder || !FaceNetworks::missing().empty()) {
      GTEST_SKIP() << "needs FOCI_FACES, a folder of marked faces, and sh app/webcam_models.sh";
    }
    folder_ = folder;
    std::ifstream table(folder_ / "marks.tsv");
    std::string line;
    std::getline(table, line);
    while (std::getline(table, line)) {
      std::stringstream row(line);
      std::vector<std::string> cells;
      for (std::string cell; std::getline(row, cell, '\t');) cells.push_back(cell);
      cells.resize(12);
      const auto at = [&](std::size_t i) { return cells[i].empty() ? 0.0 : std::stod(cells[i]); };
      marks_.push_back({.file = cells[0],
                        .state = cells[2],
                        .frame = static_cast<int>(at(1)),
                        .iris_px = {glm::dvec2(at(7), at(8)), glm::dvec2(at(9), at(10))},
                        .face_px = {at(4), at(5)},
                        .ipd_px = at(6),
                        .iris_px_diameter = at(11)});
    }
    ASSERT_FALSE(marks_.empty());
  }

  /// Calls `each(frame, image)` for the frames of a file.
  template <class Each>
  void watch(const std::string& file, const Each& each) const {
    WebcamFrames frames({.file = folder_ / file});
    cv::Mat image;
    for (int frame = 0; frames.next(image); ++frame) each(frame, image);
  }

  /// The marks of open eyes, with their images.
  std::vector<Mark> openEyes() const {
    std::vector<Mark> open;
    for (const Mark& mark : marks_) {
      if (mark.state != "open") continue;
      watch(mark.file, [&](int frame, const cv::Mat& image) {
        if (frame != mark.frame) return;
        open.push_back(mark);
        open.back().image = image.clone();
      });
    }
    return open;
  }

  std::filesystem::path folder_;
  std::vector<Mark> marks_;
};

/// A marked portrait, turned, scaled to an iris of some pixels, and put somewhere else.
struct Moved {
  cv::Mat image;
  std::array<glm::dvec2, 2> iris_px{};
  double angle_rad = 0.0;

  Moved(const Mark& mark, const cv::Size& size, double iris_px_diameter, double angle,
        const glm::dvec2& middle_px)
      : angle_rad(angle) {
    const double s = iris_px_diameter / mark.iris_px_diameter;
    const glm::dvec2 x = s * glm::dvec2(std::cos(angle), std::sin(angle)), y(-x.y, x.x);
    const auto at = [&](const glm::dvec2& px) {
      const glm::dvec2 off = px - mark.face_px;
      return middle_px + off.x * x + off.y * y;
    };
    iris_px = {at(mark.iris_px[0]), at(mark.iris_px[1])};
    // Twice as large first, then the mean of four pixels. OpenCV's pixel centres are whole numbers.
    cv::Mat from = mark.image.clone(), large;
    if (s < 0.5) cv::GaussianBlur(from, from, {}, 0.3 / s);
    const glm::dvec2 origin = 2.0 * at({0.5, 0.5}) - 0.5;
    cv::warpAffine(from, large, cv::Matx23d(2 * x.x, 2 * y.x, origin.x, 2 * x.y, 2 * y.y, origin.y),
                   size * 2, cv::INTER_CUBIC, cv::BORDER_CONSTANT);
    cv::resize(large, image, size, 0.0, 0.0, cv::INTER_AREA);
  }
};

void addNoise(cv::Mat& image, double sd, cv::RNG& random) {
  cv::Mat noise(image.size(), CV_16SC3), sum;
  random.fill(noise, cv::RNG::NORMAL, 0.0, sd);
  cv::add(image, noise, sum, cv::noArray(), CV_16S);
  sum.convertTo(image, CV_8U);
}

TEST_F(RealFaces, AreFoundAndTheirIrises) {
  for (const bool video : {false, true}) {
    std::map<std::string, int> count;
    std::vector<double> errors;
    std::map<std::string, std::vector<Mark>> files;
    for (const Mark& mark : marks_) {
      if (mark.file.ends_with(".mp4") == video) files[mark.file].push_back(mark);
    }
    for (const auto& [file, marks] : files) {
      WebcamTracker tracker;
      const std::vector<Mark>& of = marks;
      watch(file, [&](int frame, const cv::Mat& image) {
        const WebcamRecord record = tracker.push(image);
        for (const Mark& mark : of) {
          if (mark.frame != frame) continue;
          const bool there = mark.state != "none";
          ++count[there ? "faces" : "without_face"];
          count[there ? "found" : "false_faces"] +=
              record.face &&
              (!there || glm::distance(record.eyes_px, mark.face_px) < 0.5 * mark.ipd_px);
          for (std::size_t eye = 0; eye < 2; ++eye) {
            const auto& iris = record.irises[eye];
            if (mark.state == "shut") {
              ++count["shut"];
              count["irises_in_shut"] += iris.has_value();
            }
            if (mark.state != "open") continue;
            ++count["irises"];
            if (!iris) continue;
            errors.push_back(glm::distance(iris->centre_px, mark.iris_px[eye]) /
                             mark.iris_px_diameter);
            ++count[errors.back() < kRight ? "right" : "wrong"];
          }
        }
      });
    }
    const std::string kind = video ? "video_" : "photographs_";
    for (const auto& [name, value] : count) RecordProperty(kind + name, value);
    if (errors.empty()) continue;
    RecordProperty(kind + "median_error", std::to_string(quantile(errors, 0.5)));
    EXPECT_EQ(count["found"], count["faces"]);
    EXPECT_EQ(count["false_faces"], 0);
    EXPECT_GE(count["right"], 0.95 * count["irises"]);
    EXPECT_LE(count["wrong"], 0.02 * count["irises"]);
    EXPECT_LE(count["irises_in_shut"], 0.1 * count["shut"]);
  }
}

TEST_F(RealFaces, MovedAboutTheirIrisesHaveLittleScatter) {
  constexpr int kMoves = 24;
  cv::RNG random(7);
  int both = 0, all = 0;
  glm::dvec2 sum2(0.0);
  double count = 0.0;
  std::map<std::string, int> portraits;
  for (const Mark& mark : openEyes()) {
    // Irises that need no more than a little enlargement, every other marked frame of a video.
    if (mark.iris_px_diameter < 11.0 || portraits[mark.file]++ % 2 == 1) continue;
    WebcamTracker tracker;
    std::array<std::vector<glm::dvec2>, 2> off;
    for (int move = 0; move < kMoves; ++move) {
      const glm::dvec2 middle_px(320.0 + random.uniform(-45.0, 45.0),
                                 216.0 + random.uniform(-45.0, 45.0));
      Moved moved(mark, {640, 480}, 12.0 * random.uniform(0.92, 1.08), random.uniform(-0.14, 0.14),
                  middle_px);
      addNoise(moved.image, 2.0, random);
      const WebcamRecord record = tracker.push(moved.image);
      int right = 0;
      for (std::size_t eye = 0; eye < 2; ++eye) {
        if (!record.irises[eye]) continue;
        const glm::dvec2 image = (record.irises[eye]->centre_px - moved.iris_px[eye]) / 12.0;
        const double c = std::cos(moved.angle_rad), s = std::sin(moved.angle_rad);
        const glm::dvec2 upright(c * image.x + s * image.y, -s * image.x + c * image.y);
        if (glm::length(upright) >= kRight) continue;
        off[eye].push_back(upright);
        ++right;
      }
      both += right == 2;
      ++all;
    }
    for (const auto& each : off) {
      glm::dvec2 mean(0.0);
      for (const glm::dvec2& one : each) mean += one / static_cast<double>(each.size());
      for (const glm::dvec2& one : each) sum2 += (one - mean) * (one - mean);
      count += static_cast<double>(each.size());
    }
  }
  const glm::dvec2 scatter_deg = kDegPerIris * glm::sqrt(sum2 / count);
  RecordProperty("moved_both_right", std::to_string(100.0 * both / all));
  RecordProperty("moved_scatter_across_deg", std::to_string(scatter_deg.x));
  RecordProperty("moved_scatter_down_deg", std::to_string(scatter_deg.y));
  EXPECT_GE(both, 0.98 * all);
  EXPECT_LE(scatter_deg.x, 0.45);
  EXPECT_LE(scatter_deg.y, 0.5);
}

/// An iris of a portrait that was made worse.
struct Judged {
  double disagreement = 0.0;
  bool right = false;
};

struct Curve {
  double best = 0.0, middle = 0.0, power = 0.0;
  double operator()(double d) const { return best / (1.0 + std::pow(d / middle, power)); }
};

/// Of the largest likelihood, on a grid.
Curve fitCurve(const std::map<std::string, std::vector<Judged>>& files,
               const std::string& without) {
  Curve best;
  double most = -1e300;
  for (double top = 0.95; top < 0.995; top += 0.01) {
    for (double middle = 0.3; middle < 0.9; middle += 0.02) {
      for (double power = 1.0; power < 4.6; power += 0.25) {
        const Curve curve{top, middle, power};
        double likelihood = 0.0;
        for (const auto& [file, irises] : files) {
          if (file == without) continue;
          for (const Judged& iris : irises) {
            const double p = std::clamp(curve(iris.disagreement), 1e-3, 1.0 - 1e-3);
            likelihood += std::log(iris.right ? p : 1.0 - p);
          }
        }
        if (likelihood > most) {
          most = likelihood;
          best = curve;
        }
      }
    }
  }
  return best;
}

TEST_F(RealFaces, ConfidenceIsTheShareOfRightIrises) {
  auto networks = FaceNetworks::load();
  cv::RNG random(5);
  std::map<std::string, std::vector<Judged>> files;
  std::map<std::string, int> portraits;
  for (const Mark& mark : openEyes()) {
    if (++portraits[mark.file] > 6) continue;
    for (int i = 0; i < (mark.file.ends_with(".mp4") ? 20 : 100); ++i) {
      constexpr std::array<double, 5> kSizes{3.5, 5.0, 7.0, 9.0, 12.0};
      const double iris_px = std::min(kSizes[static_cast<std::size_t>(random.uniform(0, 5))],
                                      1.5 * mark.iris_px_diameter);
      const cv::Size size(cvRound(26 * iris_px), cvRound(24 * iris_px));
      Moved worse(mark, size, iris_px, random.uniform(-0.26, 0.26),
                  0.5 * glm::dvec2(size.width, size.height));
      const auto half = [&] { return random.uniform(0.0, 1.0) < 0.5; };
      if (half()) {
        cv::GaussianBlur(worse.image, worse.image, {}, random.uniform(0.05, 0.35) * iris_px);
      }
      if (half()) worse.image *= random.uniform(0.12, 0.6);
      addNoise(worse.image, random.uniform(1.0, 14.0), random);
      if (half()) {
        const glm::dvec2 at = worse.iris_px[half() ? 0 : 1];
        const double x = at.x + random.gaussian(0.6 * iris_px);
        const double y = at.y + random.gaussian(0.6 * iris_px);
        cv::ellipse(worse.image, cv::Point(cvRound(x), cvRound(y)),
                    cv::Size(cvRound(iris_px * random.uniform(0.3, 1.2)),
                             cvRound(iris_px * random.uniform(0.15, 0.6))),
                    random.uniform(-30.0, 30.0), 0.0, 360.0,
                    cv::Scalar::all(random.uniform(0.0, 250.0)), cv::FILLED);
      }
      const auto boxes = networks->detect(worse.image);
      if (boxes.empty()) continue;
      const FaceMesh mesh = networks->mesh(worse.image, boxes.front());
      if (mesh.score < 0.5) continue;
      const auto eyes = networks->eyes(worse.image, mesh);
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const double off_px = glm::distance(eyes[eye].centre_px, worse.iris_px[eye]);
        files[mark.file].push_back({eyes[eye].disagreement, off_px < kRight * iris_px});
      }
    }
  }
  // Each file is judged by a curve that was fitted to the other files.
  constexpr std::array<double, 7> kBins{0.0, 0.5, 0.7, 0.85, 0.92, 0.97, 1.0};
  std::array<glm::dvec3, kBins.size() - 1> bins{};  // confidence, right, count
  for (const auto& [file, irises] : files) {
    const Curve curve = fitCurve(files, file);
    for (const Judged& iris : irises) {
      const double confidence = curve(iris.disagreement);
      std::size_t bin = 0;
      while (confidence >= kBins[bin + 1]) ++bin;
      bins[bin] += glm::dvec3(confidence, iris.right ? 1.0 : 0.0, 1.0);
    }
  }
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (bins[i].z < 50.0) continue;
    const double confidence = bins[i].x / bins[i].z, right = bins[i].y / bins[i].z;
    RecordProperty("confidence_" + std::to_string(i),
                   std::to_string(confidence) + " " + std::to_string(right) + " " +
                       std::to_string(static_cast<int>(bins[i].z)));
    EXPECT_NEAR(confidence, right, 0.1) << bins[i].z;
  }
  const Curve all = fitCurve(files, "");
  RecordProperty("confidence_curve", std::to_string(all.best) + " " + std::to_string(all.middle) +
                                         " " + std::to_string(all.power));
}

}  // namespace FOCI_FILE
}  // namespace foci
