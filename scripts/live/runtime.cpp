// Adds exceptions and files to the standard library for WebAssembly, which is built without them. An exception
// ends the engine with the exception's message; the page then creates a new engine.
#include <sys/stat.h>
#include <wasi/api.h>

#include <cerrno>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <typeinfo>

/// Throws a JavaScript error with this message in the page.
extern "C" [[noreturn]] __attribute__((import_module("page"), import_name("fail"))) void page_fail(const char* message);

extern "C" {

void* __cxa_allocate_exception(std::size_t size) {
  void* memory = std::malloc(size);
  if (memory == nullptr) page_fail("out of memory");
  return memory;
}

void __cxa_free_exception(void* memory) {
  std::free(memory);
}

/// Every exception of the engine reaches this function as an object whose first base is std::exception.
[[noreturn]] void __cxa_throw(void* thrown, std::type_info*, void (*)(void*)) {
  page_fail(static_cast<std::exception*>(thrown)->what());
}

}  // extern "C"

// The headers declare these templates extern, but a standard library that is built without files does not instantiate
// them.
template class std::basic_filebuf<char>;
template class std::basic_ifstream<char>;

_LIBCPP_BEGIN_NAMESPACE_FILESYSTEM

file_status __status(const path& p, error_code* error) {
  struct stat found = {};
  if (::stat(p.c_str(), &found) != 0) {
    const bool is_missing = errno == ENOENT || errno == ENOTDIR || errno == ENOTCAPABLE;
    if (error) *error = is_missing ? error_code() : error_code(errno, generic_category());
    return file_status(is_missing ? file_type::not_found : file_type::unknown);
  }
  if (error) error->clear();
  return file_status(S_ISDIR(found.st_mode) ? file_type::directory : file_type::regular);
}

path __current_path(error_code* error) {
  if (error) error->clear();
  return "/";
}

/// Compares the paths as text, because the page's files have no links.
bool __equivalent(const path& a, const path& b, error_code* error) {
  if (error) error->clear();
  return a.lexically_normal() == b.lexically_normal();
}

_LIBCPP_END_NAMESPACE_FILESYSTEM
