#include "render/gl/splats.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <utility>

#include "render/gl/buffer.h"
#include "render/gl/frame_block.h"
#include "render/gl/scene_buffers.h"
#include "render/splat/bin.h"

namespace foci {
namespace {

constexpr std::size_t kVector_bytes = sizeof(glm::vec4);
constexpr std::size_t kSamplesATile = (kTile + 2 * kApron) * (kTile + 2 * kApron);
constexpr int kGroup = 8;  // samples along the side of a work group of the sweep
constexpr int kGroupsATile =
    ((kTile + 2 * kApron + kGroup - 1) / kGroup) * ((kTile + 2 * kApron + kGroup - 1) / kGroup);
constexpr std::size_t kNodesAGroup = 256 * 8;  // of gather.glsl

/// Rooms at the start; a frame that needs more is rendered again with more.
constexpr std::size_t kFirstEntries = std::size_t{1} << 16, kFirstLists = std::size_t{1} << 18;

/// Mesa's software driver ends the loops of a thread after 65,536 rounds, without an error. The
/// sort of a list of kSoftwareList splats stays below that.
constexpr std::uint32_t kSoftwareRounds = 65000, kSoftwareList = 100000;

/// A stage writes what the next one reads, also as the size of its dispatch, and what the host
/// clears and copies.
constexpr GLbitfield kBarriers =
    GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT;

/// A room grows by this factor over what a frame needed.
constexpr double kSpare = 1.25;

GLuint groupsOf(std::size_t count, std::size_t each) {
  return static_cast<GLuint>((count + each - 1) / each);
}

}  // namespace

class GpuSplats::Pipeline {
 public:
  explicit Pipeline(std::shared_ptr<const GpuScene> scene)
      : scene_(std::move(scene)), device_(scene_->device()) {}
  ~Pipeline() {
    if (clocks_[0] == 0) return;
    device_->later([clocks = clocks_] {
      glDeleteQueries(static_cast<GLsizei>(clocks.size()), clocks.data());
    });
  }
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  GpuStats render(const GpuRequest& request, std::shared_ptr<GpuImage>& image);
  const std::shared_ptr<const GpuScene>& scene() const { return scene_; }

 private:
  struct Buffers {
    GpuBuffer frame, totals, outside;
    GpuBuffer own, passed, bounds, group_sums, entries;                            // of the cut
    GpuBuffer splats_a, splats_b, keys, lenses, sharper;                           // by entry
    GpuBuffer cells, tile_of_cell, tiles, blurs, cursors, ranges, overlaps, work;  // by tile
    GpuBuffer lists, scratch;
    GpuBuffer centres, samples, depths;
  };

  void start(const GpuRequest& request);
  void makeRoom(const GpuRequest& request);
  void selectCut();
  void project();
  void divideIntoTiles();
  void listSplats();
  void sortLists();
  void sweep(const GpuRequest& request);
  void interpolate(const GpuImage& image);
  bool grew(const GpuTotals& totals);
  /// Notes the time at which `stage` is done; without one, at which the first begins.
  void note(std::optional<GpuStage> stage = {});
  GpuTimes times() const;

  /// Runs a stage on the buffers, in the order of its bindings; null leaves one out.
  void bind(const std::string& stage, const std::string& defines,
            std::initializer_list<const GpuBuffer*> buffers);
  void dispatch(GLuint x, GLuint y = 1);
  void dispatchIndirect(std::size_t offset);
  void bindWindow(GLuint binding, const GpuBuffer& buffer, const GpuScene::Window& window,
                  std::size_t each_bytes);

