// SPDX-License-Identifier: Apache-2.0
// The codecs of sections and images. The encoded bytes are a sequence of zstd frames, one for each codec_chunk_bytes of
// records.
#include "pack_codec.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

#include "pack_columns.h"
#include "pack_triangles.h"
#include "parallel.h"

namespace chandelier::pack {
namespace {

// Levels of zstd. Records are few and compress well, so they get the highest level that needs no special memory; image
// data and text are large and gain little. Layouts are compared on a sample, with a faster level that ranks them the
// same.
constexpr int record_level = 19, byte_level = 9, trial_level = 9;
constexpr size_t sample_bytes = size_t{1} << 18;

constexpr size_t word = 4;

// zstd's frames without content start with this and a 32-bit size of what follows.
constexpr uint32_t filler_magic = 0x184D2A50;
constexpr size_t filler_head = 8;

using Bytes = std::span<const std::byte>;

template <typename T, size_t (*release)(T*)>
struct Release {
  void operator()(T* context) const { release(context); }
};
using Compressor = std::unique_ptr<ZSTD_CCtx, Release<ZSTD_CCtx, ZSTD_freeCCtx>>;
using Decompressor = std::unique_ptr<ZSTD_DCtx, Release<ZSTD_DCtx, ZSTD_freeDCtx>>;

/// Compresses into one frame that states its content's size.
std::vector<std::byte> compress(Bytes content, int level) {
  thread_local const Compressor context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  std::vector<std::byte> frame(ZSTD_compressBound(content.size()));
  const size_t size =
      ZSTD_compressCCtx(context.get(), frame.data(), frame.size(), content.data(), content.size(), level);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // the only way to fail with enough space
  frame.resize(size);
  return frame;
}

size_t chunk_records(size_t stride) {
  return std::max<size_t>(3, codec_chunk_bytes / stride / 3 * 3);  // whole triangles where records are corners
}

size_t chunk_count(size_t records, size_t stride) {
  return (records + chunk_records(stride) - 1) / chunk_records(stride);
}

template <typename Byte>
std::span<Byte> chunk_of(std::span<Byte> records, size_t stride, size_t chunk) {
  const size_t bytes = chunk_records(stride) * stride, first = chunk * bytes;
  return records.subspan(first, std::min(bytes, records.size() - first));
}

std::span<const uint32_t> words_of(Bytes bytes) {
  return {reinterpret_cast<const uint32_t*>(bytes.data()), bytes.size() / word};
}

// ---- Encoding

/// A section or an image that is being encoded.
struct Coding {
  size_t place;  // index into the result
  bool holds_corners;
  Bytes records;
  size_t stride;
  Codec codec = Codec::zstd;
  Layouts layouts = {};  // for Codec::columns
  std::vector<std::vector<std::byte>> frames = {};
  std::vector<uint32_t> vertices_before = {};  // for Codec::triangles: of each frame
};

/// Finds the codec that makes a sample from the middle smallest.
void choose_codec(Coding& coding) {
  if (coding.stride % word != 0) return;
  const auto cost = [](Bytes coded) { return compress(coded, trial_level).size(); };
  const size_t count = coding.records.size() / coding.stride;
  const size_t sampled = std::min(count, sample_bytes / coding.stride / 3 * 3 + 3);
  const size_t first = (count - sampled) / 2 / 3 * 3;
  const Bytes sample = coding.records.subspan(first * coding.stride, sampled * coding.stride);
  coding.codec = Codec::columns;
  coding.layouts = choose_layouts(sample, coding.stride, cost);
  if (!coding.holds_corners || !has_triangle_codec()) return;
  const auto corners = words_of(sample);
  const size_t columns_cost = cost(to_columns(sample, coding.stride, coding.layouts));
  const size_t triangles_cost = cost(to_triangle_code(corners, *std::ranges::min_element(corners)));
  if (triangles_cost < columns_cost) coding.codec = Codec::triangles;
}

/// Of each chunk one above the largest corner before it: the next vertex that its triangles use for the first time.
std::vector<uint32_t> vertices_before_chunks(const Coding& coding) {
  std::vector<uint32_t> before(coding.frames.size());
  for (size_t chunk = 1; chunk < before.size(); ++chunk) {
    const auto corners = words_of(chunk_of(coding.records, word, chunk - 1));
    before[chunk] = std::max(before[chunk - 1], *std::ranges::max_element(corners) + 1);
  }
  return before;
}

void encode_chunk(Coding& coding, size_t chunk) {
  const Bytes records = chunk_of(coding.records, coding.stride, chunk);
  std::vector<std::byte>& frame = coding.frames[chunk];
  if (coding.codec == Codec::zstd) {
    frame = compress(records, byte_level);
  } else if (coding.codec == Codec::columns) {
    frame = compress(to_columns(records, coding.stride, coding.layouts), record_level);
  } else {
    frame = compress(to_triangle_code(words_of(records), coding.vertices_before[chunk]), record_level);
  }
}

/// Appends a zstd frame without content, of at least its head, so that all that is stored has `bytes` or more.
void fill_up(std::vector<std::byte>& stored, size_t bytes) {
  if (stored.size() >= bytes) return;
  const size_t size = std::max(bytes - stored.size(), filler_head);
  const uint32_t head[2] = {filler_magic, static_cast<uint32_t>(size - filler_head)};
  const size_t at = stored.size();
  stored.resize(at + size);
  std::memcpy(&stored[at], head, filler_head);
}

/// Falls back to raw if the codec saves too little.
Encoded encoded_of(const Coding& coding) {
  Encoded encoded{coding.codec, {}};
  for (const auto& frame : coding.frames) encoded.bytes.insert(encoded.bytes.end(), frame.begin(), frame.end());
  fill_up(encoded.bytes, coding.records.size() / max_decode_ratio);
  const size_t raw_size = coding.records.size();
  return encoded.bytes.size() <= raw_size - raw_size / 20 ? encoded : Encoded{};
}

// ---- Decoding

/// Codes of one chunk may be this much longer than its records.
size_t coded_bound(Codec codec, size_t record_bytes, size_t stride) {
  if (codec == Codec::zstd) return record_bytes;
  return codec == Codec::columns ? columns_bytes(record_bytes, stride) : triangle_code_bound(record_bytes / word);
}

std::string decode_chunk(const Coded& each, Bytes frame, std::span<std::byte> records) {
  thread_local const Decompressor context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  const unsigned long long content = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (content > coded_bound(each.codec, records.size(), each.stride_bytes)) return "a frame of a wrong size";
  std::vector<std::byte> coded(each.codec == Codec::zstd ? 0 : content);
  const std::span<std::byte> target = each.codec == Codec::zstd ? records : std::span(coded);
  if (content != target.size()) return "a frame of a wrong size";
  const size_t got = ZSTD_decompressDCtx(context.get(), target.data(), target.size(), frame.data(), frame.size());
  if (ZSTD_isError(got)) return ZSTD_getErrorName(got);
  if (got != content) return "a frame of a wrong size";
  if (each.codec == Codec::columns && !from_columns(coded, each.stride_bytes, records)) return "malformed columns";
  if (each.codec == Codec::triangles &&
      !from_triangle_code(coded, {reinterpret_cast<uint32_t*>(records.data()), records.size() / word})) {
    return "malformed triangles";
  }
  return {};
}

/// One frame to decode.
struct Task {
  size_t number, chunk;  // index of the section or image, and of the frame in it
  Bytes frame;
};

/// Appends the frames, one per chunk. They must fill the stored bytes.
std::string find_frames(const Coded& each, size_t number, std::vector<Task>& tasks) {
  const size_t chunks = chunk_count(each.records.size() / each.stride_bytes, each.stride_bytes);
  Bytes rest = each.stored;
  for (size_t chunk = 0; chunk < chunks; ++chunk) {
    const size_t size = ZSTD_findFrameCompressedSize(rest.data(), rest.size());
    if (ZSTD_isError(size)) return ZSTD_getErrorName(size);
    tasks.push_back({number, chunk, rest.first(size)});
    rest = rest.subspan(size);
  }
  uint32_t head[2] = {};
  if (rest.size() >= filler_head) std::memcpy(head, rest.data(), filler_head);
  const bool filler = head[0] == filler_magic && head[1] == rest.size() - filler_head;
  return rest.empty() || filler ? "" : "bytes after the last frame";
}

/// Encodes in parallel and returns `count` results.
std::vector<Encoded> encode(std::vector<Coding> codings, size_t count, size_t most_threads) {
  parallel_for(codings.size(), most_threads, [&](size_t i) {
    Coding& coding = codings[i];
    coding.frames.resize(chunk_count(coding.records.size() / coding.stride, coding.stride));
    choose_codec(coding);
    if (coding.codec == Codec::triangles) coding.vertices_before = vertices_before_chunks(coding);
  });
  std::vector<std::pair<size_t, size_t>> chunks;  // of codings and their frames
  for (size_t i = 0; i < codings.size(); ++i) {
    for (size_t j = 0; j < codings[i].frames.size(); ++j) chunks.emplace_back(i, j);
  }
  parallel_for(chunks.size(), most_threads,
               [&](size_t i) { encode_chunk(codings[chunks[i].first], chunks[i].second); });
  std::vector<Encoded> encoded(count);
  for (const Coding& coding : codings) encoded[coding.place] = encoded_of(coding);
  return encoded;
}

}  // namespace

std::vector<Encoded> encode_sections(const View& view, size_t most_threads) {
  std::vector<Coding> codings;
  for (size_t i = 0; i < section_infos.size(); ++i) {
    const Bytes records = section_bytes(view, i);
    const auto& [kind, name, stride, is_always_raw] = section_infos[i];
    if (records.empty() || is_always_raw) continue;
    const bool corners = kind == Section::indices || kind == Section::voxel_indices;
    codings.push_back({i, corners && records.size() % (3 * word) == 0, records, stride});
  }
  return encode(std::move(codings), section_infos.size(), most_threads);
}

std::vector<Encoded> encode_images(std::span<const std::span<const std::byte>> images, size_t most_threads) {
  std::vector<Coding> codings;
  for (size_t i = 0; i < images.size(); ++i) {
    if (!images[i].empty()) codings.push_back({i, false, images[i], 1});
  }
  return encode(std::move(codings), images.size(), most_threads);
}

std::string coded_size_fault(Codec codec, uint32_t stride_bytes, uint64_t stored_bytes, uint64_t count) {
  if (codec == Codec::triangles && !has_triangle_codec()) {
    return "codec: triangles needs meshoptimizer, which this build lacks; bake without --compress";
  }
  const bool fits = codec == Codec::zstd || (codec == Codec::columns && stride_bytes % word == 0) ||
                    (codec == Codec::triangles && stride_bytes == word && count % 3 == 0);
  if (!fits) return "codec: " + std::string(name_of(codec)) + " is not for such records";
  if (count == 0 || stored_bytes == 0) return "count: " + std::to_string(count) + " records of no bytes";
  if (are_too_many(count, stride_bytes, stored_bytes)) {
    return "count: " + std::to_string(count) + " records of " + std::to_string(stride_bytes) +
           " bytes are too many for the stored " + std::to_string(stored_bytes);
  }
  return {};
}

std::vector<std::string> decode_all(std::span<const Coded> coded, size_t most_threads) {
  std::vector<std::string> faults(coded.size());
  std::vector<Task> tasks;
  for (size_t i = 0; i < coded.size(); ++i) faults[i] = find_frames(coded[i], i, tasks);
  std::vector<std::string> task_faults(tasks.size());
  parallel_for(tasks.size(), most_threads, [&](size_t i) {
    const Coded& each = coded[tasks[i].number];
    if (!faults[tasks[i].number].empty()) return;
    task_faults[i] = decode_chunk(each, tasks[i].frame, chunk_of(each.records, each.stride_bytes, tasks[i].chunk));
  });
  for (size_t i = tasks.size(); i-- > 0;) {
    if (!task_faults[i].empty()) faults[tasks[i].number] = task_faults[i];
  }
  return faults;
}

}  // namespace chandelier::pack
