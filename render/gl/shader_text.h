// The texts of the compute shaders.
#pragma once

#include <string>

namespace foci {

/// The text of the compute shader `stage`, a file of shaders/ without its ending, with the files
/// that it shares with others.
/// @param defines  lines that choose its variant
std::string shaderText(const std::string& stage, const std::string& defines);

}  // namespace foci
