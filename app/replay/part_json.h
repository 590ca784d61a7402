// The frames of a part as JSON. Numbers have every digit, so they read back to the same bits.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/replay/part.h"

namespace foci {

nlohmann::ordered_json jsonOf(const PartFrame& frame);

/// @throws nlohmann::json::exception, std::runtime_error
PartFrame partFrameOf(const nlohmann::ordered_json& json);

}  // namespace foci
