// The stages of a frame that surfels and Gaussians share: the frame's parameters, the entries of an
// LOD cut, tiles, their sorted lists, and pixels. They know splats by their keys alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/gl/buffer.h"
#include "render/gl/device.h"
#include "render/gl/image.h"
#include "render/gl/scene.h"
#include "render/gl/shader_text.h"
#include "render/lod/cut.h"
#include "render/optics/defocus.h"
#include "render/optics/lens_field.h"
#include "render/optics/view.h"
#include "render/splat/bin.h"

namespace foci {

struct GpuRequest {
  View view;
  Defocus defocus;
  std::optional<CutSettings> cut;  ///< absent: every surfel, at full detail
  Acuity acuity = {};              ///< width of the prefilter without a cut, which has its own
  glm::vec2 lens{0.0f};            ///< `Projection::lens`
  float aperture = 1.0f;           ///< `Projection::aperture`
  Lighting lighting = {};
  bool depth = false;
  float low_pass_px = 0.0f;                     ///< of `SweepSettings`
  std::vector<glm::vec2> sub_aperture_centres;  ///< lens radii; up to one: none
};

struct GpuStats {
  std::uint64_t splats = 0, fragments = 0;
  GpuTimes times;
};

/// The parameters of a frame, as shaders/frame.glsl lays them out (std140).
struct GpuFrameBlock {
  glm::vec4 right{0.0f}, up{0.0f}, back{0.0f};
  glm::vec4 focal_principal_px{0.0f}, view_px{0.0f}, blur_lens{0.0f}, focus{0.0f}, acuity{0.0f};
  glm::vec4 cut{0.0f}, background_low_pass{0.0f}, meridian_oblong{0.0f};
  glm::vec4 sub_aperture_shading{0.0f};
  glm::ivec4 size{0}, cells{0}, scene{0}, room{0}, cut_switches{0};
};
static_assert(sizeof(GpuFrameBlock) == 17 * sizeof(glm::vec4));

/// What the GPU reads and counts: shaders/frame.glsl (std430).
struct GpuTotals {
  std::uint32_t cut_nodes = 0, cut_entries = 0, cut_whole = 0;
  std::uint32_t nearest = 0xFFFFFFFFu, farthest = 0;
  std::uint32_t list_entries = 0, splats = 0;
  std::uint32_t work[3] = {};
  std::uint32_t fragments_low = 0, fragments_high = 0;
  std::uint32_t longest_list = 0, sweep_rounds = 0;
  std::uint32_t unused[2] = {};
  glm::uvec4 project_groups{0, 1, 1, 0};
  glm::uvec4 sweep_groups[3] = {{0, 1, 1, 0}, {0, 1, 1, 0}, {0, 1, 1, 0}};
};
static_assert(sizeof(GpuTotals) == 128);

inline std::uint64_t fragmentsOf(const GpuTotals& totals) {
  return std::uint64_t{totals.fragments_high} << 32 | totals.fragments_low;
}

/// What surfels and Gaussians have in common: the view, the lens without its aperture, and acuity.
GpuFrameBlock viewBlockOf(const View& view, const Defocus& defocus, const Acuity& acuity);

/// Whether the request blurs.
bool blurs(const GpuRequest& request);

/// Whether samples may be more than a pixel apart.
bool mayBeCoarse(const GpuRequest& request);

/// All but `room`.
GpuFrameBlock frameBlockOf(const GpuRequest& request, const GpuScene& scene);

/// Keeps its buffers between frames. Needs a `GpuDevice::Use`, but for its destructor.
class GpuFrameStages {
 public:
  struct Buffers {
    GpuBuffer frame, totals, field;
    GpuBuffer own, passed, group_sums, entries;                          // of the cut
    GpuBuffer keys;                                                      // by entry
    GpuBuffer cells, tile_of_cell, tiles, blurs, cursors, ranges, work;  // by tile
    GpuBuffer lists, scratch;
    GpuBuffer samples, depths;
  };

