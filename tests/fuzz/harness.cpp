#include "tests/fuzz/harness.h"

#include <sanitizer/allocator_interface.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>

#include "base/input_error.h"
#include "render/scene/io/foci_container.h"
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

std::map<std::string, Fuzzer>& fuzzers() {
  static std::map<std::string, Fuzzer> all;
  return all;
}

Fuzzer chosen() {
  compare_foci_checksums = false;
  const char* const name = std::getenv("FOCI_FUZZER");
  const auto found = fuzzers().find(name == nullptr ? "" : name);
  if (found != fuzzers().end()) return found->second;
  std::fprintf(stderr, "foci fuzz: FOCI_FUZZER=%s: expected one of", name == nullptr ? "" : name);
  for (const auto& each : fuzzers()) std::fprintf(stderr, " %s", each.first.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace

Known::Known(const std::string& name, Fuzzer fuzzer) { fuzzers().emplace(name, fuzzer); }

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

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const foci::fuzz::Fuzzer fuzzer = foci::fuzz::chosen();
  return fuzzer(bytes, size);
}
