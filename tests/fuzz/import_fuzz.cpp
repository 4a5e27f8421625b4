// SPDX-License-Identifier: Apache-2.0
// Any bytes as a glTF: baked, or refused with baker::Error. What is baked passes the pack's own checks.
#include "bake/bake.h"
#include "fuzz_file.h"
#include "import/import.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace chandelier;
  const fuzz::MemoryFile file({data, size});
  try {
    baker::Scene scene;
    baker::Warnings warnings;
    baker::Report report;
    baker::import_gltf(file.path(), scene, warnings);
    baker::check(baker::bake(std::move(scene), {}, baker::Progress(false), report, warnings), report);
  } catch (const baker::Error&) {
  }
  return 0;
}
