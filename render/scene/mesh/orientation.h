// Which side of a mesh's triangles is outside.
#pragma once

#include <cstddef>

namespace foci {

struct TriangleMesh;

/// Winds all triangles of a connected surface alike, as most of its area was wound, and a surface
/// that bounds a solid counter-clockwise from outside. Files often have it the other way round, and
/// the renderer would then take the far side of a solid for its near side.
///
/// Two triangles are connected where they alone share an edge, by its positions. A surface bounds a
/// solid if its open edges could frame at most a tenth of its area. A solid around all other
/// surfaces is a room, and stays as it was wound.
///
/// Numbers the surfaces without a hole or a seam that bound a solid: `TriangleMesh::body`.
///
/// @return the number of triangles that were turned
std::size_t orientOutwards(TriangleMesh& mesh);

}  // namespace foci
