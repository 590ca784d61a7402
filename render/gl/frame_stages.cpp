#include "render/gl/frame_stages.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

constexpr std::size_t kNodesAGroup = 256 * 8;  // of gather.glsl

/// Mesa's software driver ends the loops of a thread after 65,536 rounds, without an error. The
/// sort of a list of kSoftwareList splats stays below that.
constexpr std::uint32_t kSoftwareRounds = 65000, kSoftwareList = 100000;

/// A stage writes what the next one reads, also as the size of its dispatch, and what the host
/// clears and copies.
constexpr GLbitfield kBarriers =
    GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT;

/// A room grows by this factor over what a frame needed.
constexpr double kSpare = 1.25;

}  // namespace

GpuFrameStages::~GpuFrameStages() {
  if (clocks_[0] == 0) return;
  device_->later(
      [clocks = clocks_] { glDeleteQueries(static_cast<GLsizei>(clocks.size()), clocks.data()); });
}

unsigned GpuFrameStages::bind(const std::string& stage, const std::string& defines,
                              std::initializer_list<const GpuBuffer*> buffers) {
  constexpr GLuint kTotalsBinding = 7, kFieldBinding = 15;
  std::string all = "#define TOTALS_BINDING " + std::to_string(kTotalsBinding) + "\n" + defines;
  if (field_ && readsField(stage)) {
    all += "#define FIELD\n";
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kFieldBinding, own_.field.id());
  }
  const GLuint program = device_->program(stage, all);
  glUseProgram(program);
  GLuint binding = 0;
  for (const GpuBuffer* buffer : buffers) {
    if (buffer) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer->id());
    ++binding;
  }
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kTotalsBinding, own_.totals.id());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, own_.frame.id());
  return program;
}

void GpuFrameStages::dispatch(std::size_t groups) {
  const glm::uvec4 rows = rowsOf(groups);
  dispatchSquares({rows.x, rows.y});
}

void GpuFrameStages::dispatchSquares(const glm::uvec2& groups) {
  glDispatchCompute(groups.x, groups.y, 1);
  glMemoryBarrier(kBarriers);
}

void GpuFrameStages::dispatchIndirect(std::size_t offset) const {
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, own_.totals.id());
  glDispatchComputeIndirect(static_cast<GLintptr>(offset));
  glMemoryBarrier(kBarriers);
}

void GpuFrameStages::bindWindow(unsigned binding, const GpuBuffer& buffer, const GpuWindow& window,
                                std::size_t each_bytes) {
  if (window.count == 0) return;
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, buffer.id(),
                    static_cast<GLintptr>(window.first * each_bytes),
                    static_cast<GLsizeiptr>(window.count * each_bytes));
}

void GpuFrameStages::projectWindows(unsigned program, const GpuWindow& nodes,
                                    const GpuWindow& elements) const {
  glProgramUniform4ui(program, 0, static_cast<GLuint>(nodes.first),
                      static_cast<GLuint>(nodes.count), static_cast<GLuint>(elements.first),
                      static_cast<GLuint>(elements.count));
  dispatchIndirect(offsetof(GpuTotals, project_groups));
}

void GpuFrameStages::setField(const Defocus& defocus, const glm::vec2& part, float radius) {
  field_ = shownField(defocus) ? defocus.field : nullptr;
  if (!field_) return;
  const glm::vec2 first = field_->first_px(), size(field_->size());
  // Bounds of the blur grow with the distance from a place, and with that times the defocus.
  const auto change = [&](float off_D) {
    constexpr float kFar_px = 1e6f;
    const float point_D = defocus.focus_D + off_D;
    return field_->blurBounds_px({}, kFar_px, defocus, point_D, 0.0f).second / kFar_px;
  };
  const std::array<glm::vec4, 3> head{
      glm::vec4(first, 1.0f / field_->step_px(), size.x),
      glm::vec4(change(0.0f), change(1.0f) - change(0.0f), size.y, radius),
      glm::vec4(part, 0.0f, 0.0f)};
  const std::size_t bytes = field_->nodes().size() * sizeof(LocalLens);
  own_.field.reserve(*device_, sizeof head + bytes, "the field");
  own_.field.write(0, sizeof head, head.data());
  if (field_ != field_on_gpu_) own_.field.write(sizeof head, bytes, field_->nodes().data());
  field_on_gpu_ = field_;
}