  std::shared_ptr<const GpuScene> scene_;
  std::shared_ptr<GpuDevice> device_;
  Buffers own_;
  GpuFrameBlock block_;
  std::size_t entry_room_ = kFirstEntries, list_room_ = kFirstLists, tile_count_ = 0;
  bool cut_ = false, blurred_ = false, astigmatic_ = false, by_sub_apertures_ = false;
  bool bodies_ = false;
  GLuint program_ = 0;
  std::array<GLuint, kGpuStages.size() + 1> clocks_{};
};

void GpuSplats::Pipeline::bind(const std::string& stage, const std::string& defines,
                               std::initializer_list<const GpuBuffer*> buffers) {
  constexpr GLuint kTotalsBinding = 7;
  program_ = device_->program(
      stage, "#define TOTALS_BINDING " + std::to_string(kTotalsBinding) + "\n" + defines);
  glUseProgram(program_);
  GLuint binding = 0;
  for (const GpuBuffer* buffer : buffers) {
    if (buffer) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer->id());
    ++binding;
  }
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kTotalsBinding, own_.totals.id());
}

void GpuSplats::Pipeline::dispatch(GLuint x, GLuint y) {
  glDispatchCompute(x, y, 1);
  glMemoryBarrier(kBarriers);
}

void GpuSplats::Pipeline::dispatchIndirect(std::size_t offset) {
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, own_.totals.id());
  glDispatchComputeIndirect(static_cast<GLintptr>(offset));
  glMemoryBarrier(kBarriers);
}

void GpuSplats::Pipeline::bindWindow(GLuint binding, const GpuBuffer& buffer,
                                     const GpuScene::Window& window, std::size_t each_bytes) {
  if (window.count == 0) return;
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer.id(),
                    static_cast<GLintptr>(window.first * each_bytes),
                    static_cast<GLsizeiptr>(window.count * each_bytes));
}

void GpuSplats::Pipeline::start(const GpuRequest& request) {
  block_ = frameBlockOf(request, *scene_);
  cut_ = request.cut.has_value() && scene_->levels() > 0;
  blurred_ = block_.cells.z != 0;
  astigmatic_ = blurred_ && isAstigmatic(request.defocus);
  by_sub_apertures_ = blurred_ && request.sub_aperture_centres.size() > 1;
  if (!by_sub_apertures_) block_.sub_aperture_shading.z = 1.0f;
  tile_count_ = static_cast<std::size_t>(block_.cells.x) * static_cast<std::size_t>(block_.cells.y);
  if (!cut_) entry_room_ = std::max<std::size_t>(scene_->surfelCount(), 1);
  makeRoom(request);
  block_.room = {static_cast<int>(entry_room_), static_cast<int>(list_room_),
                 static_cast<int>(tile_count_ * kGroupsATile),
                 static_cast<int>(firstRangeNode(scene_->surfelCount()))};
  own_.frame.write(0, sizeof block_, &block_);
  GpuTotals totals;
  if (!cut_) {
    totals.cut_entries = static_cast<std::uint32_t>(scene_->surfelCount());
    totals.project_groups.x = groupsOf(scene_->surfelCount(), 64);
  }
  own_.totals.write(0, sizeof totals, &totals);
  const std::vector<std::uint8_t> outside =
      bodiesFromOutside(scene_->bodies(), request.view, request.defocus);
  bodies_ = !outside.empty();
  if (bodies_) {
    const std::vector<GLuint> wide(outside.begin(), outside.end());
    own_.outside.reserve(*device_, wide.size() * sizeof wide[0], "the bodies");
    own_.outside.write(0, wide.size() * sizeof wide[0], wide.data());
  }
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, own_.frame.id());
}

