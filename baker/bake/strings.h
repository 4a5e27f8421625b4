// SPDX-License-Identifier: Apache-2.0
// Pass: names into the pack's strings section, equal ones stored once.
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

#include "../error.h"
#include "pack_schema.h"

namespace chandelier::baker {

class Strings {
 public:
  explicit Strings(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  pack::StringRef add(const std::string& text) {
    const auto [it, added] = known_.try_emplace(text);
    if (added) {
      it->second = {fit_u32(bytes_.size(), "bytes of names"), fit_u32(text.size(), "bytes of names")};
      const auto* data = reinterpret_cast<const std::byte*>(text.data());
      bytes_.insert(bytes_.end(), data, data + text.size());
      fit_u32(bytes_.size(), "bytes of names");
    }
    return it->second;
  }

 private:
  std::vector<std::byte>& bytes_;
  std::unordered_map<std::string, pack::StringRef> known_;
};

}  // namespace chandelier::baker
