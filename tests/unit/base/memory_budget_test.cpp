#include "base/memory_budget.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci {
namespace FOCI_FILE {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

std::string refusal(MemoryBudget& budget, std::uint64_t count, std::uint64_t bytes_each) {
  try {
    budget.take(count, bytes_each, "its textures");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MemoryBudget, OfSmallInputsStaysBelowTwoGigabytes) {
  EXPECT_LE(MemoryBudget("a", 10'000'000).left(), 1'200'000'000u);
  EXPECT_GE(MemoryBudget("a", 0).left(), std::min(256 * kMiB, memoryOfMachine() / 2));
}

TEST(MemoryBudget, GrowsWithTheInputUpToTheMemoryOfTheMachine) {
  EXPECT_GT(MemoryBudget("a", 2 * kMiB).left(), MemoryBudget("a", kMiB).left());
  EXPECT_LE(MemoryBudget("a", kMost).left(), memoryOfMachine() / 4 * 3);
  EXPECT_GT(MemoryBudget("a", kMost).left(), MemoryBudget("a", kMiB).left());
}

TEST(MemoryBudget, RefusesTheTotalOfManyParts) {
  MemoryBudget budget("a.obj", 1000);
  const std::uint64_t all = budget.left(), part = all / 8;
  for (int i = 0; i < 8; ++i) EXPECT_EQ(refusal(budget, part, 1), "") << i;
  EXPECT_EQ(refusal(budget, part, 1),
            "a.obj: its textures would take 604 MB of memory in all: expected at most 537 MB for "
            "1.0 kB of input");
  budget.giveBack(part);
  EXPECT_EQ(refusal(budget, part, 1), "");
}

TEST(MemoryBudget, ProductsThatOverflowAreRefused) {
  MemoryBudget budget("a", 1000);
  const std::uint64_t before = budget.left();
  EXPECT_NE(refusal(budget, std::uint64_t{1} << 61, 8), "");  // 2^64 is 0 in 64 bits
  EXPECT_NE(refusal(budget, kMost, kMost), "");
  EXPECT_NE(refusal(budget, before / 4 + 1, 4), "");
  EXPECT_EQ(budget.left(), before);
  EXPECT_EQ(refusal(budget, kMost, 0), "");
}

TEST(MemoryBudget, CountsTheFilesOfAnInput) {
  const TemporaryFolder folder;
  const auto file = folder.write("a", std::string(100'000, 'a'));
  MemoryBudget budget(file);
  const std::uint64_t one = budget.left();
  budget.addFile(file);
  EXPECT_EQ(budget.left() - one, 64u * 100'000u);
  budget.addFile("/dev/zero");
  budget.addFile(folder.path());
  budget.addFile(folder.path() / "absent");
  EXPECT_EQ(budget.left() - one, 64u * 100'000u);
}

}  // namespace FOCI_FILE
}  // namespace foci