void GpuSplats::Pipeline::makeRoom(const GpuRequest& request) {
  const auto room = [&](GpuBuffer& buffer, std::size_t bytes, const char* what) {
    buffer.reserve(*device_, bytes, what);
  };
  room(own_.frame, sizeof(GpuFrameBlock), "a frame's parameters");
  room(own_.totals, sizeof(GpuTotals), "a frame's counts");
  if (cut_) {
    const std::size_t nodes = std::size_t{1} << scene_->levels();
    room(own_.own, nodes * sizeof(float), "the cut's weights");
    room(own_.passed, nodes * sizeof(float), "the cut's weights");
    room(own_.bounds, nodes * kVector_bytes, "the cut's bounds");
    room(own_.group_sums, groupsOf(nodes, kNodesAGroup) * sizeof(glm::uvec4), "the cut's sums");
    room(own_.entries, entry_room_ * sizeof(glm::uvec2), "the cut's entries");
  }
  room(own_.splats_a, entry_room_ * 2 * kVector_bytes, "the splats");
  room(own_.splats_b, entry_room_ * 2 * kVector_bytes, "the splats");
  room(own_.keys, entry_room_ * kVector_bytes, "the splats");
  if (blurred_) {
    room(own_.lenses, entry_room_ * (astigmatic_ ? 2 : 1) * kVector_bytes, "the lens points");
  }
  if (by_sub_apertures_) {
    room(own_.sharper, entry_room_ * 3 * kVector_bytes, "the splats of sub-apertures");
    std::vector<glm::vec4> centres;
    for (const glm::vec2& each : request.sub_aperture_centres) {
      centres.emplace_back(each, 0.0f, 0.0f);
    }
    room(own_.centres, centres.size() * kVector_bytes, "the sub-apertures");
    own_.centres.write(0, centres.size() * kVector_bytes, centres.data());
  }
  const auto each_tile = [&](GpuBuffer& buffer, std::size_t bytes) {
    room(buffer, tile_count_ * bytes, "the tiles");
  };
  each_tile(own_.cells, sizeof(glm::uvec2));
  each_tile(own_.tile_of_cell, sizeof(GLuint));
  each_tile(own_.tiles, sizeof(glm::ivec4));
  each_tile(own_.blurs, sizeof(GLfloat));
  each_tile(own_.cursors, sizeof(GLuint));
  each_tile(own_.ranges, sizeof(glm::uvec2));
  each_tile(own_.overlaps, sizeof(GLuint));
  each_tile(own_.work, 3 * kGroupsATile * sizeof(GLuint));
  room(own_.lists, list_room_ * sizeof(glm::uvec2), "the tiles' lists");
  room(own_.scratch, list_room_ * sizeof(glm::uvec2), "the tiles' lists");
  room(own_.samples, tile_count_ * kSamplesATile * kVector_bytes, "the samples");
  if (request.depth) {
    room(own_.depths, tile_count_ * kSamplesATile * sizeof(float), "the samples' depths");
  }
}

void GpuSplats::Pipeline::selectCut() {
  const GpuScene::Buffers& scene = scene_->buffers();
  for (int level = 0; level < scene_->levels(); ++level) {
    bind("cut", bodies_ ? "#define BODIES\n" : "",
         {&scene.node_places, &scene.coarseness, &own_.own, &own_.passed, &own_.bounds,
          bodies_ ? &scene.facing : nullptr, nullptr, nullptr, bodies_ ? &own_.outside : nullptr});
    glProgramUniform1i(program_, 0, level);
    dispatch(groupsOf(std::size_t{1} << level, 64));
  }
  const GLuint groups = groupsOf(std::size_t{1} << scene_->levels(), kNodesAGroup);
  bind("gather", {}, {&own_.own, &own_.passed, &own_.group_sums, nullptr, &own_.entries});
  dispatch(groups);
  bind("prefix_cut", {}, {nullptr, nullptr, &own_.group_sums});
  glProgramUniform1ui(program_, 0, groups);
  dispatch(1);
  bind("gather", "#define FILL\n",
       {&own_.own, &own_.passed, &own_.group_sums, nullptr, &own_.entries});
  dispatch(groups);
}

