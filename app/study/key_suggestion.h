// "Did you mean" for the keys of a study: near in spelling or in meaning, or nothing.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foci {

/// The known key that the user may have meant.
/// @param unknown  "section.key" or "key"
/// @param known    all keys
std::optional<std::string> suggestedKey(std::string_view unknown,
                                        const std::vector<std::string>& known);

/// The sections of the keys, in their order.
std::vector<std::string> sectionsOf(const std::vector<std::string>& known);

}  // namespace foci
