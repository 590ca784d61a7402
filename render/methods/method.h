// The one interface of every depth-of-field method, and the list of the methods.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "render/gl/device.h"
#include "render/image/frame.h"
#include "render/methods/quality_level.h"
#include "render/optics/acuity.h"
#include "render/optics/colours.h"
#include "render/optics/defocus.h"
#include "render/optics/pupil.h"
#include "render/optics/view.h"
#include "render/scene/scene.h"

namespace foci {

/// When method `auto` measures its errors (spot_check.h).
enum class ErrorCheck : std::uint8_t {
  over_frames,  ///< a part in each frame
  of_still,     ///< now, of the level that a run begins with, and of better ones if it needs them
  at_once,      ///< now, of all levels
};

/// How closely method `auto` renders, and how long it may take. Other methods ignore all of this.
struct Quality {
  /// Error that 95 % of the pixels may have, in just-noticeable differences (metrics.h).
  float tolerance = 1.0f;
  /// Frame-time budget, ms: the error grows as far as the budget requires. The quality level then
  /// depends on the machine, and `RenderStats::quality_level` reports the level. Absent or
  /// infinite: no budget.
  std::optional<float> frame_ms = {};
  /// Detail that the observer resolves; by default full acuity everywhere.
  Acuity acuity = {};
  /// Keep the level of the previous render. For another colour channel or another view of one
  /// frame: a frame has one level.
  bool keep_level = false;
  /// Force this level; nullopt chooses one per frame.
  std::optional<QualityLevel> quality_level = {};
  ErrorCheck check = ErrorCheck::over_frames;
  bool operator==(const Quality&) const = default;
};

struct RenderSettings {
  Defocus defocus;   ///< default: everything sharp
  Pupil pupil = {};  ///< what else the pupil does (`MethodInfo::aberrations`)
  /// If there are any, `Method::render` renders each of them by itself.
  std::vector<Colour> colours = {};
  Lighting lighting = {};
  bool depth = false;  ///< fill Frame::depth_m
  Quality quality = {};
  bool operator==(const RenderSettings&) const = default;
};

/// Cost and quality of one render.
struct RenderStats {
  /// Adds what another render of the same frame cost: another view, or another colour channel. The
  /// error of both is the larger one.
  void add(const RenderStats& other);

  std::uint64_t splats = 0;     ///< rendered, after culling
  std::uint64_t fragments = 0;  ///< kernel evaluations inside a footprint
  double ms = 0.0;              ///< wall time
  /// Of a reference method: the PSNR between two halves of its samples. No PSNR against this
  /// reference can be trusted beyond it.
  std::optional<double> split_half_psnr_dB;
  /// Of `auto`: the predicted error of 95 % of the pixels, in just-noticeable differences, and
  /// whether it is within `Quality::tolerance`.
  std::optional<double> tolerance_error;
  std::optional<bool> tolerance_met;
  /// Of `auto`: the level that was rendered.
  std::optional<QualityLevel> quality_level;
  std::optional<GpuTimes> gpu;  ///< by stage; absent: the CPU rendered
  /// False if the frame-time budget of `auto` was too short for its tolerance.
  bool full_quality = true;
};

/// A method renders one scene, which it is made for. It may keep buffers between frames. Not
/// thread-safe: one thread calls it. Inside, it uses as many threads as the enclosing
/// tbb::task_arena or tbb::global_control allows.
class Method {
 public:
  virtual ~Method() = default;

  /// Renders the scene. The same input gives the same bytes at any number of threads. `frame` is
  /// resized as needed. Chromatic aberration takes one render for each colour, with its own focus.
  RenderStats render(const View& view, const RenderSettings& settings, Frame& frame);

  /// The same, but pixels that a GPU renders stay there (`Frame::gpu`).
  RenderStats renderKept(const View& view, const RenderSettings& settings, Frame& frame);

  /// A clone of the same scene that renders the same frames and may render at the same time. The
  /// two share large data that does not change. Null where a method has nothing to share.
  virtual std::unique_ptr<Method> cloneSharingScene() const { return nullptr; }

  /// Renders in advance, without a frame-time budget, what later renders of this view need to meet
  /// one (`Quality::frame_ms`). Clones profit too.
  virtual void prepare(const View& /*view*/, const RenderSettings& /*settings*/) {}

  /// Passes over a frame: later frames are as if this one had been rendered. Not for a method that
  /// continues from the frame before (`MethodInfo::incremental`), nor under a frame-time budget.
  void pass(const View& view, const RenderSettings& settings);

 private:
  /// `pass` for a lens without chromatic aberration.
  virtual void passFrame(const View& /*view*/, const RenderSettings& /*settings*/) {}

  RenderStats renderColours(const View& view, const RenderSettings& settings, Frame& frame);

