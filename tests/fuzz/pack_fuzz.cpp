// SPDX-License-Identifier: Apache-2.0
// Any bytes as a pack: opened and read in full, or refused with pack::Error. Checksums are made right first, so that
// what lies behind them is reached.
#include <vector>

#include "fuzz_file.h"
#include "mend_checksums.h"
#include "pack_file.h"
#include "pack_images.h"

namespace {

using namespace chandelier;

/// Reads every byte of every section and image: where one is not there, the sanitizer says so.
uint64_t sum_of(const pack::File& file) {
  uint64_t sum = 0;
  for (size_t i = 0; i < pack::section_infos.size(); ++i) {
    for (const std::byte byte : pack::section_bytes(file.view(), i)) sum += static_cast<uint64_t>(byte);
  }
  for (uint32_t i = 0; i < file.view().images.size(); ++i) {
    try {
      for (const std::byte byte : pack::texels_of(file.view(), i).bytes()) sum += static_cast<uint64_t>(byte);
    } catch (const pack::Error&) {
    }
  }
  for (const pack::Instance& instance : file.view().instances) sum += file.text(instance.name).size();
  return sum;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<uint8_t> bytes(data, data + size);
  fuzz::mend_checksums(bytes);
  const fuzz::MemoryFile file(bytes);
  try {
    const volatile uint64_t sum = sum_of(pack::File(file.path()));
    (void)sum;
  } catch (const pack::Error&) {
  }
  return 0;
}
