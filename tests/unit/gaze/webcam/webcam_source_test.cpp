#include "gaze/webcam/webcam_source.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "base/input_error.h"
#include "tests/faces/face.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

/// Numbered images of a person who looks farther aside in each one.
class Images {
 public:
  explicit Images(int count)
      : folder_(std::filesystem::temp_directory_path() /
                ("foci_images_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    const faces::Face face(faces::somebody(1));
    for (int i = 0; i < count; ++i) {
      const faces::Moment moment{.head_m = {0.0, 0.05, 0.5}, .looks_at_m = {0.03 * i, 0.1, 0.0}};
      char name[40];
      std::snprintf(name, sizeof name, "eye%03d.png", i);
      cv::imwrite(folder_ / name, face.photograph(moment, faces::Photography{}));
    }
  }
  ~Images() { std::filesystem::remove_all(folder_); }
  Images(const Images&) = delete;
  Images& operator=(const Images&) = delete;
  WebcamPlace place() const { return {.file = folder_ / "eye%03d.png"}; }

 private:
  std::filesystem::path folder_;
};

TEST(WebcamPlaceOf, KnowsCamerasFilesAndNone) {
  EXPECT_FALSE(webcamPlaceOf("mouse"));
  EXPECT_FALSE(webcamPlaceOf("webcamera.tsv"));
  EXPECT_EQ(webcamPlaceOf("webcam")->device, 0);
  EXPECT_EQ(webcamPlaceOf("webcam:2")->device, 2);
  EXPECT_EQ(webcamPlaceOf("webcam:2.mp4")->file, "2.mp4");
  EXPECT_FALSE(webcamPlaceOf("webcam:2.mp4")->device);
  EXPECT_THROW(webcamPlaceOf("webcam:"), InputError);
  EXPECT_THROW(webcamPlaceOf("webcam:-1"), InputError);
  EXPECT_THROW(webcamPlaceOf("webcam:99"), InputError);
}

TEST(WebcamSource, PlaysImagesInRealTime) {
  const Images images(4);
  // A map that returns the features.
  const WebcamMapping map = [](const WebcamView& view) {
    return WebcamGaze{.point_px = 1000.0 * view.eye, .uncertainty_deg = 1.2};
  };
  WebcamSource source(images.place(), WebcamTracker(), map);
  EXPECT_EQ(source.rate_Hz(), 30.0);
  std::vector<GazeSample> samples;
  source.poll(10.0, samples);
  ASSERT_EQ(samples.size(), 1u);  // the first poll gives the first frame
  EXPECT_EQ(samples[0].time_s, 10.0);
  source.poll(10.01, samples);
  EXPECT_EQ(samples.size(), 1u);
  source.poll(10.07, samples);
  EXPECT_EQ(samples.size(), 3u);
  source.poll(11.0, samples);
  ASSERT_EQ(samples.size(), 4u);
  EXPECT_TRUE(source.ended());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i].time_s, 10.0 + static_cast<double>(i) / 30.0, 1e-9);
    ASSERT_TRUE(samples[i].point_px) << i;
    EXPECT_EQ(samples[i].uncertainty_deg, 1.2);
    EXPECT_GT(samples[i].confidence, 0.2);
    EXPECT_FALSE(samples[i].blink);
  }
  // The image's right is the observer's left.
  EXPECT_LT(samples[3].point_px->x, samples[0].point_px->x - 20.0);
  const auto frames = source.takeFrames();
  EXPECT_EQ(frames.size(), 4u);
  EXPECT_TRUE(source.takeFrames().empty());
}

TEST(WebcamSource, GivesFeaturesWithoutACalibrationAndSaysSo) {
  const Images images(1);
  WebcamSource source(images.place(), WebcamTracker(), {});
  std::vector<GazeSample> samples;
  source.poll(0.0, samples);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_FALSE(samples[0].point_px);
  const auto frames = source.takeFrames();
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].record.view);
  EXPECT_NE(source.status().find("not calibrated"), std::string::npos);
}

/// An element of Matroska: its identifier, its length in eight bytes, its content.
std::string element(const std::string& id, const std::string& content) {
  std::string length = "\x01";
  for (int shift = 48; shift >= 0; shift -= 8) {
    length += static_cast<char>(static_cast<unsigned char>(content.size() >> shift));
  }
  return id + length + content;
}

std::string bigEndian(unsigned value, int bytes) {
  std::string text;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    text += static_cast<char>(static_cast<unsigned char>(value >> shift));
  }
  return text;
}

/// A video of JPEG images with these times, milliseconds.
std::string matroska(const std::vector<unsigned>& times_ms) {
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", cv::Mat(160, 160, CV_8UC3, cv::Scalar(90, 90, 90)), jpeg);
  const std::string image(jpeg.begin(), jpeg.end());
  const std::string video = element("\xb0", bigEndian(160, 2)) + element("\xba", bigEndian(160, 2));
  const std::string track = element("\xd7", "\x01") + element("\x73\xc5", "\x01") +
                            element("\x83", "\x01") + element("\x86", "V_MJPEG") +
                            element("\xe0", video);
  std::string cluster = element("\xe7", bigEndian(0, 2));
  for (const unsigned time_ms : times_ms) {
    cluster += element("\xa3", "\x81" + bigEndian(time_ms, 2) + "\x80" + image);
  }
  const std::string info = element("\x2a\xd7\xb1", bigEndian(1'000'000, 4));
  return element("\x1a\x45\xdf\xa3", element("\x42\x82", "matroska")) +
         element("\x18\x53\x80\x67", element("\x15\x49\xa9\x66", info) +
                                         element("\x16\x54\xae\x6b", element("\xae", track)) +
                                         element("\x1f\x43\xb6\x75", cluster));
}

