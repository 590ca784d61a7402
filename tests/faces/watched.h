// An observer of known gaze, filmed, and what a webcam tracker makes of the film.
#pragma once

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "gaze/webcam/webcam_record.h"
#include "tests/faces/observer.h"

namespace foci::faces {

inline constexpr double kFilmRate_Hz = 30.0;

struct Watched {
  std::vector<WebcamRecord> records;
  std::vector<Truth> truths;
  std::vector<Moment> moments;
};

/// Films from `from_s` to `to_s`, with eyes that move from target to target.
/// @param colour  frames are BGR, else grey
template <class Tracker>
Watched watch(Tracker& tracker, const Person& person, const Sitting& sitting, double from_s,
              double to_s, double noise, bool colour) {
  const Face face(person);
  const Observer observer(sitting, {{0.0, 0.6, {0.0, 0.0}},
                                    {0.6, 1.2, {0.2, 0.1}},
                                    {1.2, 1.8, {-0.2, -0.1}},
                                    {1.8, 9.0, {0.1, -0.1}}});
  Watched watched;
  Photography how;
  how.noise = noise;
  for (int frame = 0; frame < std::lround((to_s - from_s) * kFilmRate_Hz); ++frame) {
    const Moment moment = observer.at(from_s + frame / kFilmRate_Hz);
    how.seed = static_cast<std::uint32_t>(frame);
    cv::Mat image = face.photograph(moment, how);
    if (!colour) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
    watched.records.push_back(tracker.push(image));
    watched.truths.push_back(face.truthOf(moment, how));
    watched.moments.push_back(moment);
  }
  return watched;
}

/// Share of the frames with open eyes in which both irises are found within 5 % of the
/// interpupillary distance: a quarter of an iris diameter.
inline double shareFound(const Watched& w) {
  int open = 0, good = 0;
  for (std::size_t i = 0; i < w.records.size(); ++i) {
    if (w.truths[i].closed > 0.05) continue;
    ++open;
    bool both = true;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const auto& iris = w.records[i].irises[eye];
      both = both && iris &&
             glm::distance(iris->centre_px, w.truths[i].iris_px[eye]) <
                 0.05 * w.truths[i].eyeDistance_px();
    }
    good += both;
  }
  return static_cast<double>(good) / open;
}

}  // namespace foci::faces
