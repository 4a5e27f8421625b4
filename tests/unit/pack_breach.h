// SPDX-License-Identifier: Apache-2.0
// A rule of packs broken once, and what the reader must say of it.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "pack_checks.h"
#include "pack_sample.h"

namespace chandelier::pack::test {

struct Breach {
  const char* name;
  std::function<void(Contents&)> commit;
  const char* error;
};

inline void PrintTo(const Breach& breach, std::ostream* out) {
  *out << breach.name;
}

inline std::string name_of_breach(const testing::TestParamInfo<Breach>& each) {
  return each.param.name;
}

/// Both check() and who opens the file must say it.
inline void expect_named(const Breach& breach) {
  const Folder folder;
  Contents contents = sample();
  breach.commit(contents);
  write(folder / "a.pack", contents);
  EXPECT_EQ(open_error(folder / "a.pack"), breach.error);
  EXPECT_EQ(check(view_of(contents)), breach.error);
}

}  // namespace chandelier::pack::test
