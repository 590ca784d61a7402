// A mesh file in the words that Assimp 5.2 reads. Private to the readers of meshes.
#pragma once

#include <string>
#include <vector>

namespace foci {

struct MendedFile {
  std::string text;                  ///< the file as Assimp has to read it; empty: as it is
  std::vector<std::string> remarks;  ///< what the user should know
};

}  // namespace foci
