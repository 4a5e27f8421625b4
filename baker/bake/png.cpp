// SPDX-License-Identifier: Apache-2.0
// PNG (ISO/IEC 15948) as a row of chunks: length, type, data, CRC-32. Everything that the decoder would report on
// stderr is found and repaired here first.
#include "png.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <new>

#include "../error.h"
#include "decode.h"

namespace chandelier::baker {
namespace {

using Bytes = std::vector<uint8_t>;

constexpr size_t signature_bytes = 8;
constexpr uint8_t grey_type = 0, rgb_type = 2, palette_type = 3, grey_alpha_type = 4, rgba_type = 6;

uint32_t u32_at(const uint8_t* bytes) {
  return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
}

struct Chunk {
  std::string type;
  const uint8_t* data;
  size_t size;
};

/// Keeps the first message only.
void note(std::string& damage, const std::string& what) {
  if (damage.empty()) damage = what;
}

struct Header {
  uint32_t width, height;
  uint8_t depth, color, interlaced;
};

/// 5.4: ancillary chunks may be left out.
bool is_critical(const std::string& type) {
  return type[0] >= 'A' && type[0] <= 'Z';
}

/// As in libpng, an ancillary chunk with a wrong checksum is dropped; a critical one is kept, except the header. If the
/// file is cut, the image data that is there is kept.
std::vector<Chunk> split_chunks(const Bytes& bytes, const std::string& where, std::string& damage) {
  std::vector<Chunk> out;
  const auto cut_short = [&] {
    const std::string what = "PNG is cut short (" + std::to_string(bytes.size()) + " bytes)";
    if (std::none_of(out.begin(), out.end(), [](const Chunk& chunk) { return chunk.type == "IDAT"; }))
      fail(where, what);
    note(damage, what);
    return out;
  };
  if (bytes.size() < signature_bytes) return cut_short();
  for (size_t at = signature_bytes;;) {
    if (bytes.size() - at < 8) return cut_short();
    const size_t size = u32_at(&bytes[at]), left = bytes.size() - at - 8;
    const std::string type(&bytes[at + 4], &bytes[at + 4] + 4);
    if (left < 4 || left - 4 < size) {
      if (type == "IDAT") out.push_back({type, &bytes[at] + 8, std::min(left, size)});
      return cut_short();
    }
    const bool right = crc32_z(0, &bytes[at + 4], size + 4) == u32_at(&bytes[at + 8 + size]);
    const std::string fault =
        "PNG is damaged: the checksum of chunk " + type + " at byte " + std::to_string(at) + " is wrong";
    if (!right && out.empty()) fail(where, fault);
    if (!right) note(damage, fault);
    if (right || is_critical(type)) out.push_back({type, &bytes[at + 8], size});
    if (type == "IEND") return out;
    at += size + 12;
  }
}

std::string fault(const std::string& what, uint64_t value) {
  return "PNG is damaged: " + what + " (" + std::to_string(value) + ")";
}

[[noreturn]] void damaged(const std::string& where, const std::string& what, uint64_t value) {
  fail(where, fault(what, value));
}

/// Table 11.1: the bit depths of a colour type.
bool allows(uint8_t color, uint8_t depth) {
  if (color == grey_type) return depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
  if (color == palette_type) return depth == 1 || depth == 2 || depth == 4 || depth == 8;
  return (color == rgb_type || color == grey_alpha_type || color == rgba_type) && (depth == 8 || depth == 16);
}

Header read_header(const Chunk& chunk, const std::string& where) {
  if (chunk.type != "IHDR" || chunk.size != 13)
    damaged(where, "its first chunk is not an IHDR of 13 bytes, size", chunk.size);
  const uint8_t* d = chunk.data;
  const Header header{u32_at(d), u32_at(d + 4), d[8], d[9], d[12]};
  check_image_size(header.width, header.height, where);
  if (!allows(header.color, header.depth)) damaged(where, "its colour type allows no such bit depth", header.depth);
  if (d[10] != 0) damaged(where, "unknown compression", d[10]);
  if (d[11] != 0) damaged(where, "unknown filter method", d[11]);
  if (d[12] > 1) damaged(where, "unknown interlace method", d[12]);
  return header;
}

/// Bytes of each row of the filtered image: of all rows, or of the seven passes' (Table 8.1).
std::vector<size_t> row_sizes(const Header& header) {
  const size_t channels = header.color == rgba_type         ? 4
                          : header.color == rgb_type        ? 3
                          : header.color == grey_alpha_type ? 2
                                                            : 1;
  const auto row_bytes = [&](size_t width) { return 1 + (width * channels * header.depth + 7) / 8; };
  if (!header.interlaced) return std::vector<size_t>(header.height, row_bytes(header.width));
  static constexpr size_t passes[7][4] = {{0, 8, 0, 8}, {4, 8, 0, 8}, {0, 4, 4, 8}, {2, 4, 0, 4},
                                          {0, 2, 2, 4}, {1, 2, 0, 2}, {0, 1, 1, 2}};  // first x, step, first y, step
  std::vector<size_t> out;
  for (const auto& [x, x_step, y, y_step] : passes) {
    const size_t width = (header.width + x_step - 1 - x) / x_step;
    const size_t height = (header.height + y_step - 1 - y) / y_step;
    if (width > 0) out.insert(out.end(), height, row_bytes(width));
  }
  return out;
}

/// Inflates the chunks of image data, a row at a time.
class Inflater {
 public:
  explicit Inflater(const std::vector<Chunk>& chunks) : chunks_(chunks) {
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// The fault, or an empty text.
  std::string read(Bytes& row, size_t number) {
    if (!inflate_to(row)) return fault("its data cannot be inflated after byte", stream_.total_in);
    return stream_.avail_out > 0 ? fault("its data ends in row", number) : "";
  }

  /// Data after the last row is not needed, but a wrong checksum shows that the rows have changed.
  std::string finish() {
    Bytes more(1);
    if (!inflate_to(more)) return fault("its data cannot be inflated after byte", stream_.total_in);
    return stream_.avail_out > 0 && !ended_ ? fault("its data ends without a checksum after byte", stream_.total_in)
                                            : "";
  }

 private:
  /// Inflates what is there; false if the stream is not valid.
  bool inflate_to(Bytes& out) {
    stream_.next_out = out.data();
    stream_.avail_out = static_cast<uInt>(out.size());
    while (stream_.avail_out > 0 && !ended_) {
      if (stream_.avail_in == 0) {
        if (next_ == chunks_.size()) return true;
        stream_.next_in = const_cast<uint8_t*>(chunks_[next_].data);
        stream_.avail_in = static_cast<uInt>(chunks_[next_++].size);
        continue;
      }
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) return false;
      ended_ = result == Z_STREAM_END;
    }
    return true;
  }

