#include "results/io/table_writer.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cassert>
#include <new>

#include "results/io/json_text.hpp"

namespace hapbench {

CsvWriter::CsvWriter(std::filesystem::path file, std::string_view header)
    : file_(std::move(file)), columns_(static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1) {
  file_.append(header);
  file_.append("\n");
}

void CsvWriter::put(double value) noexcept {
  begin_cell();
  file_.append(NumberText(value));
}

void CsvWriter::put(std::uint64_t value) noexcept {
  begin_cell();
  file_.append(NumberText(value));
}

void CsvWriter::put(const std::optional<double>& value) noexcept {
  if (value) {
    put(*value);
  } else {
    begin_cell();
  }
}

void CsvWriter::put(std::string_view text) noexcept {
  begin_cell();
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    file_.append(text);
    return;
  }
  // Quoted, with quotes inside doubled.
  file_.append("\"");
  for (const char& c : text) {
    if (c == '"') file_.append("\"");
    file_.append({&c, 1});
  }
  file_.append("\"");
}

void CsvWriter::cells(std::span<const Cell> cells) {
  cells_ = 0;
  for (const Cell& cell : cells) {
    if (const auto* count = std::get_if<std::uint64_t>(&cell)) put(*count);
    if (const auto* number = std::get_if<double>(&cell)) put(*number);
    if (const auto* flag = std::get_if<bool>(&cell)) put(std::string_view(*flag ? "true" : "false"));
    if (const auto* text = std::get_if<std::string>(&cell)) put(std::string_view(*text));
    if (std::holds_alternative<std::monostate>(cell)) begin_cell();
  }
  end_row();
}

void CsvWriter::begin_cell() noexcept {
  if (cells_++ > 0) file_.append(",");
}

void CsvWriter::end_row() noexcept {
  assert(cells_ == columns_);
  file_.append("\n");
}

namespace {

constexpr std::size_t kFirstNumbers = std::size_t{1} << 15;

}  // namespace

MemoryTable::~MemoryTable() {
  if (data_ != nullptr) ::munmap(data_, capacity_ * sizeof(double));
}

/// Doubles the capacity. mremap moves pages in the address space without copying them.
bool MemoryTable::reserve(std::size_t more) noexcept {
  if (size_ + more <= capacity_) return complete_;
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

void MemoryTable::require_complete() const {
  if (!complete_) throw std::bad_alloc();
}

}  // namespace hapbench
