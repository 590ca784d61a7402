// The machine that a result was computed on.
#pragma once

#include <string>

namespace foci {

struct Machine {
  std::string cpu;     ///< "unknown" if the system does not state it
  unsigned cores = 0;  ///< that this process may use
  std::string simd;    ///< instruction set that the code uses, e.g. "AVX3"
  std::string system;  ///< kernel and release
};

Machine describeMachine();

}  // namespace foci
