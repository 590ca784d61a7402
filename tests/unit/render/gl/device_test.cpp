#include "render/gl/device.h"

#include <gtest/gtest.h>

#include <thread>

#include "render/gl/buffer.h"
#include "tests/unit/render/gl/lost_context.h"
#include "tests/unit/render/gl/test_device.h"

namespace foci {
namespace FOCI_FILE {

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const GpuError& error) {
    return error.what();
  }
  return {};
}

TEST(GpuDevice, NamesItselfAndItsDriver) {
  FOCI_NEEDS_GPU(device);
  EXPECT_FALSE(device->name().empty());
  EXPECT_NE(device->driver().find("4."), std::string::npos) << device->driver();
  EXPECT_EQ(device->text(), device->name() + ", driver " + device->driver());
  EXPECT_GE(device->maxBlock_bytes(), std::size_t{1} << 27);
}

TEST(GpuDevice, OneLineNamesAShaderThatDoesNotCompile) {
  FOCI_NEEDS_GPU(device);
  const GpuDevice::Use use(*device);
  const std::string message = messageOf([&] { device->program("cut", "no such word\n"); });
  EXPECT_NE(message.find("shader cut"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(GpuDevice, OneLineSaysHowMuchMemoryIsMissing) {
  FOCI_NEEDS_GPU(device);
  const GpuDevice::Use use(*device);
  GpuBuffer buffer;
  const std::string message =
      messageOf([&] { buffer.reserve(*device, device->maxBlock_bytes() + 1, "the surfels"); });
  EXPECT_NE(message.find("the surfels need"), std::string::npos) << message;
  EXPECT_NE(message.find("MiB"), std::string::npos) << message;
}

TEST(GpuDevice, OneLineSaysThatItsMemoryIsFullAndTheDeviceGoesOn) {
  FOCI_NEEDS_GPU(device);
  const GpuDevice::Use use(*device);
  GpuBuffer buffer;
  const std::string message = messageOf([&] {
    buffer.reserve(*device, std::size_t{1} << 44, "the surfels", GpuBuffer::Kind::windowed);
  });
  EXPECT_NE(message.find("the surfels need 16777216 MiB"), std::string::npos) << message;
  EXPECT_NE(message.find("no such room left"), std::string::npos) << message;
  buffer.reserve(*device, sizeof(unsigned), "a number");
  buffer.fill(7, sizeof(unsigned));
  unsigned read = 0;
  buffer.read(0, sizeof read, &read);
  EXPECT_EQ(read, 7u);
  EXPECT_NO_THROW(device->check());
}

TEST(GpuDevice, ALostContextIsAnErrorForEveryUse) {
  const LosableDevice device = losableDevice();
  if (!device.gpu) GTEST_SKIP() << "no OpenGL 4.5 on this machine";
  auto buffer = std::make_unique<GpuBuffer>();
  {
    const GpuDevice::Use use(*device.gpu);
    buffer->reserve(*device.gpu, 16, "a number");
  }
  *device.lost = true;
  const std::string message = messageOf([&] { const GpuDevice::Use use(*device.gpu); });
  EXPECT_NE(message.find("its OpenGL context is lost"), std::string::npos) << message;
  buffer.reset();  // frees nothing, and throws nothing
}

TEST(GpuDevice, AnyThreadMayUseItOneAtATime) {
  FOCI_NEEDS_GPU(device);
  const auto writeAndRead = [&](unsigned value) {
    const GpuDevice::Use use(*device);
    GpuBuffer buffer;
    buffer.reserve(*device, sizeof value, "a number");
    buffer.write(0, sizeof value, &value);
    unsigned read = 0;
    buffer.read(0, sizeof read, &read);
    EXPECT_EQ(read, value);
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i <= 4; ++i) threads.emplace_back(writeAndRead, i);
  for (std::thread& thread : threads) thread.join();
}

}  // namespace FOCI_FILE
}  // namespace foci
