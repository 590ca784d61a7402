// A block of samples: the sums of its open layers, and its light. Included once a SIMD target.
#if defined(FOCI_BLOCK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_BLOCK_INL_H
#undef FOCI_BLOCK_INL_H
#else
#define FOCI_BLOCK_INL_H
#endif

#include <hwy/highway.h>

#include "render/splat/bin.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

// A tile is blocks of 4 x 4 samples; a block's 16 are consecutive, row by row.
constexpr int kBlock = 4, kBlockSamples = kBlock * kBlock;
static_assert(kTile % (kBlock * kMaxStep_px) == 0 && 2 * kApron % kBlock == 0);
using BlockValues = float[kBlockSamples];

/// By sample, colours of splats times their weights. `visible` sums the opacity that is seen and
/// `distance` the distances, where the sweep needs them.
struct alignas(64) ColorSums {
  BlockValues red, green, blue, visible, distance;
};

/// An open layer. The colours are those of splats that arrived before the layer was opaque.
struct alignas(64) Sums : ColorSums {
  BlockValues weight;       // of all splats, later ones too
  BlockValues lens_weight;  // of all splats, without their tilt
  // `lens_weight` times lens points; without a lens, `weight` times the centres' offsets over the
  // supports' radii.
  BlockValues mean_x, mean_y;
  // `lens_weight` by the lens points of each splat with x > 0, with y > 0, and with both; unused
  // without a lens.
  BlockValues right, above, right_above;
  BlockValues blocked_x, blocked_y;  // `visible` times lens points; unused without a lens
};

/// By sample, the composited light and the transmittance of all closed layers.
struct alignas(64) Light {
  BlockValues transmittance;
  BlockValues red, green, blue, distance;
  BlockValues blocked_x, blocked_y;  // lens points times the share of the light blocked there
  BlockValues partial;               // largest share of the light that a layer covers in part
  // An edge: of all layers on the lens (`findLensEdge`), or of most contrast in the pixel
  // (`findPixelEdge`).
  // Beyond a lens's edge `outside` passes; of a pixel's edge `outside` is the opacity and `edge_at`
  // the share.
  BlockValues edge_x, edge_y, edge_at, outside;
  BlockValues contrast;  // step of the transmittance at the edge, over the mean
};

/// The data of a block lie together. Arrays over the tile would lie a power of two apart and
/// compete for the same few cache lines.
struct alignas(64) Block {
  Sums facing, back_facing;  // the open layer, by the side of the surface that is seen
  BlockValues far_m;         // end of the open layer's z-range
  Light light;
  bool any_edge;  // some sample has an edge
  bool opaque;    // no sample passes light any more
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_BLOCK_INL_H
