#include "render/scene/mesh/orientation.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "render/scene/mesh/triangle_mesh.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace {

/// Open edges of a solid could frame at most this share of its area.
constexpr double kHoles = 0.1;

/// A box that reaches this share of the mesh's size close to the mesh's box is around it all.
constexpr float kAround = 1e-3f;

struct Edge {
  glm::vec3 from, to;  // the lesser end first
  std::uint32_t triangle;
  bool forwards;  // along the triangle's winding
};

/// The edges of all triangles; equal ones lie together.
std::vector<Edge> sortedEdges(const TriangleMesh& mesh) {
  std::vector<Edge> edges(3 * mesh.size());
  parallelFor(mesh.size(), [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 a = mesh.corners_m[3 * t + k], b = mesh.corners_m[3 * t + (k + 1) % 3];
      const bool forwards = precedes(a, b);
      edges[3 * t + k] = {forwards ? a : b, forwards ? b : a, static_cast<std::uint32_t>(t),
                          forwards};
    }
  });
  parallelSort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    if (a.from != b.from) return precedes(a.from, b.from);
    if (a.to != b.to) return precedes(a.to, b.to);
    return a.triangle < b.triangle;
  });
  return edges;
}

/// Triangles joined into surfaces. Each knows whether it is wound as the surface's first triangle.
class Surfaces {
 public:
  explicit Surfaces(std::size_t triangles) : parent_(triangles), turned_(triangles, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /// The first triangle of the surface, and whether `triangle` is wound the other way round.
  std::pair<std::uint32_t, bool> find(std::uint32_t triangle) {
    std::uint32_t root = triangle;
    std::uint8_t turned = 0;
    for (; parent_[root] != root; root = parent_[root]) turned ^= turned_[root];
    std::uint8_t left = turned;  // of the path from here on
    for (std::uint32_t at = triangle; parent_[at] != root && at != root;) {
      const std::uint32_t next = parent_[at];
      const std::uint8_t step = turned_[at];
      parent_[at] = root;
      turned_[at] = left;
      left ^= step;
      at = next;
    }
    return {root, turned != 0};
  }

  /// Joins two neighbours. A surface with one side, such as a Moebius strip, keeps a seam.
  /// @return whether there is no seam between them
  bool join(std::uint32_t a, std::uint32_t b, bool alike) {
    const auto [root_a, turned_a] = find(a);
    const auto [root_b, turned_b] = find(b);
    if (root_a == root_b) return (turned_a == turned_b) == alike;
    const auto [first, second] = std::minmax(root_a, root_b);
    parent_[second] = first;
    turned_[second] = static_cast<std::uint8_t>(turned_a ^ turned_b ^ !alike);
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> turned_;  // against the parent
};

/// Sums over the triangles of a surface, wound as its first one.
struct Surface {
  std::array<double, 2> area_m2{};  // of those wound as the first one was, and of the others
  double open_m = 0.0;              // length of the open edges
  bool closed = true;               // two triangles share each edge, without a seam
  glm::dvec3 normals_m2{0.0};       // sum of the normals, times the areas
  glm::dvec3 moment_m3{0.0};        // sum of the centres, times the areas
  double volume_m3 = 0.0;           // from the origin
  glm::vec3 low_m{std::numeric_limits<float>::max()};
  glm::vec3 high_m{std::numeric_limits<float>::lowest()};

  void add(const glm::vec3* corners_m, bool turned) {
    const glm::dvec3 a(corners_m[0]), b(corners_m[1]), c(corners_m[2]);
    const glm::dvec3 normal = (turned ? -0.5 : 0.5) * glm::cross(b - a, c - a);
    const double area = glm::length(normal);
    area_m2[turned] += area;
    normals_m2 += normal;
    moment_m3 += area * (a + b + c) / 3.0;
    volume_m3 += glm::dot(a, normal) / 3.0;
    for (int k = 0; k < 3; ++k) {
      low_m = glm::min(low_m, corners_m[k]);
      high_m = glm::max(high_m, corners_m[k]);
    }
  }

  double area() const { return area_m2[0] + area_m2[1]; }

  bool isSolid() const {
    return open_m * open_m < 4.0 * std::numbers::pi * kHoles * area();  // a circle frames the most
  }

  /// The volume from the surface's centre, so that a hole counts little.
  double ownVolume() const { return volume_m3 - glm::dot(moment_m3 / area(), normals_m2) / 3.0; }
};

/// Whether to turn the triangles that are wound as the surface's first one.
bool turnsFirst(const Surface& surface, bool around_all) {
  const bool rare = surface.area_m2[1] > surface.area_m2[0];
  if (!surface.isSolid() || around_all) return rare;
  return surface.ownVolume() < 0.0;
}

/// A triangle's edge that joins it to no other.
struct OpenEdge {
  std::uint32_t triangle;
  double length_m;  // 0: the triangle is not alone, but it shares the edge with several, or a seam
};

/// Joins the triangles where two alone share an edge. Adds the other edges to `open`.
Surfaces connected(const TriangleMesh& mesh, std::vector<OpenEdge>& open) {
  const std::vector<Edge> edges = sortedEdges(mesh);
  Surfaces surfaces(mesh.size());
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    const Edge& edge = edges[i];
    while (end < edges.size() && edges[end].from == edge.from && edges[end].to == edge.to) ++end;
    if (end - i == 1) open.push_back({edge.triangle, glm::distance(edge.from, edge.to)});
    for (std::size_t k = i; end - i > 2 && k < end; ++k) open.push_back({edges[k].triangle, 0.0});
    if (end - i != 2) continue;
    const Edge& other = edges[i + 1];
    if (!surfaces.join(edge.triangle, other.triangle, edge.forwards != other.forwards)) {
      open.push_back({edge.triangle, 0.0});
    }
  }
  return surfaces;
}

}  // namespace

