// SPDX-License-Identifier: Apache-2.0
// Choosing a device, and that the validation layer is heard.
#include <volk.h>

#include <cctype>

#include "gpu/resources.h"
#include "gpu_test.h"

namespace chandelier::test {
namespace {

TEST_F(GpuTest, UnknownDeviceIsRefusedWithWhatThereIs) {
  const auto devices = gpu::list_devices();
  ASSERT_FALSE(devices.empty());
  try {
    gpu::Device device({.device = "no such maker"});
    FAIL() << "opened " << device.name;
  } catch (const gpu::Error& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find("'no such maker'"), std::string::npos) << line;
    for (const auto& there_is : devices) EXPECT_NE(line.find(there_is.name), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST_F(GpuTest, DevicesAreFoundByNumberAndByPartOfTheirNameInAnyCase) {
  const auto devices = gpu::list_devices();
  for (size_t i = 0; i < devices.size(); ++i) {
    if (!devices[i].unfit.empty()) continue;
    EXPECT_EQ(gpu::Device({.device = std::to_string(i)}).name, devices[i].name);
    std::string shouted = devices[i].name.substr(0, 5);
    for (char& c : shouted) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    EXPECT_EQ(gpu::Device({.device = shouted}).name.substr(0, 5), devices[i].name.substr(0, 5));
  }
}

// Without this, silence in the other tests would prove nothing: a copy into a buffer right after another one, no
// barrier between them, is a hazard that only synchronization validation reports.
TEST(ValidationTest, HazardsAreReported) {
  gpu::Device device({.device = {}, .validation = true});
  {
    constexpr VkBufferUsageFlags copied = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    const gpu::Buffer from = gpu::make_buffer(device, 256, copied, gpu::Memory::device);
    const gpu::Buffer to = gpu::make_buffer(device, 256, copied, gpu::Memory::device);
    const VkBufferCopy all{.size = 256};
    gpu::run_once(device, [&](gpu::Commands cmd) {
      cmd->vkCmdCopyBuffer(cmd, from.handle, to.handle, 1, &all);
      cmd->vkCmdCopyBuffer(cmd, to.handle, from.handle, 1, &all);
    });
  }
  ASSERT_FALSE(device.validation_messages().empty());
  EXPECT_NE(device.validation_messages()[0].find("HAZARD"), std::string::npos) << device.validation_messages()[0];
}

}  // namespace
}  // namespace chandelier::test
