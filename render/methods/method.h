// The one interface of every depth-of-field method.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// What method `auto` may spend. Others take no notice.
struct Quality {
  /// Error that 95 % of the pixels may have, in just noticeable differences (visible_difference.h).
  float tolerance = 1.0f;
  /// Time to hold, ms: beyond it the error grows as far as it must. Images then depend on the
  /// machine, and `RenderStats::rendered_as` says how each was rendered. Absent or infinite: as
  /// long as the tolerance takes.
  std::optional<float> frame_ms = {};
  Acuity acuity = {};  ///< full everywhere by default
  /// Drawn as closely as the render before: another primary or another view of the same image.
  bool as_before = false;
  /// N: as `auto:N` would. 0: as the rest says.
  int way = 0;
  bool operator==(const Quality&) const = default;
};

struct RenderSettings {
  Defocus defocus;             ///< default: everything sharp
  glm::vec3 background{0.0f};  ///< linear RGB behind everything
  float shading =
      0.0f;  ///< 0 to 1: how much of the colour falls off with the cosine to the line of sight
  bool depth = false;  ///< fill Frame::depth_m
  Quality quality = {};
  bool operator==(const RenderSettings&) const = default;
};

/// A method renders one scene, given when it is made; it may keep buffers between frames. Not
/// thread-safe: one thread calls it, it uses as many as the enclosing tbb::task_arena or
/// tbb::global_control allows.
class Method {
 public:
  virtual ~Method() = default;

  /// The same input gives the same bytes at any number of threads. `frame` is resized as needed.
  /// Through a lens with chromatic aberration each primary is rendered with its own focus: three
  /// renders.
  RenderStats render(const View& view, const RenderSettings& settings, Frame& frame);

  /// A clone that renders the same scene alike, at the same time if need be: the two share what
  /// is large and does not change. Nothing where the method has nothing to share.
  virtual std::unique_ptr<Method> cloneSharingScene() const { return nullptr; }

  /// Does at leisure what lets later renders of this view hold a time (`Quality::frame_ms`), those
  /// of its twins too.
  virtual void prepare(const View& /*view*/, const RenderSettings& /*settings*/) {}

 private:
  RenderStats renderPrimaries(const View& view, const RenderSettings& settings, Frame& frame);

  /// Renders into `frame`, which has the view's size, and depth where it is asked for; fills all of
  /// the stats but their time.
  virtual RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) = 0;
};

struct MethodInfo {
  std::string_view name;
  std::string_view summary;  ///< one line
  std::string_view source;   ///< where it is from
  int most = 0;              ///< the largest N of `name:N`; 0: it takes none
  int standard = 0;          ///< N where none is given; 0 of one that takes it: its own choice
  bool ellipses = true;      ///< false: an astigmatic lens is rendered as the round one of its blur
                             ///< strength (`roundDefocus_D`)
  bool goes_on = false;      ///< mends the image of the render before, a part of it at a time
};

/// What each method's own file says of it, in a function that every_method.inc names.
struct MethodEntry {
  MethodInfo info;
  /// @param number  N, 1 to `info.most`, or `info.standard`; of no meaning where `most` is 0
  std::unique_ptr<Method> (*make)(const SurfelCloud& cloud, int number);
};

/// How `M` is made: of the scene, and of N where its constructor takes one.
template <class M>
std::unique_ptr<Method> makeAs(const SurfelCloud& cloud, int number) {
  if constexpr (std::is_constructible_v<M, const SurfelCloud&, int>) {
    return std::make_unique<M>(cloud, number);
  } else {
    return std::make_unique<M>(cloud);
  }
}

const std::vector<MethodInfo>& methods();

/// `MethodInfo::ellipses` of the method that `spec` names. It must be right (asserted).
bool rendersEllipses(std::string_view spec);

/// `MethodInfo::goes_on` of the method that `spec` names. It must be right (asserted).
bool goesOn(std::string_view spec);

/// What was expected instead of `spec`, which is to be the name of one of `methods()`, where it
/// takes a number with `:N` behind it; nothing where `spec` is right.
std::optional<std::string> expectedMethod(std::string_view spec);

/// `spec` must be right (asserted). `cloud` must outlive the method.
std::unique_ptr<Method> makeMethod(std::string_view spec, const SurfelCloud& cloud);

}  // namespace foci