  const std::vector<Chunk>& chunks_;
  z_stream stream_ = {};
  size_t next_ = 0;
  bool ended_ = false;
};

struct Rows {
  size_t good = 0;    // rows from the first on
  std::string fault;  // of the next row or of the end of the data; empty if there is none
};

Rows check_rows(const std::vector<size_t>& sizes, const std::vector<Chunk>& data) {
  Inflater inflater(data);
  Rows out;
  Bytes row;
  for (; out.good < sizes.size(); ++out.good) {
    row.resize(sizes[out.good]);
    out.fault = inflater.read(row, out.good);
    if (out.fault.empty() && row[0] > 4) {
      out.fault = fault("row " + std::to_string(out.good) + " has an unknown filter", row[0]);
    }
    if (!out.fault.empty()) return out;
  }
  out.fault = inflater.finish();
  return out;
}

/// Compresses the good rows again; every other row repeats the one above it.
Bytes mended_rows(const std::vector<size_t>& sizes, size_t good, const std::vector<Chunk>& data) {
  constexpr uint8_t up_filter = 2;  // filter: what is added to the row above
  Inflater inflater(data);
  Bytes out, row, packed(size_t{1} << 16);
  z_stream stream = {};
  if (deflateInit(&stream, Z_BEST_SPEED) != Z_OK) throw std::bad_alloc();
  for (size_t i = 0; i < sizes.size(); ++i) {
    row.assign(sizes[i], 0);
    row[0] = up_filter;
    if (i < good) inflater.read(row, i);
    stream.next_in = row.data();
    stream.avail_in = static_cast<uInt>(row.size());
    do {
      stream.next_out = packed.data();
      stream.avail_out = static_cast<uInt>(packed.size());
      deflate(&stream, i + 1 == sizes.size() ? Z_FINISH : Z_NO_FLUSH);
      out.insert(out.end(), packed.begin(), packed.end() - static_cast<ptrdiff_t>(stream.avail_out));
    } while (stream.avail_out == 0);
  }
  deflateEnd(&stream);
  return out;
}

/// Whether the texels need a chunk that is not image data.
bool is_needed(const Chunk& chunk, const Header& header) {
  if (chunk.type == "PLTE") return header.color == palette_type;  // else only a suggestion
  return chunk.type == "tRNS" && header.color != grey_alpha_type && header.color != rgba_type;
}

bool fits(const Chunk& chunk, const Header& header, size_t palette_colors) {
  const bool palette = chunk.type == "PLTE";
  const size_t most = size_t{1} << header.depth;
  if (palette) return palette_colors == 0 && chunk.size > 0 && chunk.size % 3 == 0 && chunk.size / 3 <= most;
  if (header.color == palette_type) return chunk.size > 0 && chunk.size <= palette_colors;
  return chunk.size == (header.color == grey_type ? 2u : 6u);
}

/// Appends a chunk with its correct checksum.
void append(const std::string& type, const uint8_t* data, size_t size, Bytes& out) {
  const auto append_u32 = [&](uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(value >> shift));
  };
  append_u32(static_cast<uint32_t>(size));
  const size_t begin = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), data, data + size);
  append_u32(static_cast<uint32_t>(crc32_z(0, &out[begin], size + 4)));
}

