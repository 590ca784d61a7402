#include "render/gl/splats.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <cstddef>
#include <string>

#include "render/optics/lens_field.h"

namespace foci {

void GpuSplats::start(const GpuRequest& request) {
  GpuFrameBlock block = frameBlockOf(request, *scene_);
  stages_.setField(request.defocus, request.lens, request.aperture);
  cut_ = request.cut.has_value() && scene_->levels() > 0;
  const bool blurred = block.cells.z != 0;
  lens_ = block.cells.z == 2;
  astigmatic_ = blurred && (isAstigmatic(request.defocus) || shownField(request.defocus));
  by_sub_apertures_ = blurred && request.sub_aperture_centres.size() > 1;
  if (!by_sub_apertures_) block.sub_aperture_shading.z = 1.0f;
  block.room.w = static_cast<int>(firstRangeNode(scene_->surfelCount()));
  stages_.start(block, cut_);
  if (request.depth) stages_.makeDepthRoom();
  makeRoom(request);
  const std::vector<std::uint8_t> outside =
      bodiesFromOutside(scene_->bodies(), request.view, request.defocus);
  bodies_ = !outside.empty();
  if (bodies_) {
    const std::vector<GLuint> wide(outside.begin(), outside.end());
    own_.outside.reserve(*device_, wide.size() * sizeof wide[0], "the bodies");
    own_.outside.write(0, wide.size() * sizeof wide[0], wide.data());
  }
}

void GpuSplats::makeRoom(const GpuRequest& request) {
  const auto room = [&](GpuBuffer& buffer, std::size_t bytes, const char* what) {
    buffer.reserve(*device_, bytes, what);
  };
  const std::size_t entries = stages_.entryRoom();
  if (cut_) {
    const std::size_t nodes = std::size_t{1} << scene_->levels();
    room(own_.bounds, nodes * kVector_bytes, "the cut's bounds");
  }
  room(own_.splats_a, entries * 2 * kVector_bytes, "the splats");
  room(own_.splats_b, entries * 2 * kVector_bytes, "the splats");
  if (lens_) {
    room(own_.lenses, entries * (astigmatic_ ? 2 : 1) * kVector_bytes, "the lens points");
  }
  if (by_sub_apertures_) {
    room(own_.sharper, entries * 3 * kVector_bytes, "the splats of sub-apertures");
    std::vector<glm::vec4> centres;
    for (const glm::vec2& each : request.sub_aperture_centres) {
      centres.emplace_back(each, 0.0f, 0.0f);
    }
    room(own_.centres, centres.size() * kVector_bytes, "the sub-apertures");
    own_.centres.write(0, centres.size() * kVector_bytes, centres.data());
  }
  room(own_.overlaps, stages_.tileCount() * sizeof(GLuint), "the tiles");
  own_.overlaps.fill(0, stages_.tileCount() * sizeof(GLuint));
}

void GpuSplats::selectCut() {
  const GpuScene::Buffers& scene = scene_->buffers();
  const GpuFrameStages::Buffers& common = stages_.buffers();
  for (int level = 0; level < scene_->levels(); ++level) {
    const GLuint program = stages_.bind(
        "cut", bodies_ ? "#define BODIES\n" : "",
        {&scene.node_places, &scene.coarseness, &common.own, &common.passed, &own_.bounds,
         bodies_ ? &scene.facing : nullptr, nullptr, nullptr, bodies_ ? &own_.outside : nullptr});
    glProgramUniform1i(program, 0, level);
    GpuFrameStages::dispatch(groupsOf(std::size_t{1} << level, 64));
  }
  stages_.gatherCut();
}

void GpuSplats::project() {
  const GpuScene::Buffers& scene = scene_->buffers();
  const GpuFrameStages::Buffers& common = stages_.buffers();
  std::string defines;
  if (cut_) defines += "#define CUT\n";
  if (lens_) defines += "#define LENS\n";
  if (astigmatic_) defines += "#define ASTIGMATIC\n";
  if (by_sub_apertures_) defines += "#define SUB_APERTURES\n";
  if (bodies_) defines += "#define BODIES\n";
  const GLuint program = stages_.bind(
      "project", defines,
      {cut_ ? &common.entries : nullptr, cut_ ? &scene.node_places : nullptr, nullptr, nullptr,
       &own_.splats_a, &common.keys, &scene.shapes, nullptr, lens_ ? &own_.lenses : nullptr,
       by_sub_apertures_ ? &own_.sharper : nullptr, nullptr, &own_.splats_b,
       bodies_ ? &own_.outside : nullptr, bodies_ && cut_ ? &scene.facing : nullptr});
  // Of large arrays a shader sees a window at a time: one pass for each.
  for (std::size_t pass = 0; pass < scene_->windows(); ++pass) {
    const GpuWindow nodes = scene_->nodeWindow(pass), surfels = scene_->surfelWindow(pass);
    if (cut_) GpuFrameStages::bindWindow(2, scene.nodes, nodes, GpuScene::kNode_bytes);
    GpuFrameStages::bindWindow(3, scene.surfels_a, surfels, GpuScene::kSurfel_bytes);
    GpuFrameStages::bindWindow(10, scene.surfels_b, surfels, GpuScene::kSurfel_bytes);
    stages_.projectWindows(program, nodes, surfels);
  }
}

void GpuSplats::sweep(const GpuRequest& request) {
  const GpuFrameStages::Buffers& common = stages_.buffers();
  GLuint program = 0;
  std::string variant;
  if (scene_->isTransparent()) variant += "#define TRANSPARENT\n";
  if (request.depth) variant += "#define DEPTH\n";
  const auto pass = [&](std::size_t kind, const std::string& defines) {
    program = stages_.bind(
        "sweep", variant + defines + "#define WORK_KIND " + std::to_string(kind) + "u\n",
        {&common.work, &common.tiles, &common.blurs, &common.ranges, &common.lists, &own_.splats_a,
         &own_.splats_b, nullptr, &common.samples, request.depth ? &common.depths : nullptr,
         lens_ ? &own_.lenses : nullptr, by_sub_apertures_ ? &own_.sharper : nullptr,
         &own_.overlaps, &common.work, by_sub_apertures_ ? &own_.centres : nullptr});
    return offsetof(GpuTotals, sweep_groups) + kind * sizeof(glm::uvec4);
  };
  const std::string astigmatic = astigmatic_ ? "#define ASTIGMATIC\n" : "";
  stages_.dispatchIndirect(pass(0, {}));
  if (lens_) stages_.dispatchIndirect(pass(1, "#define LENS\n" + astigmatic));
  if (!by_sub_apertures_) return;
  const std::size_t groups = pass(2, "#define SUB_APERTURES\n" + astigmatic);
  for (std::size_t i = 0; i < request.sub_aperture_centres.size(); ++i) {
    glProgramUniform1i(program, 0, static_cast<GLint>(i));
    stages_.dispatchIndirect(groups);
  }
}

GpuStats GpuSplats::render(const GpuRequest& request, std::shared_ptr<GpuImage>& image) {
  const GpuDevice::Use use(*device_);
  image = nullptr;  // its buffers can be used again
  image = std::make_shared<GpuImage>(device_, request.view.size_px, request.depth);
  GpuTotals totals;
  do {
    start(request);
    stages_.beginTimes();
    if (cut_) selectCut();
    stages_.note(GpuStage::cut);
    project();
    stages_.note(GpuStage::project);
    stages_.sortIntoTiles();
    sweep(request);
    stages_.note(GpuStage::composite);
    stages_.interpolate(*image);
    stages_.note(GpuStage::present);
    totals = stages_.totals();
  } while (stages_.grew(totals));
  stages_.checkLoops(totals);
  return {.splats = totals.splats, .fragments = fragmentsOf(totals), .times = stages_.times()};
}

}  // namespace foci
