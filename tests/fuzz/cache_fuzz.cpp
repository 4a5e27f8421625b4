// SPDX-License-Identifier: Apache-2.0
// Any bytes as a cache's entry: found and used, or a miss. What a geometry entry gives must pass a pack's checks.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "bake/geometry_cache.h"
#include "bake/image_cache.h"
#include "fuzz_file.h"
#include "mend_checksums.h"
#include "pack_checks.h"

namespace {

using namespace chandelier;

/// A folder for the one entry.
struct Folder {
  std::filesystem::path path;

  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "chandelier-fuzz-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

/// What the entry says that it is, and as much around it as it asks for; false where it is no pack.
bool look(const std::vector<uint8_t>& bytes, std::string& name, pack::Contents& around) {
  try {
    const fuzz::MemoryFile file(bytes);
    const pack::File entry(file.path());
    const std::string_view source = entry.text(entry.view().bake_info->source);
    name = source.substr(0, source.find('\n'));
    around.materials.assign(entry.view().materials.begin(), entry.view().materials.end());
    around.nodes.assign(entry.view().nodes.begin(), entry.view().nodes.end());
    around.skins.assign(entry.view().skins.begin(), entry.view().skins.end());
    around.joints.assign(entry.view().joints.begin(), entry.view().joints.end());
  } catch (const pack::Error&) {
    return false;
  }
  return !name.empty() && name.size() < 100 && name.find('/') == std::string::npos &&
         name.find('\0') == std::string::npos;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Folder folder;
  std::vector<uint8_t> bytes(data, data + size);
  fuzz::mend_checksums(bytes);
  std::string name;
  pack::Contents pack;
  if (!look(bytes, name, pack)) name = "broken";
  const std::filesystem::path path = folder.path / (name + ".chandelier");
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));

  baker::Cache cache(folder.path);
  baker::Report report;
  baker::Strings strings(pack.strings);
  for (pack::Material& material : pack.materials) material.name = strings.add("material");
  for (pack::Node& node : pack.nodes) node.name = strings.add("node");
  for (pack::Skin& skin : pack.skins) skin.name = strings.add("skin");
  if (baker::load_geometry(cache, name, report, strings, pack)) {
    const std::string fault = pack::check(pack::view_of(pack));
    if (!fault.empty()) {
      std::fprintf(stderr, "a used entry breaks the pack: %s\n", fault.c_str());
      std::abort();
    }
  }
  baker::MadeImages made;
  for (const size_t requests : {1, 2}) baker::load_images(cache, name, 1, requests, made);
  std::filesystem::remove(path);
  return 0;
}
