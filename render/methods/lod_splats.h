// The scene as a tree, rendered no finer than blur and acuity show it: the one door through which
// methods reach level of detail.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "render/lod/cut.h"
#include "render/lod/moment_tree.h"
#include "render/methods/method.h"
#include "render/splat/bin.h"
#include "render/splat/splat.h"

namespace foci {

struct LodSettings {
  CutSettings cut;
  int sub_apertures = 1;  ///< where surfaces overlap; 1: the whole aperture only
};

/// Keeps its buffers between frames.
class LodSplats {
 public:
  explicit LodSplats(const SurfelCloud& cloud) : tree_(std::make_shared<MomentTree>(cloud)) {}
  explicit LodSplats(std::shared_ptr<const MomentTree> tree) : tree_(std::move(tree)) {}

  const MomentTree& tree() const { return *tree_; }
  const std::shared_ptr<const MomentTree>& sharedTree() const { return tree_; }

  /// @param frame  of the view's size, with depth where it is asked for
  /// @return all of the stats but their time
  RenderStats render(const View& view, const RenderSettings& settings, const LodSettings& lod,
                     Frame& frame);

 private:
  std::shared_ptr<const MomentTree> tree_;
  Cut cut_;
  SplatChunks chunks_;
  TileLists lists_;
};

}  // namespace foci
