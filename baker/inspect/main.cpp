// SPDX-License-Identifier: Apache-2.0
// chandelier-inspect: says what is in a pack, or what is wrong with it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "pack_images.h"
#include "summary.h"

namespace {

constexpr const char* footer = R"(Examples:
  chandelier-inspect sponza.chandelier              sections, totals, images, cameras
  chandelier-inspect sponza.chandelier --lights     every light too
  chandelier-inspect sponza.chandelier --json       everything, for machines

Exit status: 0 if the pack is intact, 1 if it is not or cannot be read, 2 for a wrong command line.)";

bool put(const std::string& text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string path;
  bool json = false, lights = false;
  CLI::App app("Says what is in a Chandelier pack.", "chandelier-inspect");
  app.footer(footer);
  app.add_option("PACK", path, "The pack to look into")->required();
  app.add_flag("--json", json, "Write one JSON object");
  app.add_flag("--lights", lights, "List every light (--json always does)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    using namespace chandelier;
    const pack::File file{path};
    try {
      pack::check_images(file.view());
    } catch (const pack::Error& error) {
      throw pack::Error(path + ": " + error.what());
    }
    if (put(json ? inspect::json_report(path, file) : inspect::text_report(path, file, lights))) return 0;
    std::fprintf(stderr, "chandelier-inspect: error: cannot write to standard output\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "chandelier-inspect: error: %s\n", error.what());
  }
  return 1;
}
