// SPDX-License-Identifier: Apache-2.0
// Every record that shaders share with C++ goes through a compute shader, field by field, and comes back the same.
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "frame_echo_list.h"
#include "gpu/pipelines.h"
#include "gpu_test.h"
#include "pack_echo_list.h"

namespace chandelier::test {
namespace {

constexpr uint32_t record_count = 37;  // not a multiple of anything: an array stride that is off shows

// Words that differ from each other and are finite, normal numbers where a field reads them as floats: the bits of NaNs
// and denormals are not kept by every device.
std::vector<uint32_t> distinct_words(size_t count) {
  std::mt19937 random(static_cast<uint32_t>(count));
  std::vector<uint32_t> words(count);
  for (uint32_t& word : words) {
    do word = static_cast<uint32_t>(random());
    while (!std::isnormal(std::bit_cast<float>(word)));
  }
  return words;
}

class EchoTest : public GpuTest {
 protected:
  void expect_echo(const char* name, uint32_t record_bytes, const gpu::Shader& shader) {
    SCOPED_TRACE(name);
    ASSERT_EQ(record_bytes % 4, 0u);
    const auto before = distinct_words(size_t{record_count} * record_bytes / 4);
    const gpu::Buffer in =
        gpu::upload_buffer(device(), std::as_bytes(std::span(before)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const gpu::Buffer out = gpu::make_buffer(device(), size_t{record_count} * record_bytes,
                                             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::readback);
    std::memset(out.mapped, 0xEE, out.size_bytes);
    const auto pipeline = gpu::make_compute_pipeline(device(), shader);
    gpu::run_once(device(), [&](gpu::Commands cmd) {
      gpu::bind(cmd, pipeline, {{"Before", gpu::storage(in)}, {"After", gpu::storage(out)}});
      gpu::dispatch(cmd, device(), pipeline, in.size_bytes / record_bytes);
      gpu::memory_barrier(cmd, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                          VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    });
    std::vector<uint32_t> after(before.size());
    std::memcpy(after.data(), out.mapped, after.size() * 4);
    EXPECT_EQ(after, before);
  }
};

#define CHANDELIER_ECHO_TEST(record, size)     \
  TEST_F(EchoTest, record) {                   \
    expect_echo(#record, size, record##_comp); \
  }
CHANDELIER_PACK_ECHO_RECORDS(CHANDELIER_ECHO_TEST)
CHANDELIER_FRAME_ECHO_RECORDS(CHANDELIER_ECHO_TEST)

}  // namespace
}  // namespace chandelier::test
