// SPDX-License-Identifier: Apache-2.0
// The program's operator new: big blocks get huge pages where the system gives them on request. A bake touches each of
// its arrays but a few times, so that a fault for each 4 KiB takes as long as a pass.
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20;
constexpr std::size_t big = 2 * huge_page;  // below it, the last page's rest would be too great a part

void* allocate(std::size_t size) {
  if (size < big) return std::malloc(size > 0 ? size : 1);
  if (size > SIZE_MAX - huge_page) return nullptr;
  void* block = std::aligned_alloc(huge_page, (size + huge_page - 1) / huge_page * huge_page);
  if (block) madvise(block, size / huge_page * huge_page, MADV_HUGEPAGE);  // a wish: without it all works the same
  return block;
}

}  // namespace

void* operator new(std::size_t size) {
  for (;;) {
    if (void* block = allocate(size)) return block;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* block) noexcept {
  std::free(block);
}

void operator delete(void* block, std::size_t) noexcept {
  std::free(block);
}