void GpuFrameStages::start(const GpuFrameBlock& block, bool cut) {
  block_ = block;
  tile_count_ = static_cast<std::size_t>(block_.cells.x) * static_cast<std::size_t>(block_.cells.y);
  const auto elements = static_cast<std::size_t>(block_.scene.x);
  if (!cut) entry_room_ = std::max<std::size_t>(elements, 1);
  makeRoom(cut);
  block_.room.x = static_cast<int>(entry_room_);
  block_.room.y = static_cast<int>(list_room_);
  block_.room.z = static_cast<int>(tile_count_ * kGroupsATile);
  own_.frame.write(0, sizeof block_, &block_);
  GpuTotals totals;
  if (!cut) {
    totals.cut_entries = static_cast<std::uint32_t>(elements);
    totals.project_groups = rowsOf(groupsOf(elements, 64));
  }
  own_.totals.write(0, sizeof totals, &totals);
}

void GpuFrameStages::makeRoom(bool cut) {
  const auto room = [&](GpuBuffer& buffer, std::size_t bytes, const char* what) {
    buffer.reserve(*device_, bytes, what);
  };
  room(own_.frame, sizeof(GpuFrameBlock), "a frame's parameters");
  room(own_.totals, sizeof(GpuTotals), "a frame's counts");
  if (cut) {
    const std::size_t nodes = std::size_t{1} << block_.scene.y;
    room(own_.own, nodes * sizeof(float), "the cut's weights");
    room(own_.passed, nodes * sizeof(float), "the cut's weights");
    room(own_.group_sums, groupsOf(nodes, kNodesAGroup) * sizeof(glm::uvec4), "the cut's sums");
    room(own_.entries, entry_room_ * sizeof(glm::uvec2), "the cut's entries");
  }
  room(own_.keys, entry_room_ * kVector_bytes, "the splats");
  const auto each_tile = [&](GpuBuffer& buffer, std::size_t bytes) {
    room(buffer, tile_count_ * bytes, "the tiles");
  };
  each_tile(own_.cells, sizeof(glm::uvec2));
  each_tile(own_.tile_of_cell, sizeof(GLuint));
  each_tile(own_.tiles, sizeof(glm::ivec4));
  each_tile(own_.blurs, sizeof(GLfloat));
  each_tile(own_.cursors, sizeof(GLuint));
  each_tile(own_.ranges, sizeof(glm::uvec2));
  each_tile(own_.work, 3 * kGroupsATile * sizeof(GLuint));
  room(own_.lists, list_room_ * sizeof(glm::uvec2), "the tiles' lists");
  room(own_.scratch, list_room_ * sizeof(glm::uvec2), "the tiles' lists");
  room(own_.samples, tile_count_ * kSamplesATile * kVector_bytes, "the samples");
}

void GpuFrameStages::makeDepthRoom() {
  own_.depths.reserve(*device_, tile_count_ * kSamplesATile * sizeof(float), "the samples' depths");
}

void GpuFrameStages::gatherCut() {
  const std::size_t groups = groupsOf(std::size_t{1} << block_.scene.y, kNodesAGroup);
  bind("gather", {}, {&own_.own, &own_.passed, &own_.group_sums, nullptr, &own_.entries});
  dispatch(groups);
  const GLuint prefix = bind("prefix_cut", {}, {nullptr, nullptr, &own_.group_sums});
  glProgramUniform1ui(prefix, 0, static_cast<GLuint>(groups));
  dispatch(1);
  bind("gather", "#define FILL\n",
       {&own_.own, &own_.passed, &own_.group_sums, nullptr, &own_.entries});
  dispatch(groups);
}

