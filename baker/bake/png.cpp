// SPDX-License-Identifier: Apache-2.0
// PNG (ISO/IEC 15948) as a row of chunks: length, type, data, CRC-32. All that the decoder would complain about on
// stderr is found here first.
#include "png.h"

#include <zlib.h>

#include <new>

#include "../error.h"
#include "decode.h"

namespace chandelier::baker {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kSignatureBytes = 8;
constexpr std::uint8_t kGrey = 0, kRgb = 2, kPalette = 3, kGreyAlpha = 4, kRgba = 6;

std::uint32_t u32_at(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | bytes[3];
}

struct Chunk {
  std::string type;
  const std::uint8_t* data;
  std::size_t size;
};

struct Header {
  std::uint32_t width, height;
  std::uint8_t depth, color, interlaced;
};

std::vector<Chunk> split_chunks(const Bytes& bytes, const std::string& where) {
  if (bytes.size() < kSignatureBytes) fail(where, "PNG is cut short (" + std::to_string(bytes.size()) + " bytes)");
  std::vector<Chunk> out;
  for (std::size_t at = kSignatureBytes;;) {
    // 12: length, type and checksum
    if (bytes.size() - at < 12 || bytes.size() - at - 12 < u32_at(&bytes[at])) {
      fail(where, "PNG is cut short (" + std::to_string(bytes.size()) + " bytes)");
    }
    const std::size_t size = u32_at(&bytes[at]);
    const std::string type(&bytes[at + 4], &bytes[at + 4] + 4);
    if (crc32_z(0, &bytes[at + 4], size + 4) != u32_at(&bytes[at + 8 + size])) {
      fail(where, "PNG is damaged: the checksum of chunk " + type + " at byte " + std::to_string(at) + " is wrong");
    }
    out.push_back({type, &bytes[at + 8], size});
    if (type == "IEND") return out;
    at += size + 12;
  }
}

[[noreturn]] void damaged(const std::string& where, const std::string& what, std::uint64_t value) {
  fail(where, "PNG is damaged: " + what + " (" + std::to_string(value) + ")");
}

/// Table 11.1: the bit depths of a colour type.
bool allows(std::uint8_t color, std::uint8_t depth) {
  if (color == kGrey) return depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
  if (color == kPalette) return depth == 1 || depth == 2 || depth == 4 || depth == 8;
  return (color == kRgb || color == kGreyAlpha || color == kRgba) && (depth == 8 || depth == 16);
}

Header read_header(const Chunk& chunk, const std::string& where) {
  if (chunk.type != "IHDR" || chunk.size != 13) damaged(where, "it does not begin with IHDR, 13 bytes", chunk.size);
  const std::uint8_t* d = chunk.data;
  const Header header{u32_at(d), u32_at(d + 4), d[8], d[9], d[12]};
  check_image_size(header.width, header.height, where);
  if (!allows(header.color, header.depth)) damaged(where, "its colour type allows no such bit depth", header.depth);
  if (d[10] != 0) damaged(where, "unknown compression", d[10]);
  if (d[11] != 0) damaged(where, "unknown filter method", d[11]);
  if (d[12] > 1) damaged(where, "unknown interlace method", d[12]);
  return header;
}

/// Bytes of each row of the filtered image: of all rows, or of the seven passes' (Table 8.1).
std::vector<std::size_t> row_sizes(const Header& header) {
  const std::size_t channels = header.color == kRgba        ? 4
                               : header.color == kRgb       ? 3
                               : header.color == kGreyAlpha ? 2
                                                            : 1;
  const auto row_bytes = [&](std::size_t width) { return 1 + (width * channels * header.depth + 7) / 8; };
  if (!header.interlaced) return std::vector<std::size_t>(header.height, row_bytes(header.width));
  static constexpr std::size_t kPasses[7][4] = {
      {0, 8, 0, 8}, {4, 8, 0, 8}, {0, 4, 4, 8}, {2, 4, 0, 4},
      {0, 2, 2, 4}, {1, 2, 0, 2}, {0, 1, 1, 2}};  // first x, step, first y, step
  std::vector<std::size_t> out;
  for (const auto& [x, x_step, y, y_step] : kPasses) {
    const std::size_t width = (header.width + x_step - 1 - x) / x_step;
    const std::size_t height = (header.height + y_step - 1 - y) / y_step;
    if (width > 0) out.insert(out.end(), height, row_bytes(width));
  }
  return out;
}

/// Inflates the chunks of image data, a row at a time.
class Inflater {
 public:
  Inflater(const std::vector<Chunk>& chunks, const std::string& where) : chunks_(chunks), where_(where) {
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  void read(Bytes& row, std::size_t number) {
    inflate_to(row);
    if (stream_.avail_out > 0) damaged(where_, "its data ends in row", number);
  }

  /// What follows the last row is of no use, but a wrong checksum says that the rows are not what they were.
  void finish() {
    Bytes more(1);
    inflate_to(more);
    if (stream_.avail_out > 0 && !ended_) damaged(where_, "its data ends without a checksum, bytes", stream_.total_in);
  }

 private:
  /// As much as there is.
  void inflate_to(Bytes& out) {
    stream_.next_out = out.data();
    stream_.avail_out = static_cast<uInt>(out.size());
    while (stream_.avail_out > 0 && !ended_) {
      if (stream_.avail_in == 0) {
        if (next_ == chunks_.size()) return;
        stream_.next_in = const_cast<std::uint8_t*>(chunks_[next_].data);
        stream_.avail_in = static_cast<uInt>(chunks_[next_++].size);
        continue;
      }
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (result != Z_OK && result != Z_STREAM_END) {
        damaged(where_, "its data cannot be inflated after byte", stream_.total_in);
      }
      ended_ = result == Z_STREAM_END;
    }
  }

  const std::vector<Chunk>& chunks_;
  const std::string& where_;
  z_stream stream_ = {};
  std::size_t next_ = 0;
  bool ended_ = false;
};

void check_rows(const Header& header, const std::vector<Chunk>& data, const std::string& where) {
  Inflater inflater(data, where);
  Bytes row;
  const std::vector<std::size_t> sizes = row_sizes(header);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    row.resize(sizes[i]);
    inflater.read(row, i);
    if (row[0] > 4) damaged(where, "row " + std::to_string(i) + " has an unknown filter", row[0]);
  }
  inflater.finish();
}

/// Whether the texels need a chunk that is not image data.
bool is_needed(const Chunk& chunk, const Header& header) {
  if (chunk.type == "PLTE") return header.color == kPalette;  // else only a suggestion
  return chunk.type == "tRNS" && header.color != kGreyAlpha && header.color != kRgba;
}

void check_needed(const Chunk& chunk, const Header& header, std::size_t palette_colors, const std::string& where) {
  const bool palette = chunk.type == "PLTE";
  const std::size_t most = std::size_t{1} << header.depth;
  const bool fits = palette ? palette_colors == 0 && chunk.size > 0 && chunk.size % 3 == 0 && chunk.size / 3 <= most
                    : header.color == kPalette ? chunk.size > 0 && chunk.size <= palette_colors
                                               : chunk.size == (header.color == kGrey ? 2u : 6u);
  if (!fits) damaged(where, "chunk " + chunk.type + " has a wrong size or place", chunk.size);
}

void append(const Chunk& chunk, Bytes& out) {
  const std::uint8_t* begin = chunk.data - 8;
  out.insert(out.end(), begin, begin + chunk.size + 12);
}

}  // namespace

