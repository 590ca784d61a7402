// What a result was computed on.
#pragma once

#include <string>

namespace foci {

struct Machine {
  std::string cpu;     ///< "unknown" where the system does not say
  unsigned cores = 0;  ///< that this process may use
  std::string simd;    ///< the widest instruction set of the code in use, e.g. "AVX3"
  std::string system;  ///< kernel and release
};

Machine describeMachine();

}  // namespace foci