void GpuFrameStages::divideIntoTiles() {
  const glm::uvec2 nothing(3u, 0u);  // the largest step, no blur
  glClearNamedBufferSubData(own_.cells.id(), GL_RG32UI, 0,
                            static_cast<GLsizeiptr>(tile_count_ * sizeof nothing), GL_RG_INTEGER,
                            GL_UNSIGNED_INT, &nothing);
  own_.cursors.fill(0, tile_count_ * sizeof(GLuint));
  if (block_.cells.z != 0 || block_.size.w != 0) {
    bind("blur_cells", {}, {&own_.keys, &own_.cells});
    dispatchIndirect(offsetof(GpuTotals, project_groups));
  }
  bind("tiles", {}, {&own_.cells, &own_.tile_of_cell, &own_.tiles, &own_.blurs});
  dispatchSquares((glm::uvec2(block_.cells) + (kMaxStep_px - 1u)) / glm::uvec2(kMaxStep_px));
}

void GpuFrameStages::listSplats() {
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

void GpuFrameStages::sortIntoTiles() {
  divideIntoTiles();
  listSplats();
  note(GpuStage::bin);
  bind("sort", {}, {&own_.lists, &own_.scratch, &own_.ranges});
  dispatch(tile_count_);
  note(GpuStage::sort);
}

void GpuFrameStages::interpolate(const GpuImage& image, const GpuBuffer* weights) {
  const bool depth = image.hasDepth();
  bind("interpolate",
       std::string(depth ? "#define DEPTH\n" : "") + (weights ? "#define WEIGHTS\n" : ""),
       {&own_.tile_of_cell, &own_.tiles, &own_.samples, &image.buffers().pixels,
        depth ? &own_.depths : nullptr, depth ? &image.buffers().depths : nullptr, weights});
  dispatchSquares((glm::uvec2(block_.size) + 15u) / 16u);
}

void GpuFrameStages::clearFragments() {
  const std::uint32_t none[2] = {};
  own_.totals.write(offsetof(GpuTotals, fragments_low), sizeof none, none);
}

GpuTotals GpuFrameStages::totals() const {
  GpuTotals totals;
  own_.totals.read(0, sizeof totals, &totals);
  device_->check();
  return totals;
}

bool GpuFrameStages::grew(const GpuTotals& totals) {
  const auto more = [](std::size_t& room, std::uint32_t needed) {
    if (needed <= room) return false;
    room = static_cast<std::size_t>(kSpare * needed);
    return true;
  };
  const bool entries = more(entry_room_, totals.cut_entries);
  return more(list_room_, totals.list_entries) || entries;
}

void GpuFrameStages::checkLoops(const GpuTotals& totals) const {
  if (!device_->isSoftware()) return;
  if (totals.longest_list <= kSoftwareList && totals.sweep_rounds <= kSoftwareRounds) return;
  throw GpuError(device_->name() + ": this software driver ends long loops, and a tile has " +
                 std::to_string(totals.longest_list) + " splats");
}

void GpuFrameStages::beginTimes() {
  if (clocks_[0] == 0) {
    glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(clocks_.size()), clocks_.data());
  }
  noted_.clear();
  glQueryCounter(clocks_[0], GL_TIMESTAMP);
}

void GpuFrameStages::note(GpuStage stage) {
  noted_.push_back(stage);
  glQueryCounter(clocks_.at(noted_.size()), GL_TIMESTAMP);
}

GpuTimes GpuFrameStages::times() const {
  constexpr double kMsANanosecond = 1e-6;
  GpuTimes times;
  GLuint64 before = 0;
  glGetQueryObjectui64v(clocks_[0], GL_QUERY_RESULT, &before);
  for (std::size_t i = 0; i < noted_.size(); ++i) {
    GLuint64 after = 0;
    glGetQueryObjectui64v(clocks_.at(i + 1), GL_QUERY_RESULT, &after);
    times.stage_ms.at(static_cast<std::size_t>(noted_[i])) =
        kMsANanosecond * static_cast<double>(after - before);
    before = after;
  }
  return times;
}