std::size_t orientOutwards(TriangleMesh& mesh) {
  std::vector<OpenEdge> open;
  Surfaces surfaces = connected(mesh, open);
  std::vector<std::uint32_t> number(mesh.size());  // of the surface, at its first triangle
  std::vector<Surface> all;
  Surface whole;
  for (std::uint32_t t = 0; t < mesh.size(); ++t) {
    const auto [first, turned] = surfaces.find(t);
    if (first == t) {
      number[t] = static_cast<std::uint32_t>(all.size());
      all.emplace_back();
    }
    for (Surface* const surface : {&all[number[first]], &whole}) {
      surface->add(&mesh.corners_m[3 * std::size_t{t}], turned);
    }
  }
  for (const auto& [triangle, length_m] : open) {
    Surface& surface = all[number[surfaces.find(triangle).first]];
    surface.open_m += length_m;
    surface.closed = false;
  }

  const glm::vec3 margin = kAround * (whole.high_m - whole.low_m);
  std::size_t count = 0, bodies = 0;
  mesh.body.assign(mesh.size(), 0);
  mesh.surface.resize(mesh.size());
  for (std::uint32_t t = 0; t < mesh.size(); ++t) {
    const auto [first, turned] = surfaces.find(t);
    const Surface& surface = all[number[first]];
    mesh.surface[t] = number[first];
    const bool around_all = all.size() > 1 &&
                            glm::all(glm::lessThanEqual(surface.low_m, whole.low_m + margin)) &&
                            glm::all(glm::greaterThanEqual(surface.high_m, whole.high_m - margin));
    if (first != t) {
      mesh.body[t] = mesh.body[first];
    } else if (surface.closed && !around_all && bodies < kMaxBodies) {
      mesh.body[t] = static_cast<std::uint16_t>(++bodies);
    }
    if (turnsFirst(surface, around_all) == turned) continue;
    const std::size_t second = 3 * std::size_t{t} + 1, third = second + 1;
    std::swap(mesh.corners_m[second], mesh.corners_m[third]);
    std::swap(mesh.uv[second], mesh.uv[third]);
    if (!mesh.color.empty()) std::swap(mesh.color[second], mesh.color[third]);
    if (!mesh.alpha.empty()) std::swap(mesh.alpha[second], mesh.alpha[third]);
    ++count;
  }
  return count;
}

}  // namespace foci
