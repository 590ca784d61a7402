// Which foci this is.
#pragma once

#include <string>

namespace foci {

/// "0.1.0 (27f854f62c)": version and commit. `-dirty` marks sources that differ from the commit;
/// without git there is no commit.
std::string versionText();

}  // namespace foci