  explicit GpuFrameStages(std::shared_ptr<GpuDevice> device) : device_(std::move(device)) {}
  ~GpuFrameStages();
  GpuFrameStages(const GpuFrameStages&) = delete;
  GpuFrameStages& operator=(const GpuFrameStages&) = delete;

  /// Sets the lens of each direction where it has a field that shows; before `start`.
  /// @param part, radius  of a part of the lens, lens radii: its centre and radius
  void setField(const Defocus& defocus, const glm::vec2& part = glm::vec2(0.0f),
                float radius = 1.0f);

  /// Makes room, and sets the frame's parameters and counts.
  /// @param block  all but the first three numbers of `room`; of the scene the elements and levels
  /// @param cut    the entries are those of a cut; else all elements
  void start(const GpuFrameBlock& block, bool cut);
  /// Rooms of a frame that has depth.
  void makeDepthRoom();

  /// Lists the entries of the cut that `own` and `passed` hold.
  void gatherCut();
  /// Divides the image into tiles, and lists and sorts the splats of each. Notes both stages.
  void sortIntoTiles();
  /// @param weights  by tile, of its new image over what `image` holds; null: all 1
  void interpolate(const GpuImage& image, const GpuBuffer* weights = nullptr);

  /// Restarts the count of fragments.
  void clearFragments();
  GpuTotals totals() const;
  /// Whether the frame needed more room; then it must be rendered again.
  bool grew(const GpuTotals& totals);
  /// Throws GpuError where a software driver has ended a loop too early.
  void checkLoops(const GpuTotals& totals) const;

  void beginTimes();
  /// Notes the time at which `stage` is done.
  void note(GpuStage stage);
  /// Of the stages since `beginTimes`.
  GpuTimes times() const;

  /// Runs a stage on the buffers, in the order of its bindings; null leaves one out.
  /// @return the program
  unsigned bind(const std::string& stage, const std::string& defines,
                std::initializer_list<const GpuBuffer*> buffers);
  static void dispatch(std::size_t groups);
  /// Work groups that are squares of an image.
  static void dispatchSquares(const glm::uvec2& groups);
  void dispatchIndirect(std::size_t offset) const;
  /// Projects the entries that lie within two windows: of nodes, and of the surfels or Gaussians.
  void projectWindows(unsigned program, const GpuWindow& nodes, const GpuWindow& elements) const;
  static void bindWindow(unsigned binding, const GpuBuffer& buffer, const GpuWindow& window,
                         std::size_t each_bytes);

  const Buffers& buffers() const { return own_; }
  const GpuFrameBlock& block() const { return block_; }
  std::size_t entryRoom() const { return entry_room_; }
  std::size_t tileCount() const { return tile_count_; }

 private:
  /// Rooms at the start; a frame that needs more is rendered again with more.
  static constexpr std::size_t kFirstEntries = std::size_t{1} << 16;
  static constexpr std::size_t kFirstLists = std::size_t{1} << 18;

  void makeRoom(bool cut);
  void divideIntoTiles();
  void listSplats();

  std::shared_ptr<GpuDevice> device_;
  Buffers own_;
  GpuFrameBlock block_;
  std::shared_ptr<const LensField> field_, field_on_gpu_;  // null: one lens for all directions
  std::size_t entry_room_ = kFirstEntries, list_room_ = kFirstLists, tile_count_ = 0;
  std::array<unsigned, kGpuStages.size() + 1> clocks_{};
  std::vector<GpuStage> noted_;
};

/// Work groups of a tile's samples.
inline constexpr std::size_t kGroupSide = 8;  ///< kGroup of shaders/frame.glsl
inline constexpr std::size_t kGroupsATile =
    ((kMostSamples + kGroupSide - 1) / kGroupSide) * ((kMostSamples + kGroupSide - 1) / kGroupSide);
/// Room for a tile's samples.
inline constexpr std::size_t kSamplesATile = std::size_t{kMostSamples} * kMostSamples;
inline constexpr std::size_t kVector_bytes = sizeof(glm::vec4);

}  // namespace foci