void GpuSplats::Pipeline::project() {
  const GpuScene::Buffers& scene = scene_->buffers();
  std::string defines;
  if (cut_) defines += "#define CUT\n";
  if (blurred_) defines += "#define LENS\n";
  if (astigmatic_) defines += "#define ASTIGMATIC\n";
  if (by_sub_apertures_) defines += "#define SUB_APERTURES\n";
  if (bodies_) defines += "#define BODIES\n";
  bind("project", defines,
       {cut_ ? &own_.entries : nullptr, cut_ ? &scene.node_places : nullptr, nullptr, nullptr,
        &own_.splats_a, &own_.keys, &scene.shapes, nullptr, blurred_ ? &own_.lenses : nullptr,
        by_sub_apertures_ ? &own_.sharper : nullptr, nullptr, &own_.splats_b,
        bodies_ ? &own_.outside : nullptr, bodies_ && cut_ ? &scene.facing : nullptr});
  // Of large arrays a shader sees a window at a time: one pass for each.
  for (std::size_t pass = 0; pass < scene_->windows(); ++pass) {
    const GpuScene::Window nodes = scene_->nodeWindow(pass), surfels = scene_->surfelWindow(pass);
    if (cut_) bindWindow(2, scene.nodes, nodes, GpuScene::kNode_bytes);
    bindWindow(3, scene.surfels_a, surfels, GpuScene::kSurfel_bytes);
    bindWindow(10, scene.surfels_b, surfels, GpuScene::kSurfel_bytes);
    glProgramUniform4ui(program_, 0, static_cast<GLuint>(nodes.first),
                        static_cast<GLuint>(nodes.count), static_cast<GLuint>(surfels.first),
                        static_cast<GLuint>(surfels.count));
    dispatchIndirect(offsetof(GpuTotals, project_groups));
  }
}

void GpuSplats::Pipeline::divideIntoTiles() {
  const glm::uvec2 nothing(3u, 0u);  // the largest step, no blur
  glClearNamedBufferSubData(own_.cells.id(), GL_RG32UI, 0,
                            static_cast<GLsizeiptr>(tile_count_ * sizeof nothing), GL_RG_INTEGER,
                            GL_UNSIGNED_INT, &nothing);
  own_.overlaps.fill(0, tile_count_ * sizeof(GLuint));
  own_.cursors.fill(0, tile_count_ * sizeof(GLuint));
  if (blurred_ || block_.size.w != 0) {
    bind("blur_cells", {}, {&own_.keys, &own_.cells});
    dispatchIndirect(offsetof(GpuTotals, project_groups));
  }
  bind("tiles", {}, {&own_.cells, &own_.tile_of_cell, &own_.tiles, &own_.blurs});
  dispatch(groupsOf(static_cast<std::size_t>(block_.cells.x), kMaxStep_px),
           groupsOf(static_cast<std::size_t>(block_.cells.y), kMaxStep_px));
}

void GpuSplats::Pipeline::listSplats() {
  const auto visit = [&](const char* defines) {
    bind("lists", defines,
         {&own_.keys, &own_.tile_of_cell, &own_.tiles, &own_.cursors, &own_.lists});
    dispatchIndirect(offsetof(GpuTotals, project_groups));
  };
  visit("");
  bind("prefix_lists", {}, {&own_.cursors, &own_.ranges, &own_.tiles, &own_.blurs, &own_.work});
  dispatch(1);
  visit("#define FILL\n");
}

void GpuSplats::Pipeline::sortLists() {
  bind("sort", {}, {&own_.lists, &own_.scratch, &own_.ranges});
  dispatch(static_cast<GLuint>(tile_count_));
}

void GpuSplats::Pipeline::sweep(const GpuRequest& request) {
  std::string common;
  if (scene_->isTransparent()) common += "#define TRANSPARENT\n";
  if (request.depth) common += "#define DEPTH\n";
  const auto pass = [&](std::size_t kind, const std::string& defines) {
    bind("sweep", common + defines + "#define WORK_KIND " + std::to_string(kind) + "u\n",
         {&own_.work, &own_.tiles, &own_.blurs, &own_.ranges, &own_.lists, &own_.splats_a,
          &own_.splats_b, nullptr, &own_.samples, request.depth ? &own_.depths : nullptr,
          blurred_ ? &own_.lenses : nullptr, by_sub_apertures_ ? &own_.sharper : nullptr,
          &own_.overlaps, &own_.work, by_sub_apertures_ ? &own_.centres : nullptr});
    return offsetof(GpuTotals, sweep_groups) + kind * sizeof(glm::uvec4);
  };
  const std::string astigmatic = astigmatic_ ? "#define ASTIGMATIC\n" : "";
  dispatchIndirect(pass(0, {}));
  if (blurred_) dispatchIndirect(pass(1, "#define LENS\n" + astigmatic));
  if (!by_sub_apertures_) return;
  const std::size_t groups = pass(2, "#define SUB_APERTURES\n" + astigmatic);
  for (std::size_t i = 0; i < request.sub_aperture_centres.size(); ++i) {
    glProgramUniform1i(program_, 0, static_cast<GLint>(i));
    dispatchIndirect(groups);
  }
}

