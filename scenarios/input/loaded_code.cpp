#include "scenarios/input/loaded_code.hpp"

#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>

namespace hapbench {
namespace {

/// The build ID among the notes of one segment, as bytes; empty when there is none.
std::string_view build_id_in(std::string_view notes, std::size_t alignment) {
  const auto padded = [alignment](std::size_t size) { return (size + alignment - 1) / alignment * alignment; };
  while (notes.size() >= sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) note;
    std::memcpy(&note, notes.data(), sizeof note);
    const std::size_t start = padded(sizeof note + note.n_namesz), end = start + note.n_descsz;
    if (end > notes.size()) break;
    const std::string_view owner = notes.substr(sizeof note, note.n_namesz);
    if (note.n_type == NT_GNU_BUILD_ID && owner == std::string_view("GNU", 4))
      return notes.substr(start, note.n_descsz);
    notes.remove_prefix(std::min(notes.size(), padded(end)));
  }
  return {};
}

std::string_view build_id_of(const dl_phdr_info& object) {
  for (const ElfW(Phdr) & segment : std::span(object.dlpi_phdr, object.dlpi_phnum)) {
    if (segment.p_type != PT_NOTE) continue;
    const char* start = reinterpret_cast<const char*>(object.dlpi_addr + segment.p_vaddr);
    const std::string_view id = build_id_in({start, segment.p_memsz}, std::max<std::size_t>(4, segment.p_align));
    if (!id.empty()) return id;
  }
  return {};
}

/// Called for each loaded object; a value other than zero ends the iteration.
int append_build_id(dl_phdr_info* object, std::size_t, void* text) {
  auto& ids = *static_cast<std::string*>(text);
  const std::string_view id = build_id_of(*object);
  if (!ids.empty()) ids += ' ';
  for (const char byte : id) ids += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return id.empty() ? 1 : 0;
}

std::string loaded_now() {
  std::string ids;
  return dl_iterate_phdr(append_build_id, &ids) == 0 ? ids : "";
}

// Before main: what libraries load later when they are first used (oneTBB its allocator) computes no result, and what
// is stored under the text must not depend on when it is asked for.
const std::string loaded_at_start = loaded_now();

}  // namespace

std::string loaded_code_id() {
  return loaded_at_start;
}

}  // namespace hapbench
