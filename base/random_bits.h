// Random numbers that depend on a counter alone, so that they are the same at any number of
// threads.
#pragma once

#include <cstdint>

namespace foci {

/// 64 well-mixed bits of a counter: the finaliser of SplitMix64 (Steele, Lea and Flood, Fast
/// Splittable Pseudorandom Number Generators, OOPSLA 2014).
inline std::uint64_t randomBits(std::uint64_t counter) {
  std::uint64_t z = (counter + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace foci
