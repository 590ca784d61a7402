#include "base/large_array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace foci {
namespace FOCI_FILE {

TEST(LargeArray, HoldsEveryElementOfSmallAndOfLargeArrays) {
  for (const std::size_t n :
       {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{3000001}}) {
    const auto array = makeLargeArray<std::uint64_t>(n);
    ASSERT_NE(array, nullptr);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.get()) % 64, 0u) << n;
    for (std::size_t i = 0; i < n; ++i) array[i] = 3 * i;
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(array[i], 3 * i);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
