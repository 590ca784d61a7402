#include "tests/faces/film.h"

#include <opencv2/videoio.hpp>
#include <stdexcept>

namespace foci::faces {

std::vector<Truth> film(const std::filesystem::path& file, const Face& face, double rate_Hz,
                        double to_s, Photography how,
                        const std::function<std::optional<Moment>(double time_s)>& at) {
  const cv::Size size(how.size_px.x, how.size_px.y);
  cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('a', 'v', 'c', '1'), rate_Hz, size);
  if (!video.isOpened()) throw std::runtime_error(file.string() + ": cannot be written");
  const cv::Mat nobody(size, CV_8UC3, cv::Scalar::all(90));
  std::vector<Truth> truths;
  for (how.seed = 0; how.seed < to_s * rate_Hz - 0.5; ++how.seed) {
    const auto moment = at(how.seed / rate_Hz);
    video.write(moment ? face.photograph(*moment, how) : nobody);
    truths.push_back(moment ? face.truthOf(*moment, how) : Truth{});
  }
  return truths;
}

}  // namespace foci::faces
