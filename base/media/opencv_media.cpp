#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "base/media.h"

namespace foci {
namespace {

class OpenCvReader : public VideoReader {
 public:
  bool openCamera(int number) override { return capture().open(number, cv::CAP_V4L2); }
  bool open(const std::string& file) override { return capture().open(file, cv::CAP_FFMPEG); }
  bool grab() override { return capture().grab(); }
  bool retrieve(cv::Mat& frame) override { return capture().retrieve(frame); }
  bool hasFrame() override {
    constexpr int kAtOnce_ns = 1;
    std::vector<int> ready;
    return cv::VideoCapture::waitAny(captures_, ready, kAtOnce_ns) && !ready.empty();
  }
  double rate_Hz() const override { return captures_.front().get(cv::CAP_PROP_FPS); }
  double frames() const override { return captures_.front().get(cv::CAP_PROP_FRAME_COUNT); }
  double time_s() const override { return 1e-3 * captures_.front().get(cv::CAP_PROP_POS_MSEC); }

 private:
  cv::VideoCapture& capture() { return captures_.front(); }

  std::vector<cv::VideoCapture> captures_{1};  // one; waitAny takes a vector
};

class OpenCvEncoder : public VideoEncoder {
 public:
  bool open(const std::string& file, int columns, int rows, double fps) override {
    size_ = {columns, rows};
    return writer_.open(file, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), fps,
                        size_);
  }
  bool write(std::span<std::uint8_t> rgb) override {
    cv::cvtColor(cv::Mat(size_, CV_8UC3, rgb.data()), bgr_, cv::COLOR_RGB2BGR);
    writer_.write(bgr_);
    return true;
  }
  void close() override { writer_.release(); }

 private:
  cv::VideoWriter writer_;
  cv::Size size_;
  cv::Mat bgr_;
};

cv::Mat readStored(const std::string& file) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);  // NOLINT: OpenCV asks for it when it reads
  try {
    return cv::imread(file, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    return {};
  }
}

std::optional<DecodedImage> decode(std::span<const unsigned char> bytes) {
  try {
    const cv::Mat header(1, static_cast<int>(bytes.size()), CV_8U,
                         const_cast<unsigned char*>(bytes.data()));
    cv::Mat read = cv::imdecode(header, cv::IMREAD_UNCHANGED);
    if (read.empty() || (read.depth() != CV_8U && read.depth() != CV_16U)) return std::nullopt;
    read.convertTo(read, CV_8U, read.depth() == CV_16U ? 1.0 / 257.0 : 1.0);
    const int channels = read.channels();
    if (channels == 2) return std::nullopt;
    cv::cvtColor(read, read,
                 channels == 1   ? cv::COLOR_GRAY2RGBA
                 : channels == 3 ? cv::COLOR_BGR2RGBA
                                 : cv::COLOR_BGRA2RGBA);
    return DecodedImage{
        .columns = read.cols, .rows = read.rows, .rgba = {read.datastart, read.dataend}};
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

}  // namespace
}  // namespace foci

extern "C" {
extern const foci::Media foci_media_1;
const foci::Media foci_media_1{
    .newReader = []() -> std::unique_ptr<foci::VideoReader> {
      return std::make_unique<foci::OpenCvReader>();
    },
    .newEncoder = []() -> std::unique_ptr<foci::VideoEncoder> {
      return std::make_unique<foci::OpenCvEncoder>();
    },
    .isImage = [](const std::string& file) { return cv::haveImageReader(file); },
    .readImage =
        [](const std::string& file) {
          return cv::imread(file, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH);
        },
    .readStored = foci::readStored,
    .decodeImage = foci::decode,
};
}