TEST(WebcamFrames, AVideoOfVaryingRateHasTheTimesOfItsStamps) {
  // 30 Hz, then 12.5 Hz as the light fades, then a pause.
  std::vector<unsigned> times_ms;
  for (unsigned i = 0; i < 30; ++i) times_ms.push_back(33 * i + i / 3);
  for (unsigned i = 1; i <= 30; ++i) times_ms.push_back(967 + 80 * i + (i > 20 ? 1500 : 0));
  const auto file = std::filesystem::temp_directory_path() /
                    ("foci_varying_" + std::to_string(getpid()) + ".mkv");
  std::ofstream(file, std::ios::binary) << matroska(times_ms);
  WebcamFrames frames({.file = file});
  cv::Mat grey;
  constexpr double kRounding_s = 2.001e-3;  // before the rate is known to vary
  for (const unsigned time_ms : times_ms) {
    const auto time_s = frames.nextTime_s();
    ASSERT_TRUE(time_s);
    EXPECT_NEAR(*time_s, 1e-3 * time_ms, kRounding_s);
    ASSERT_TRUE(frames.next(grey));
    EXPECT_EQ(grey.rows, 160);
  }
  EXPECT_FALSE(frames.nextTime_s());
  std::filesystem::remove(file);
}

/// Numbered images of 160 x 120 px, written as they are given.
class Numbered {
 public:
  Numbered(const std::string& extension, const std::vector<cv::Mat>& images)
      : folder_(std::filesystem::temp_directory_path() /
                ("foci_numbered_" + std::to_string(getpid()))),
        extension_(extension) {
    std::filesystem::create_directories(folder_);
    for (std::size_t i = 0; i < images.size(); ++i) cv::imwrite(file(i).string(), images[i]);
  }
  ~Numbered() { std::filesystem::remove_all(folder_); }
  Numbered(const Numbered&) = delete;
  Numbered& operator=(const Numbered&) = delete;
  std::filesystem::path file(std::size_t i) const {
    return folder_ / ("a" + std::to_string(i + 1) + extension_);
  }
  WebcamPlace pattern() const { return {.file = folder_ / ("a%d" + extension_)}; }

 private:
  std::filesystem::path folder_;
  std::string extension_;
};

TEST(WebcamFrames, DepthAndTransparencyDoNotChangeAPicture) {
  cv::Mat plain(120, 160, CV_8UC3, cv::Scalar(40, 90, 200)), deep, clear;
  plain.convertTo(deep, CV_16U, 257.0);
  cv::cvtColor(plain, clear, cv::COLOR_BGR2BGRA);
  clear.forEach<cv::Vec4b>([](cv::Vec4b& px, const int*) { px[3] = 0; });
  const Numbered images(".png", {plain, deep, clear});
  for (const WebcamPlace& place : {images.pattern(), WebcamPlace{.file = images.file(1)},
                                   WebcamPlace{.file = images.file(2)}}) {
    WebcamFrames frames(place);
    EXPECT_EQ(frames.isPicture(), place.file != images.pattern().file);
    cv::Mat image;
    int count = 0;
    while (frames.next(image)) {
      ++count;
      ASSERT_EQ(image.type(), CV_8UC3);
      EXPECT_EQ(cv::norm(image, plain, cv::NORM_INF), 0.0);
    }
    EXPECT_EQ(count, frames.isPicture() ? 1 : 3);
  }
}

TEST(WebcamFrames, RefusesImagesThatAreCutOffOrNotWhole) {
  cv::Mat noise(120, 160, CV_8UC3), reals(120, 160, CV_32FC3, cv::Scalar::all(0.5));
  cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 255);
  for (const char* extension : {".png", ".jpg", ".bmp", ".tiff"}) {
    const Numbered images(extension, {noise, noise, noise});
    cv::Mat image;
    WebcamFrames whole(images.pattern());
    while (whole.next(image)) continue;
    std::filesystem::resize_file(images.file(1), std::filesystem::file_size(images.file(1)) / 2);
    WebcamFrames frames(images.pattern());
    EXPECT_TRUE(frames.next(image));
    EXPECT_THROW(frames.next(image), InputError) << extension;
    EXPECT_THROW(WebcamFrames({.file = images.file(1)}).next(image), InputError) << extension;
  }
  const Numbered real(".tiff", {reals});
  cv::Mat image;
  EXPECT_THROW(WebcamFrames(real.pattern()).next(image), InputError);
}

TEST(WebcamFrames, SaysThatAVideoIsCutOff) {
  const auto file =
      std::filesystem::temp_directory_path() / ("foci_cut_" + std::to_string(getpid()) + ".avi");
  {
    cv::VideoWriter video(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0,
                          {160, 120});
    cv::Mat noise(120, 160, CV_8UC3);
    cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 255);
    for (int i = 0; i < 40; ++i) video.write(noise);
  }
  const auto remark = [&] {
    WebcamFrames frames({.file = file});
    cv::Mat image;
    while (frames.next(image)) continue;
    return frames.remark();
  };
  EXPECT_EQ(remark(), "");
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_NE(remark().find("of the 40 frames"), std::string::npos) << remark();
  std::filesystem::remove(file);
}

TEST(WebcamFrames, RefusesFilesThatAreNoVideo) {
  EXPECT_THROW(WebcamFrames({.file = "/nowhere/eye%03d.png"}), InputError);
  EXPECT_THROW(WebcamFrames({.file = "/nowhere/eye.mp4"}), InputError);
  EXPECT_THROW(WebcamFrames({.device = 63}), InputError);
  const ScratchFile empty(""), text("A film has no such first bytes.\n");
  for (const ScratchFile* file : {&empty, &text}) {
    EXPECT_THROW(WebcamFrames({.file = file->path()}), InputError);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
