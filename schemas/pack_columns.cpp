// SPDX-License-Identifier: Apache-2.0
// Records rearranged so that zstd compresses them better: the content of sections with the codec columns, before zstd.
#include "pack_columns.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

namespace chandelier::pack {
namespace {

constexpr size_t word = 4;

struct ColumnHead {
  Layout layout;
  uint8_t scaled;    // 1: the words are integers that stand for floats of 2^exponent each
  int16_t exponent;  // below the largest an integer may have, so that no float overflows
};
static_assert(sizeof(ColumnHead) == word);

constexpr int lowest_exponent = -149, highest_exponent = 96;

using Words = std::vector<uint32_t>;

Words column_of(std::span<const std::byte> records, size_t stride, size_t column) {
  Words words(records.size() / stride);
  const std::byte* at = records.data() + column * word;
  for (size_t i = 0; i < words.size(); ++i, at += stride) std::memcpy(&words[i], at, word);
  return words;
}

/// The exponent of the lowest set bit of all, if each is 0 or a normal float. Not -0, whose sign an integer lacks.
std::optional<int> common_exponent(const Words& words) {
  int lowest = highest_exponent;
  for (const uint32_t bits : words) {
    if (bits == 0) continue;
    const uint32_t biased = bits >> 23 & 0xff;
    if (biased == 0 || biased == 0xff) return {};
    const uint32_t mantissa = (bits & 0x7fffff) | 0x800000;
    lowest = std::min(lowest, static_cast<int>(biased) - 150 + std::countr_zero(mantissa));
  }
  return std::max(lowest, lowest_exponent);
}

/// Replaces floats by multiples of 2^exponent if each comes back bit for bit.
bool scale(Words& words, int exponent) {
  Words scaled(words.size());
  const double factor = std::ldexp(1.0, -exponent);
  for (size_t i = 0; i < words.size(); ++i) {
    const double value = static_cast<double>(std::bit_cast<float>(words[i])) * factor;
    if (!(std::abs(value) < 0x1p31)) return false;
    scaled[i] = static_cast<uint32_t>(static_cast<int32_t>(value));
    const double back = static_cast<double>(static_cast<int32_t>(scaled[i])) / factor;
    if (std::bit_cast<uint32_t>(static_cast<float>(back)) != words[i]) return false;
  }
  words = std::move(scaled);
  return true;
}

void unscale(std::span<uint32_t> words, int exponent) {
  const double factor = std::ldexp(1.0, exponent);
  for (uint32_t& bits : words) {
    bits = std::bit_cast<uint32_t>(static_cast<float>(static_cast<double>(static_cast<int32_t>(bits)) * factor));
  }
}

void take_differences(Words& words) {
  uint32_t before = 0;
  for (uint32_t& value : words) {
    const uint32_t difference = value - before;
    before = value;
    value = (difference << 1) ^ (0u - (difference >> 31));
  }
}

void add_differences(std::span<uint32_t> words) {
  uint32_t sum = 0;
  for (uint32_t& value : words) value = sum += (value >> 1) ^ (0u - (value & 1));
}

void put_planes(const Words& words, std::byte* to) {
  for (size_t plane = 0; plane < word; ++plane) {
    for (const uint32_t value : words) *to++ = static_cast<std::byte>(value >> 8 * plane);
  }
}

void get_planes(const std::byte* from, std::span<uint32_t> words) {
  const size_t n = words.size();
  for (size_t i = 0; i < n; ++i) {
    words[i] = static_cast<uint32_t>(from[i]) | static_cast<uint32_t>(from[n + i]) << 8 |
               static_cast<uint32_t>(from[2 * n + i]) << 16 | static_cast<uint32_t>(from[3 * n + i]) << 24;
  }
}

void put_strided(std::span<const uint32_t> words, std::byte* to, size_t stride) {
  for (const uint32_t value : words) {
    std::memcpy(to, &value, word);
    to += stride;
  }
}

void get_strided(const std::byte* from, size_t stride, std::span<uint32_t> words) {
  for (uint32_t& value : words) {
    std::memcpy(&value, from, word);
    from += stride;
  }
}

}  // namespace

size_t columns_bytes(size_t record_bytes, size_t stride) {
  return stride + record_bytes;  // a head of one word for each word of a record
}

std::vector<std::byte> to_columns(std::span<const std::byte> records, size_t stride, const Layouts& layouts) {
  const size_t n = records.size() / stride;
  const size_t kept_bytes = static_cast<size_t>(std::ranges::count(layouts, Layout::records)) * word;
  std::vector<std::byte> coded(columns_bytes(records.size(), stride));
  std::byte* kept = coded.data() + stride;
  std::byte* planes = kept + kept_bytes * n;
  for (size_t column = 0; column < layouts.size(); ++column) {
    Words words = column_of(records, stride, column);
    ColumnHead head{layouts[column], 0, 0};
    if (const std::optional<int> exponent = common_exponent(words); exponent && scale(words, *exponent)) {
      head.scaled = 1;
      head.exponent = static_cast<int16_t>(*exponent);
    }
    std::memcpy(coded.data() + column * word, &head, word);
    if (head.layout == Layout::records) {
      put_strided(words, kept, kept_bytes);
      kept += word;
      continue;
    }
    if (head.layout == Layout::delta_planes) take_differences(words);
    put_planes(words, planes);
    planes += n * word;
  }
  return coded;
}

bool from_columns(std::span<const std::byte> coded, size_t stride, std::span<std::byte> records) {
  if (coded.size() != columns_bytes(records.size(), stride)) return false;
  const size_t n = records.size() / stride;
  std::vector<ColumnHead> heads(stride / word);
  std::memcpy(heads.data(), coded.data(), stride);
  size_t kept_bytes = 0;
  for (const ColumnHead& head : heads) {
    if (static_cast<uint32_t>(head.layout) >= layout_count || head.scaled > 1 || head.exponent < lowest_exponent ||
        head.exponent > highest_exponent) {
      return false;
    }
    if (head.layout == Layout::records) kept_bytes += word;
  }
  const std::byte* kept = coded.data() + stride;
  const std::byte* planes = kept + kept_bytes * n;
  Words words(n);
  for (size_t column = 0; column < heads.size(); ++column) {
    if (heads[column].layout == Layout::records) {
      get_strided(kept, kept_bytes, words);
      kept += word;
    } else {
      get_planes(planes, words);
      planes += n * word;
    }
    if (heads[column].layout == Layout::delta_planes) add_differences(words);
    if (heads[column].scaled) unscale(words, heads[column].exponent);
    put_strided(words, records.data() + column * word, stride);
  }
  return true;
}

Layouts choose_layouts(std::span<const std::byte> records, size_t stride,
                       const std::function<size_t(std::span<const std::byte>)>& cost) {
  const auto cost_of = [&](const Layouts& layouts) { return cost(to_columns(records, stride, layouts)); };
  Layouts best;
  size_t best_cost = 0;
  const auto consider = [&](const Layouts& layouts) {
    const size_t now = cost_of(layouts);
    if (!best.empty() && now >= best_cost) return;
    best = layouts;
    best_cost = now;
  };
  for (const Layout layout : {Layout::records, Layout::planes, Layout::delta_planes}) {
    consider(Layouts(stride / word, layout));
  }
  for (size_t column = 0; column < stride / word; ++column) {
    const Layouts before = best;
    for (const Layout layout : {Layout::records, Layout::planes, Layout::delta_planes}) {
      Layouts changed = before;
      changed[column] = layout;
      if (changed != before) consider(changed);
    }
  }
  return best;
}

}  // namespace chandelier::pack
