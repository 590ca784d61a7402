#include "app/graphics/video_writer.h"

#include <array>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "app/platform/machine.h"
#include "app/platform/shell.h"
#include "base/file.h"
#include "base/media.h"
#include "base/parallel.h"
#include "base/text.h"

namespace foci {

namespace {

/// Pipes the frames to the program ffmpeg.
class PipeEncoder : public VideoEncoder {
 public:
  bool open(const std::string& file, int columns, int rows, double fps) override {
    if (std::system("ffmpeg -hide_banner -encoders 2>/dev/null | grep -q libx264") != 0)
      return false;
    return pipe_.open("exec ffmpeg -loglevel quiet -y -f rawvideo -pix_fmt rgb24 -s " +
                      std::to_string(columns) + "x" + std::to_string(rows) + " -r " +
                      exactText(fps) + " -i - -c:v libx264 -threads 1 -pix_fmt yuv420p -f mp4 " +
                      shellWord(std::filesystem::absolute(file).string()));
  }
  bool write(std::span<std::uint8_t> rgb) override { return pipe_.write(rgb.data(), rgb.size()); }
  void close() override { pipe_.close(); }

 private:
  ShellPipe pipe_;
};

constexpr std::size_t kMaxWaiting = 4;

/// Why ffmpeg did not open the file, which it does not say. It writes the head of the file at once,
/// so a small write meets a full disk, too.
std::string whyNotOpened(const std::filesystem::path& file) {
  constexpr std::size_t kProbe_B = 64 << 10;
  std::string why = "cannot write H.264 video to " + file.string() + ": " +
                    (media() ? "OpenCV's ffmpeg has no encoder for it"
                             : "install the program ffmpeg, with libx264");
  try {
    writeText(file, std::string(kProbe_B, '\0'));
  } catch (const std::runtime_error& error) {
    why = error.what();
  }
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  return why;
}

}  // namespace

struct VideoWriter::Worker {
  std::string file;
  std::unique_ptr<VideoEncoder> encoder =
      media() ? media()->newEncoder() : std::make_unique<PipeEncoder>();
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Image> waiting;
  bool finished = false;
  bool failed = false;
  std::thread thread;  ///< none: `push` encodes

  /// @return false if encoding fails
  bool encode(Image& image) {
    try {
      return encoder->write(image.rgb);
    } catch (const std::exception&) {
      return false;
    }
  }

  void run() {
    for (;;) {
      Image image;
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return !waiting.empty() || finished; });
        if (waiting.empty()) return;
        image = std::move(waiting.front());
        waiting.pop_front();
      }
      changed.notify_all();
      if (encode(image)) continue;
      const std::lock_guard lock(mutex);
      failed = true;
    }
  }

  void stop() {
    if (thread.joinable()) {
      {
        const std::lock_guard lock(mutex);
        finished = true;
      }
      changed.notify_all();
      thread.join();
    }
    encoder->close();
  }

  [[noreturn]] void fail() const {
    throw std::runtime_error("cannot encode video to " + file + ": is the disk full?");
  }
};

bool isWholeMp4(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::uintmax_t at = 0;
  bool indexed = false;
  while (!error && at < size) {
    std::array<unsigned char, 16> head{};
    in.seekg(static_cast<std::streamoff>(at));
    in.read(reinterpret_cast<char*>(head.data()), head.size());
    if (in.gcount() < 8) return false;
    in.clear();
    const auto number = [&](std::size_t from, std::size_t bytes) {
      std::uintmax_t value = 0;
      for (std::size_t i = from; i < from + bytes; ++i) value = value << 8 | head[i];
      return value;
    };
    const std::uintmax_t box = number(0, 4) == 1 ? number(8, 8) : number(0, 4);
    if (box < 8 || box > size - at) return false;
    indexed |= std::string_view(reinterpret_cast<const char*>(head.data()) + 4, 4) == "moov";
    at += box;
  }
  return indexed;
}

VideoWriter::VideoWriter(const std::filesystem::path& file, const glm::ivec2& size_px, double fps)
    : worker_(std::make_unique<Worker>()) {
  worker_->file = file.string();
  {
    // libx264 takes as many threads as the thread that opens it has cores, and writes their number
    // into the file. OpenCV passes it no other number.
    std::optional<OneCore> one_core;
    if (media()) one_core.emplace();  // the program ffmpeg would keep that core
    if (!worker_->encoder->open(worker_->file, size_px.x, size_px.y, fps)) {
      throw std::runtime_error(whyNotOpened(file));
    }
  }
  if (maxThreads() > 1) {
    worker_->thread = std::thread([worker = worker_.get()] { worker->run(); });
  }
}

VideoWriter::~VideoWriter() { worker_->stop(); }

void VideoWriter::push(Image&& image) {
  if (!worker_->thread.joinable()) {
    if (!worker_->encode(image)) worker_->fail();
    return;
  }
  {
    std::unique_lock lock(worker_->mutex);
    worker_->changed.wait(lock,
                          [&] { return worker_->waiting.size() < kMaxWaiting || worker_->failed; });
    if (worker_->failed) worker_->fail();
    worker_->waiting.push_back(std::move(image));
  }
  worker_->changed.notify_all();
}

void VideoWriter::finish() {
  worker_->stop();
  if (worker_->failed || !isWholeMp4(worker_->file)) worker_->fail();
}

}  // namespace foci
