// The footprint of a surfel or of a node on the image, before blur: its variance, its area and its
// depth (Eq. 5 to 8). Included once a SIMD target.
#if defined(FOCI_FOOTPRINT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_FOOTPRINT_INL_H
#undef FOCI_FOOTPRINT_INL_H
#else
#define FOCI_FOOTPRINT_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "render/kernel/simd-inl.h"
#include "render/splat/constants.h"

#ifndef FOCI_FOOTPRINT_ONCE
#define FOCI_FOOTPRINT_ONCE
namespace foci {

/// Surfels in memory, three floats a vector.
struct SurfelArrays {
  const float* position;
  const float* axis_u;
  const float* axis_v;
  const float* area;
  const float* color;
  const float* opacity;       // null: all opaque
  const std::uint16_t* body;  // `ClosedBodies::of_surfel`; null: there are no bodies
};

/// Up to 16 nodes of the level-of-detail tree, as a structure of arrays.
struct NodeArrays {
  static constexpr std::size_t kCapacity = 16;
  alignas(64) float position[3][kCapacity];
  alignas(64) float variance[6][kCapacity];
  alignas(64) float normal[2][kCapacity];                // packed, see `packNormal`
  alignas(64) float density[kCapacity], own[kCapacity];  // see `LodNode`
};

}  // namespace foci
#endif  // FOCI_FOOTPRINT_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
/// Derivatives of a point's image and distance by its place in the world.
struct Gradients {
  V3 x, y;      // pixels a metre
  V3 distance;  // metres a metre
};

/// Surfels or nodes on the image, one in each SIMD lane.
struct Footprint {
  V vxx, vxy, vyy;  // variance on the image, unblurred and without the prefilter, px^2
  V area;           // on the image, px^2
  V along2;         // variance along the distance, m^2
  V thick2;         // lower bound of that variance, m^2
  V widest2;        // upper bound of the rendered variance along any direction, m^2
  V own;            // share of the variance that is rendered (`LodNode::own`)
  V3 normal;        // unit length
  V3 slant;         // n / (n p), a metre: by so much the area falls as the eye moves
};

HWY_INLINE V3 positionOf(const SurfelArrays& surfels, std::size_t i) {
  return load3(surfels.position + 3 * i);
}

/// @param p  from the eye, metres
HWY_INLINE Footprint footprintOf(const SurfelArrays& surfels, std::size_t i, const V3& p,
                                 const Gradients& to) {
  const D d;
  const V3 u = load3(surfels.axis_u + 3 * i), v = load3(surfels.axis_v + 3 * i);
  const V ux = dot(to.x, u), uy = dot(to.y, u), vx = dot(to.x, v), vy = dot(to.y, v);
  const V u_along = dot(to.distance, u), v_along = dot(to.distance, v);
  const V uu = dot(u, u), vv = dot(v, v);
  const V inv_parallelogram = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Mul(uu, vv)));
  const V3 normal = cross(u, v);
  Footprint f;
  f.vxx = hn::MulAdd(ux, ux, hn::Mul(vx, vx));
  f.vyy = hn::MulAdd(uy, uy, hn::Mul(vy, vy));
  f.vxy = hn::MulAdd(ux, uy, hn::Mul(vx, vy));
  // Area |det J| over the parallelogram of the axes.
  const V det_j = hn::Abs(hn::NegMulAdd(uy, vx, hn::Mul(ux, vy)));
  f.area = hn::Mul(hn::LoadU(d, surfels.area + i), hn::Mul(det_j, inv_parallelogram));
  f.along2 = hn::MulAdd(u_along, u_along, hn::Mul(v_along, v_along));
  // A surfel counts as at least as thick as it is wide, because samples of a scanned surface
  // scatter about the surface.
  f.thick2 = hn::Max(uu, vv);
  f.widest2 = f.thick2;
  f.own = hn::Set(d, 1.0f);
  f.normal = scaled(normal, inv_parallelogram);
  const V towards = dot(f.normal, p);
  const V least = hn::Max(hn::Abs(towards), hn::Set(d, 1e-20f));
  f.slant = scaled(f.normal, hn::Div(hn::Set(d, 1.0f), hn::CopySign(least, towards)));
  return f;
}

