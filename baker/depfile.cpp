// SPDX-License-Identifier: Apache-2.0
// Escapes as GCC's -MD does, which all readers understand.
#include "depfile.h"

#include <set>

#include "error.h"

namespace chandelier::baker {
namespace {

std::string escaped(const std::filesystem::path& path) {
  std::string out;
  const std::string text = path.string();
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') fail(text, "a depfile cannot name a file with a line break");
    if (c == ' ' || c == '\t' || c == '#') {
      // Backslashes before it are doubled, or they would escape the one that is added.
      for (size_t b = i; b > 0 && text[b - 1] == '\\'; --b) out += '\\';
      out += '\\';
    }
    if (c == '$') out += '$';
    out += c;
  }
  return out;
}

}  // namespace

std::string depfile_text(const std::filesystem::path& target, const std::vector<std::filesystem::path>& inputs) {
  std::string rule = escaped(target) + ":", empty_rules;
  std::set<std::string> seen;
  for (const std::filesystem::path& input : inputs) {
    const std::string name = escaped(input);
    if (!seen.insert(name).second) continue;
    rule += " \\\n  " + name;
    empty_rules += name + ":\n";  // so that Make bakes again when a file is gone, instead of missing a rule for it
  }
  return rule + "\n" + empty_rules;
}

}  // namespace chandelier::baker