void append(const Chunk& chunk, Bytes& out) {
  append(chunk.type, chunk.data, chunk.size, out);
}

/// The image data as it is, or repaired.
void append_data(const Header& header, const std::vector<Chunk>& data, size_t file_bytes, const std::string& where,
                 std::string& damage, Bytes& out) {
  const std::vector<size_t> sizes = row_sizes(header);
  const Rows rows = check_rows(sizes, data);
  const bool all = rows.good == sizes.size();
  if (!all && (rows.good == 0 || header.interlaced)) fail(where, rows.fault);  // later passes lie between the rows
  if (rows.fault.empty()) {
    for (const Chunk& chunk : data) append(chunk, out);
    return;
  }
  note(damage, rows.fault);
  if (has_no_picture({header.width, header.height}, file_bytes)) fail(where, damage);  // before gigabytes are allocated
  const Bytes mended = mended_rows(sizes, rows.good, data);
  constexpr size_t most_in_chunk = size_t{1} << 30;
  for (size_t at = 0; at < mended.size(); at += most_in_chunk) {
    append("IDAT", &mended[at], std::min(most_in_chunk, mended.size() - at), out);
  }
}

}  // namespace

std::vector<uint8_t> essential_png(const std::vector<uint8_t>& bytes, const std::string& where, std::string& damage) {
  const std::vector<Chunk> chunks = split_chunks(bytes, where, damage);
  const Header header = read_header(chunks[0], where);
  Bytes out(bytes.begin(), bytes.begin() + signature_bytes);
  append(chunks[0], out);
  std::vector<Chunk> data;
  size_t palette_colors = 0;
  bool transparent = false;
  for (const Chunk& chunk : chunks) {
    if (chunk.type == "IDAT") data.push_back(chunk);
    if (!data.empty() || !is_needed(chunk, header) || (chunk.type == "tRNS" && transparent)) continue;
    if (!fits(chunk, header, palette_colors)) {
      const std::string what = "chunk " + chunk.type + " has a wrong size or place";
      if (is_critical(chunk.type)) damaged(where, what, chunk.size);
      note(damage, fault(what, chunk.size));
      continue;
    }
    if (chunk.type == "PLTE") palette_colors = chunk.size / 3;
    transparent = transparent || chunk.type == "tRNS";
    append(chunk, out);
  }
  if (header.color == palette_type && palette_colors == 0)
    damaged(where, "it has no palette before its data, which it needs for colour type", palette_type);
  append_data(header, data, bytes.size(), where, damage, out);
  append("IEND", nullptr, 0, out);
  return out;
}

ClaimedSize png_size(const std::vector<uint8_t>& bytes) {
  constexpr size_t width_offset = signature_bytes + 8,
                   height_offset = width_offset + 4;  // IHDR is the first chunk
  return bytes.size() < height_offset + 4 ? ClaimedSize()
                                          : ClaimedSize{u32_at(&bytes[width_offset]), u32_at(&bytes[height_offset])};
}

}  // namespace chandelier::baker