std::vector<std::uint8_t> essential_png(const std::vector<std::uint8_t>& bytes, const std::string& where) {
  const std::vector<Chunk> chunks = split_chunks(bytes, where);
  const Header header = read_header(chunks[0], where);
  Bytes out(bytes.begin(), bytes.begin() + kSignatureBytes);
  append(chunks[0], out);
  std::vector<Chunk> data;
  std::size_t palette_colors = 0;
  bool transparent = false;
  for (const Chunk& chunk : chunks) {
    if (chunk.type == "IDAT") data.push_back(chunk);
    if (!data.empty() || !is_needed(chunk, header) || (chunk.type == "tRNS" && transparent)) continue;
    check_needed(chunk, header, palette_colors, where);
    if (chunk.type == "PLTE") palette_colors = chunk.size / 3;
    transparent = transparent || chunk.type == "tRNS";
    append(chunk, out);
  }
  if (header.color == kPalette && palette_colors == 0)
    damaged(where, "no palette before its data, colour type", kPalette);
  check_rows(header, data, where);
  for (const Chunk& chunk : data) append(chunk, out);
  append(chunks.back(), out);
  return out;
}

std::uint64_t png_texels(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kWidth = kSignatureBytes + 8, kHeight = kWidth + 4;  // IHDR is the first chunk
  return bytes.size() < kHeight + 4 ? 0 : std::uint64_t{u32_at(&bytes[kWidth])} * u32_at(&bytes[kHeight]);
}

}  // namespace chandelier::baker
