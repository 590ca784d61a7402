#include "tests/fuzz/harness.h"

#include <sanitizer/allocator_interface.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "base/input_error.h"
#include "tests/temporary_folder.h"

namespace foci::fuzz {
namespace {

constexpr double kMax_s = 1.0;
constexpr std::size_t kMaxPerByte = 4, kMaxExtra = std::size_t{256} << 20;

std::atomic<std::int64_t> held{0}, max_held{0};

void onMalloc(const volatile void*, std::size_t size) {
  const std::int64_t now = held += static_cast<std::int64_t>(size);
  std::int64_t max_so_far = max_held;
  while (now > max_so_far && !max_held.compare_exchange_weak(max_so_far, now)) {
  }
}

void onFree(const volatile void* at) {
  if (at != nullptr) {
    held -= static_cast<std::int64_t>(__sanitizer_get_allocated_size(const_cast<void*>(at)));
  }
}

double processorTime_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void giveUp(const char* what, double value) {
  std::fprintf(stderr, "foci fuzz: %s: %g\n", what, value);
  std::abort();
}

}  // namespace

std::filesystem::path asFile(const std::string& name, const std::uint8_t* bytes, std::size_t size) {
  static const TemporaryFolder folder(access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
  const std::filesystem::path path = folder.path() / name;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(bytes, 1, size, file) != size || std::fclose(file) != 0) {
    giveUp("no room for the input, bytes", static_cast<double>(size));
  }
  return path;
}

void readWithinLimits(std::size_t size, const std::function<void()>& read) {
  // With one thread, the same input always takes the same path.
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  static const int installed = __sanitizer_install_malloc_and_free_hooks(onMalloc, onFree);
  if (installed == 0) giveUp("no room for hooks", 0.0);
  const std::int64_t before = held;
  max_held = before;
  const double start_s = processorTime_s();
  try {
    read();
  } catch (const InputError&) {
  }
  const double took_s = processorTime_s() - start_s;
  if (took_s > kMax_s) giveUp("a hang, seconds", took_s);
  const auto took = static_cast<std::size_t>(max_held - before);
  if (took > kMaxPerByte * size + kMaxExtra) {
    giveUp("too much memory, bytes", static_cast<double>(took));
  }
}

}  // namespace foci::fuzz
