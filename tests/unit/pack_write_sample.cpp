// SPDX-License-Identifier: Apache-2.0
// Writes the sample pack to the path it is given, for tests in other languages; with `compressed`
// as a second argument compressed; with `sheet` or `points` the compressed sheet, with its triangles or without.
#include <cstdio>
#include <string>

#include "pack_sample.h"

namespace {

void write_named(const char* path, const std::string& name) {
  using namespace chandelier::pack;
  if (name == "sample") return write(path, test::sample());
  if (name == "compressed") return write(path, test::sample(), Compression::smallest);
  Contents sheet = test::sheet(name == "points" ? 100 : 300);
  if (name == "points") sheet.indices.clear();
  write(path, sheet, Compression::smallest);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) return 2;
  try {
    write_named(argv[1], argc == 3 ? argv[2] : "sample");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pack_write_sample: error: %s\n", error.what());
    return 1;
  }
}
