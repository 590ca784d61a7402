// The GPU: an OpenGL 4.5 context without a window, and its programs.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

namespace foci {

/// The GPU cannot do what was asked: one line that says what is missing.
class GpuError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One OpenGL context, opened through EGL, so that it needs neither a display nor a window. Any
/// thread may use it, one at a time (`Use`).
class GpuDevice {
 public:
  enum class Kind { hardware, any };
  /// Opens the first hardware device that has OpenGL 4.5; for `any`, or else the software driver,
  /// which renders on the CPU and far slower than the CPU's own code. Throws GpuError if there is
  /// none.
  static std::shared_ptr<GpuDevice> open(Kind kind);
  ~GpuDevice();
  GpuDevice(const GpuDevice&) = delete;
  GpuDevice& operator=(const GpuDevice&) = delete;

  /// "NAME, driver VERSION".
  std::string text() const { return name_ + ", driver " + driver_; }
  const std::string& name() const { return name_; }      ///< as the driver calls the GPU
  const std::string& driver() const { return driver_; }  ///< the driver's version
  bool isSoftware() const { return software_; }          ///< the driver renders on the CPU
  std::size_t maxBuffer_bytes() const { return max_buffer_bytes_; }

  /// Makes the context current in this thread while it lives, and keeps other threads out.
  class Use {
   public:
    explicit Use(GpuDevice& device);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    GpuDevice& device_;
    std::lock_guard<std::mutex> lock_;
  };

  /// The program of the compute shader `stage`, a file of shaders/ without its ending. Compiled
  /// once. Needs a `Use`. Throws GpuError with the compiler's first line.
  /// @param defines  lines that choose its variant
  unsigned program(const std::string& stage, const std::string& defines = {});

 private:
  GpuDevice() = default;

  void* display_ = nullptr;
  void* context_ = nullptr;
  std::string name_, driver_;
  bool software_ = false;
  std::size_t max_buffer_bytes_ = 0;
  std::mutex in_use_;
  std::map<std::string, unsigned> programs_;
};

}  // namespace foci
