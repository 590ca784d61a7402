#include "app/platform/version.h"

#include "app/platform/commit.h"  // written by commit.cmake in each build

namespace foci {

std::string versionText() {
  const std::string commit = FOCI_COMMIT;
  return commit.empty() ? FOCI_VERSION : FOCI_VERSION " (" + commit + ")";
}

}  // namespace foci
