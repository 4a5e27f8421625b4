// SPDX-License-Identifier: Apache-2.0
// Writes the sample pack to the path it is given, for tests in other languages.
#include <cstdio>

#include "pack_sample.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    chandelier::pack::write(argv[1], chandelier::pack::test::sample());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pack_write_sample: error: %s\n", error.what());
    return 1;
  }
}