HWY_INLINE V3 positionOf(const NodeArrays& nodes, std::size_t) {
  const D d;
  return {hn::Load(d, nodes.position[0]), hn::Load(d, nodes.position[1]),
          hn::Load(d, nodes.position[2])};
}

/// The SIMD form of `unpackNormal`.
HWY_INLINE V3 unpackNormals(const NodeArrays& nodes) {
  const D d;
  const V scale = hn::Set(d, 1.0f / 32767.0f);
  const V x = hn::Mul(scale, hn::Load(d, nodes.normal[0]));
  const V y = hn::Mul(scale, hn::Load(d, nodes.normal[1]));
  const V z = hn::Sub(hn::Sub(hn::Set(d, 1.0f), hn::Abs(x)), hn::Abs(y));
  const V fold = hn::Max(hn::Neg(z), hn::Zero(d));
  const V3 n{hn::Sub(x, hn::CopySign(fold, x)), hn::Sub(y, hn::CopySign(fold, y)), z};
  const V inv = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(dot(n, n)));
  return {hn::Mul(n.x, inv), hn::Mul(n.y, inv), hn::Mul(n.z, inv)};
}

/// The area of a node is density sqrt(p' adj(V) p) up to a factor (`LodNode`), so its slant is
/// adj(V) p / (p' adj(V) p): n / (n p) of a flat node, and finite where a curved one is seen from
/// its side.
HWY_INLINE Footprint footprintOf(const NodeArrays& nodes, std::size_t, const V3& p,
                                 const Gradients& to) {
  const D d;
  const V xx = hn::Load(d, nodes.variance[0]), xy = hn::Load(d, nodes.variance[1]);
  const V xz = hn::Load(d, nodes.variance[2]), yy = hn::Load(d, nodes.variance[3]);
  const V yz = hn::Load(d, nodes.variance[4]), zz = hn::Load(d, nodes.variance[5]);
  const auto times = [&](const V3& a) {
    return V3{hn::MulAdd(xx, a.x, hn::MulAdd(xy, a.y, hn::Mul(xz, a.z))),
              hn::MulAdd(xy, a.x, hn::MulAdd(yy, a.y, hn::Mul(yz, a.z))),
              hn::MulAdd(xz, a.x, hn::MulAdd(yz, a.y, hn::Mul(zz, a.z)))};
  };
  const V3 x = times(to.x);
  Footprint f;
  f.vxx = dot(to.x, x);
  f.vxy = dot(to.y, x);
  f.vyy = dot(to.y, times(to.y));
  const V det = hn::NegMulAdd(f.vxy, f.vxy, hn::Mul(f.vxx, f.vyy));
  f.area = hn::Mul(hn::Load(d, nodes.density), hn::Sqrt(hn::Max(det, hn::Zero(d))));
  f.along2 = dot(to.distance, times(to.distance));
  const V own = hn::Load(d, nodes.own);
  f.widest2 = hn::Mul(own, hn::Add(xx, hn::Add(yy, zz)));
  f.thick2 = hn::Mul(hn::Set(d, 0.5f), f.widest2);
  f.own = own;
  f.normal = unpackNormals(nodes);
  const auto minor = [](V a, V b, V c, V e) { return hn::NegMulAdd(c, e, hn::Mul(a, b)); };
  const V axx = minor(yy, zz, yz, yz), ayy = minor(xx, zz, xz, xz), azz = minor(xx, yy, xy, xy);
  const V axy = minor(xz, yz, xy, zz), axz = minor(xy, yz, xz, yy), ayz = minor(xy, xz, yz, xx);
  const V3 q{dot({axx, axy, axz}, p), dot({axy, ayy, ayz}, p), dot({axz, ayz, azz}, p)};
  const V trace = hn::Add(axx, hn::Add(ayy, azz));
  const V size = hn::Add(xx, hn::Add(yy, zz));
  const V least =
      hn::Mul(dot(p, p), hn::MulAdd(hn::Set(d, kLeastCos2), trace,
                                    hn::Mul(hn::Set(d, kRounding), hn::Mul(size, size))));
  const V seen = hn::Max(dot(q, p), hn::Max(least, hn::Set(d, 1e-36f)));
  f.slant = scaled(q, hn::Div(hn::Set(d, 1.0f), seen));
  return f;
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_FOOTPRINT_INL_H
