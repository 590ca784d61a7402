// The GPU: an OpenGL 4.5 context that one thread at a time makes current, its programs, and the
// stages of a frame with their times.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// The names of a context's parts in its window system, for libraries that draw for foci.
struct NativeGl {
  bool egl = false;  ///< of EGL; else of GLX
  void *display = nullptr, *config = nullptr, *context = nullptr;
  unsigned long drawable = 0;  ///< of GLX, as is the visual
  unsigned visual = 0;
};

class GpuContext {
 public:
  GpuContext() = default;
  virtual ~GpuContext() = default;
  GpuContext(const GpuContext&) = delete;
  GpuContext& operator=(const GpuContext&) = delete;

  /// @return false: it is lost, or the thread has another context that cannot be replaced
  virtual bool makeCurrent() = 0;
  /// The thread has the context that it had before `makeCurrent`.
  virtual void release() = 0;
  virtual NativeGl native() const { return {}; }
};

/// Opens contexts through EGL, which need neither a display nor a window, one after the other until
/// `wants` keeps one. They have OpenGL 4.5 or newer where the driver has it.
/// @param software  also contexts of drivers that render on the CPU
/// @param wants     moves from the context to keep it; returns whether to go on
void openEglContexts(bool software, const std::function<bool(std::unique_ptr<GpuContext>&)>& wants);

struct GpuImageBuffers;
struct GpuTextureStorage;

/// The GPU cannot render this; the text is one line and names what is missing.
class GpuError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One OpenGL context. Any thread may use it, one at a time (`Use`).
class GpuDevice {
 public:
  enum class Kind { hardware, any };
  /// Opens the first hardware device that has OpenGL 4.5, through EGL; for `any`, or else the
  /// software driver, which renders on the CPU and far slower than the CPU's own code. Throws
  /// GpuError if there is none.
  static std::shared_ptr<GpuDevice> open(Kind kind);
  /// A device that renders in this context. Throws GpuError where it cannot.
  explicit GpuDevice(std::unique_ptr<GpuContext> context);
  ~GpuDevice();
  GpuDevice(const GpuDevice&) = delete;
  GpuDevice& operator=(const GpuDevice&) = delete;

  /// "NAME, driver VERSION".
  std::string text() const { return name_ + ", driver " + driver_; }
  const std::string& name() const { return name_; }      ///< as the driver calls the GPU
  const std::string& driver() const { return driver_; }  ///< the driver's version
  bool isSoftware() const { return software_; }          ///< the driver renders on the CPU
  /// Bytes of a buffer that a shader can address.
  std::size_t maxBlock_bytes() const { return max_block_bytes_; }
  /// Where such a window may begin: at multiples of this.
  std::size_t blockAlignment_bytes() const { return block_alignment_bytes_; }
  /// Allows less than the driver does.
  void limitBlocks(std::size_t bytes) { max_block_bytes_ = std::min(max_block_bytes_, bytes); }

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

  /// Throws GpuError where the driver reports an error or a lost context. Needs a `Use`.
  void check() const;

  /// Does `action` at the next `Use`: destructors, which have none, free memory so. Never waits.
  void later(std::function<void()> action);

 private:
  std::unique_ptr<GpuContext> context_;
  std::string name_, driver_;
  bool software_ = false;
  std::size_t max_block_bytes_ = 0, block_alignment_bytes_ = 1;
  std::mutex in_use_;
  std::map<std::string, unsigned> programs_;
  std::mutex later_mutex_;
  std::vector<std::function<void()>> later_;

 public:
  // What image.cpp and texture.cpp keep to use again. Last: their destructors call `later`.
  std::mutex pool_mutex;
  std::vector<std::shared_ptr<GpuImageBuffers>> image_pool;
  std::vector<std::shared_ptr<GpuTextureStorage>> texture_pool;
};

/// In their order. `present` interpolates the samples to pixels; reading the frame back is not in
/// it.
enum class GpuStage : std::uint8_t { cut, project, bin, sort, composite, present };
inline constexpr std::array<std::string_view, 6> kGpuStages{"cut",  "project",   "bin",
                                                            "sort", "composite", "present"};

/// The device's times of a frame, ms, by `GpuStage`.
struct GpuTimes {
  std::array<double, kGpuStages.size()> stage_ms{};

  void operator+=(const GpuTimes& other) {
    for (std::size_t s = 0; s < stage_ms.size(); ++s) stage_ms.at(s) += other.stage_ms.at(s);
  }
};

}  // namespace foci
