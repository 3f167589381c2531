#include "results/io/table_writer.hpp"

#include <sys/mman.h>

namespace hapbench {

MemoryTable::~MemoryTable() {
  if (data_ != nullptr) ::munmap(data_, capacity_ * sizeof(double));
}

/// Doubles the capacity if `more` numbers do not fit. mremap moves pages within the address space without copying them.
bool MemoryTable::reserve(std::size_t more) noexcept {
  if (size_ + more <= capacity_) return complete_;
  constexpr std::size_t kFirstNumbers = std::size_t{1} << 15;
  const std::size_t capacity = capacity_ == 0 ? kFirstNumbers : 2 * capacity_;
  void* pages =
      data_ == nullptr
          ? ::mmap(nullptr, capacity * sizeof(double), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
          : ::mremap(data_, capacity_ * sizeof(double), capacity * sizeof(double), MREMAP_MAYMOVE);
  if (pages == MAP_FAILED) return complete_ = false;
  data_ = static_cast<double*>(pages);
  capacity_ = capacity;
  return complete_;
}

}  // namespace hapbench