void GpuSplats::Pipeline::interpolate(const GpuImage& image) {
  const bool depth = image.hasDepth();
  bind("interpolate", depth ? "#define DEPTH\n" : "",
       {&own_.tile_of_cell, &own_.tiles, &own_.samples, &image.buffers().pixels,
        depth ? &own_.depths : nullptr, depth ? &image.buffers().depths : nullptr});
  dispatch(groupsOf(static_cast<std::size_t>(block_.size.x), 16),
           groupsOf(static_cast<std::size_t>(block_.size.y), 16));
}

bool GpuSplats::Pipeline::grew(const GpuTotals& totals) {
  const auto more = [](std::size_t& room, std::uint32_t needed) {
    if (needed <= room) return false;
    room = static_cast<std::size_t>(kSpare * needed);
    return true;
  };
  const bool entries = more(entry_room_, totals.cut_entries);
  return more(list_room_, totals.list_entries) || entries;
}

void GpuSplats::Pipeline::note(std::optional<GpuStage> stage) {
  if (clocks_[0] == 0) {
    glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(clocks_.size()), clocks_.data());
  }
  glQueryCounter(clocks_.at(stage ? static_cast<std::size_t>(*stage) + 1 : 0), GL_TIMESTAMP);
}

GpuTimes GpuSplats::Pipeline::times() const {
  constexpr double kMsANanosecond = 1e-6;
  GpuTimes times;
  GLuint64 before = 0;
  glGetQueryObjectui64v(clocks_[0], GL_QUERY_RESULT, &before);
  for (std::size_t stage = 0; stage < kGpuStages.size(); ++stage) {
    GLuint64 after = 0;
    glGetQueryObjectui64v(clocks_.at(stage + 1), GL_QUERY_RESULT, &after);
    times.stage_ms.at(stage) = kMsANanosecond * static_cast<double>(after - before);
    before = after;
  }
  return times;
}

GpuStats GpuSplats::Pipeline::render(const GpuRequest& request, std::shared_ptr<GpuImage>& image) {
  const GpuDevice::Use use(*device_);
  image = nullptr;  // its buffers can be used again
  image = std::make_shared<GpuImage>(device_, request.view.size_px, request.depth);
  GpuTotals totals;
  do {
    start(request);
    note();
    if (cut_) selectCut();
    note(GpuStage::cut);
    project();
    note(GpuStage::project);
    divideIntoTiles();
    listSplats();
    note(GpuStage::bin);
    sortLists();
    note(GpuStage::sort);
    sweep(request);
    note(GpuStage::composite);
    interpolate(*image);
    note(GpuStage::present);
    own_.totals.read(0, sizeof totals, &totals);
    device_->check();
  } while (grew(totals));
  if (device_->isSoftware() &&
      (totals.longest_list > kSoftwareList || totals.sweep_rounds > kSoftwareRounds)) {
    throw GpuError(device_->name() + ": this software driver ends long loops, and a tile has " +
                   std::to_string(totals.longest_list) + " splats");
  }
  return {.splats = totals.splats,
          .fragments = std::uint64_t{totals.fragments_high} << 32 | totals.fragments_low,
          .times = times()};
}

GpuSplats::GpuSplats(std::shared_ptr<const GpuScene> scene)
    : pipeline_(std::make_unique<Pipeline>(std::move(scene))) {}
GpuSplats::~GpuSplats() = default;
GpuSplats::GpuSplats(GpuSplats&&) noexcept = default;
GpuSplats& GpuSplats::operator=(GpuSplats&&) noexcept = default;

GpuStats GpuSplats::render(const GpuRequest& request, std::shared_ptr<GpuImage>& image) {
  return pipeline_->render(request, image);
}

const std::shared_ptr<const GpuScene>& GpuSplats::scene() const { return pipeline_->scene(); }

}  // namespace foci
