// Studies and their replays, and the warnings that they raise.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace foci {

/// Raises a UserWarning.
void warn(const std::string& text);

void bindStudy(pybind11::module_& module);

}  // namespace foci
