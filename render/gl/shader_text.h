// The texts of the compute shaders, which the build compiles in, and the sizes of their dispatches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <string_view>

namespace foci {

/// The text of the compute shader `stage`, a file of shaders/ without its ending, with the files
/// that it shares with others.
/// @param defines  lines that choose its variant
std::string shaderText(const std::string& stage, const std::string& defines);

/// Whether a stage knows that each direction has its own lens (shaders/field.glsl): its variant
/// `FIELD`.
bool readsField(std::string_view stage);

/// @param stage  a file of shaders/ without its ending; must exist (asserted)
std::string shaderSource(const std::string& stage);

/// Groups of `each` that `count` threads or elements need.
inline std::size_t groupsOf(std::size_t count, std::size_t each) {
  return (count + each - 1) / each;
}

/// Work groups in a row: kGroupsARow of shaders/frame.glsl.
inline constexpr std::size_t kGroupsARow = 1024;

/// Rows of work groups, since drivers limit each dimension; the last row may have some too many. As
/// an indirect dispatch takes them; its last number is unused.
inline glm::uvec4 rowsOf(std::size_t groups) {
  return {std::min(groups, kGroupsARow), groupsOf(groups, kGroupsARow), 1, 0};
}

}  // namespace foci
