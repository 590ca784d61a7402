// Gaussians in a `.foci` file (foci_file.h), with their tree.
#pragma once

#include <filesystem>

#include "render/scene/io/foci_container.h"
#include "render/scene/io/foci_file.h"

namespace foci {

/// @param scene  of Gaussians with a tree (asserted)
/// @throws std::runtime_error if the file cannot be written
void writeFociGaussians(const std::filesystem::path& path, const PreparedScene& scene);

/// @param file  of version kFociGaussians. @throws InputError
PreparedScene readFociGaussians(const FociContainer& file);

}  // namespace foci
