// Triangle meshes as files hold them.
#pragma once

#include "render/scene/io/scene_facts.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

/// All triangles of a mesh file, in its units, with the nodes' transforms applied. Triangles are
/// turned to the side of the file's own normals if it has some. Vertex colours are sRGB, but linear
/// in glTF. Alpha cuts holes or makes surfaces transparent, as glTF states; in other files, a
/// texture's alpha below 0.5 is a hole, and so is the mask of an OBJ.
///
/// A texture that cannot be read, or has more than 2^26 pixels, and a file of materials that cannot
/// be read are named in the mesh's remarks. The material's colour then shows.
struct MeshFile {
  TriangleMesh mesh;
  SceneFacts facts;  ///< but the positions and the remarks, which the mesh has
};

}  // namespace foci
