// A vector of what a function gives for each element of a range.
#pragma once

#include <functional>
#include <iterator>
#include <type_traits>
#include <vector>

namespace foci {

/// @param function  of an element, or a pointer to a member of it
template <typename Range, typename Function>
auto transformed(Range&& range, const Function& function) {
  using Result = decltype(std::invoke(function, *std::begin(range)));
  std::vector<std::decay_t<Result>> all;
  all.reserve(std::size(range));
  for (auto&& each : range) all.push_back(std::invoke(function, each));
  return all;
}

}  // namespace foci