  /// Renders into `frame`, which already has the view's size, and depth where the settings ask for
  /// depth. Leaves the pixels on the GPU where it can. Fills every field of the stats except `ms`.
  virtual RenderStats renderFrame(const View& view, const RenderSettings& settings,
                                  Frame& frame) = 0;
};

/// The GPU that a method renders on; null: the CPU.
using SharedGpu = std::shared_ptr<GpuDevice>;

/// Methods of one kind share a colour in every chart.
enum class MethodFamily : std::uint8_t { own, paper, splatting, many_views, post_filter };

struct MethodInfo {
  std::string_view name;
  std::string_view summary;  ///< one line
  std::string_view source;   ///< the publication
  MethodFamily family;
  int max_n = 0;      ///< largest N of `name:N`; 0: the method takes no number
  int default_n = 0;  ///< N of `name` alone; 0: the method then decides by itself
  /// False: the method renders an astigmatic lens as the round lens of the same blur strength
  /// (`roundDefocus_D`).
  bool ellipses = true;
  /// Renders aberrations, the Stiles-Crawford effect and diffraction (`Pupil`); others leave them
  /// out.
  bool aberrations = false;
  /// Each render updates a part of the previous frame.
  bool incremental = false;
  bool gpu = false;  ///< renders surfaces on a GPU too
  /// Takes nodes of the tree in place of surfels (lod_splats.h, `pixelCutOf`), so that a frame
  /// takes memory for what it shows.
  bool lod = false;
  /// Also renders scenes of Gaussians, these also on a GPU.
  bool gaussians = false;
  /// Names V of `name:V`, in place of a number; N is then their place in this list, from 1.
  std::vector<std::string_view> variants = {};
};

/// A method's own file defines its entry.
struct MethodEntry {
  MethodInfo info;
  /// @param n  1 to `info.max_n`, or `info.default_n`; ignored where `max_n` is 0
  /// @param gpu  renders; null, or ignored unless `rendersOnGpu`: the CPU renders
  std::unique_ptr<Method> (*make)(const SurfelCloud& cloud, int n, const SharedGpu& gpu);
  /// The same for a scene of Gaussians; null: the method renders surfaces only.
  std::unique_ptr<Method> (*make_of_gaussians)(const GaussianCloud& cloud, int n,
                                               const SharedGpu& gpu) = nullptr;
};

/// Makes an `M` from the scene, and from N and the GPU where the constructor takes them.
template <class M>
std::unique_ptr<Method> makeAs(const SurfelCloud& cloud, int n, const SharedGpu& gpu) {
  if constexpr (std::is_constructible_v<M, const SurfelCloud&, int, const SharedGpu&>) {
    return std::make_unique<M>(cloud, n, gpu);
  } else if constexpr (std::is_constructible_v<M, const SurfelCloud&, const SharedGpu&>) {
    return std::make_unique<M>(cloud, gpu);
  } else if constexpr (std::is_constructible_v<M, const SurfelCloud&, int>) {
    return std::make_unique<M>(cloud, n);
  } else {
    return std::make_unique<M>(cloud);
  }
}

/// Adds a method: from then on every function below knows it. Call it before other threads use
/// methods. The texts of the entry must live as long as the program.
/// @throws std::invalid_argument if a method has this name
void registerMethod(const MethodEntry& entry);

/// Every method, in the order of registration.
const std::vector<MethodInfo>& methods();

// A spec names a method: `name`, or `name:N` where the method takes a number or has variants. The
// functions below except `expectedMethod` assert that the spec is valid.

const MethodInfo& methodInfo(std::string_view spec);

/// Whether a GPU can render the scene by the method: `MethodInfo::gpu`, or `gaussians` for a scene
/// of these.
bool rendersOnGpu(std::string_view spec, const Scene& scene);

/// Names of the methods that render the scene, in the order of `methods`.
std::vector<std::string_view> methodsFor(const Scene& scene);

/// What was expected in place of an invalid `spec`; nullopt where `spec` is valid.
std::optional<std::string> expectedMethod(std::string_view spec);

/// @param scene  must outlive the method
/// @throws InputError if the scene holds Gaussians and the method renders surfaces only
/// @param gpu    renders where the method can (`rendersOnGpu`). The method then throws GpuError
///               where the GPU fails or lacks memory, here and in `render`.
std::unique_ptr<Method> makeMethod(std::string_view spec, const Scene& scene,
                                   const SharedGpu& gpu = nullptr);
std::unique_ptr<Method> makeMethod(std::string_view spec, const SurfelCloud& cloud,
                                   const SharedGpu& gpu = nullptr);
std::unique_ptr<Method> makeMethod(std::string_view spec, const GaussianCloud& cloud,
                                   const SharedGpu& gpu = nullptr);

}  // namespace foci
