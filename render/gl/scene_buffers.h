// The buffers of a `GpuScene`, as the shaders read them.
#pragma once

#include "render/gl/buffer.h"
#include "render/gl/scene.h"

namespace foci {

struct GpuScene::Buffers {
  GpuBuffer surfels_a, surfels_b;  // (position, opacity), (u, area); (v, body), (colour, 0)
  GpuBuffer node_places;           // (position, radius)
  GpuBuffer nodes;       // variance xx xy xz yy, (yz, zz, density, own|opacity), (colour, normal)
  GpuBuffer coarseness;  // now, min, `LodNode::added_m2`, packed normal
  GpuBuffer facing;      // body | cos_cone, where there are bodies
  GpuBuffer shapes;      // the table of kernel.h: k0, k1, k2, support2
};

}  // namespace foci