bool blurs(const GpuRequest& request) {
  const glm::vec2 radius = request.defocus.radius_px_per_D * request.aperture;
  return radius.x > 0.0f && radius.y > 0.0f;
}

bool mayBeCoarse(const GpuRequest& request) {
  return request.cut && (blurs(request) || request.cut->acuity.base_px > 1.0f ||
                         request.cut->acuity.per_px > 0.0f);
}

GpuFrameBlock viewBlockOf(const View& view, const Defocus& defocus, const Acuity& acuity) {
  const glm::mat3 rows = glm::transpose(glm::mat3(view.eye_from_world));
  const glm::vec3 eye = -rows * glm::vec3(view.eye_from_world[3]);
  const glm::vec2 j = defocus.astigmatism_D;
  GpuFrameBlock block;
  block.right = {rows[0], eye.x};
  block.up = {rows[1], eye.y};
  block.back = {rows[2], eye.z};
  block.focal_principal_px = {view.focal_px, view.principal_px};
  block.view_px = {view.principal_px, defocus.radius_px_per_D};
  block.focus = {defocus.focus_D, j, glm::length(j)};
  block.acuity = {acuity.gaze_px, acuity.base_px, acuity.per_px};
  block.cut.w = view.near_m;
  block.size = {view.size_px, 0, 0};
  block.cells = {(view.size_px + kTile - 1) / kTile, 0, 0};
  block.scene.z = defocus.along == DistanceAlong::axis;
  return block;
}

GpuFrameBlock frameBlockOf(const GpuRequest& request, const GpuScene& scene) {
  const View& view = request.view;
  const Defocus& defocus = request.defocus;
  // Where directions have their own lens, field.glsl knows the aperture.
  const bool field = shownField(defocus) != nullptr;
  const glm::vec2 radius = defocus.radius_px_per_D, j = defocus.astigmatism_D;
  const glm::vec2 lens = field ? glm::vec2(0.0f) : request.lens;
  // Astigmatism displaces all points alike, whatever their distance, for a given lens point.
  const glm::vec2 aside_px =
      radius * glm::vec2(j.x * lens.x + j.y * lens.y, j.y * lens.x - j.x * lens.y);
  const bool blurred = blurs(request), coarse = mayBeCoarse(request);
  const float oblong =
      !field && radius.x > 0.0f && radius.y > 0.0f ? std::sqrt(radius.y / radius.x) : 1.0f;
  const CutSettings cut = request.cut.value_or(kFaithfulCut);
  const std::size_t number = request.sub_aperture_centres.size();

  GpuFrameBlock block =
      viewBlockOf(view, defocus, request.cut ? request.cut->acuity : request.acuity);
  block.focal_principal_px = {view.focal_px, view.principal_px + aside_px};
  block.blur_lens = {radius * request.aperture, radius * lens};
  if (!blurred) block.focus.w = 0.0f;
  block.cut = {cut.per_blur2, cut.per_pixel2, cut.per_acuity2, view.near_m};
  block.background_low_pass = {request.lighting.background, request.low_pass_px};
  block.meridian_oblong = {nearestMeridian(defocus), oblong, 1.0f / oblong};
  block.sub_aperture_shading = {number > 1 ? 1.0f / std::sqrt(static_cast<float>(number)) : 0.0f,
                                request.lighting.shading, static_cast<float>(number),
                                lensRadius_m(view, defocus)};
  block.size.z = coarse ? kApron * kMaxStep_px : 0;
  block.size.w = coarse;
  block.cells.z = !blurred ? 0 : request.aperture < 1.0f ? 1 : 2;
  block.cells.w = scene.isOriented();
  block.scene = {static_cast<int>(scene.surfelCount()), scene.levels(), block.scene.z,
                 scene.isTransparent()};
  block.cut_switches.x = cut.foreshortened;
  return block;
}

}  // namespace foci
