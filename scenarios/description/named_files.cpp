#include "scenarios/description/named_files.hpp"

#include <algorithm>
#include "scenarios/description/descriptions.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/motion_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// Walks through the values that an object holds and collects the names of files.
class FileFinder final : public Fields {
 public:
  std::vector<FileReference> found;

  void file(std::string& path, const FileContent& content) override { found.push_back({at_, &path, content}); }

  void number(double&, NumberRange) override {}
  void integer(std::int64_t&, IntegerRange) override {}
  void boolean(bool&) override {}
  void text(std::string&, std::size_t) override {}
  void name(std::size_t&, const std::vector<std::string>&, const char*) override {}
  void vector3(Vec3&, NumberRange) override {}
  void pair(const char*, Body first, Body second) override {
    within("0", first);
    within("1", second);
  }
  void entries(std::size_t length, ListSize, FunctionRef<std::size_t>,
               FunctionRef<Fields&, std::size_t> entry) override {
    for (std::size_t i = 0; i < length; ++i) within(std::to_string(i), [&](Fields& f) { entry(f, i); });
  }
  void or_null(bool is_null, FunctionRef<>, Body value) override {
    if (!is_null) value(*this);
  }
  void number_or_object(bool is_object, Body, Body object) override {
    if (is_object) object(*this);
  }
  void one_or_list(bool is_list, Body one, Body list) override { (is_list ? list : one)(*this); }
  void alternatives(const char*, std::span<const char* const>, Untyped, std::size_t held,
                    FunctionRef<Fields&, std::size_t> fields) override {
    fields(*this, held);
  }
  void fields(Body body) override { body(*this); }
  void field(std::string_view name, const char*, Presence presence, Body value) override {
    if (presence != Presence::left_out) within(name, value);
  }
  void ignored(std::string_view, const char*) override {}
  void exactly_one_of(const char*, const char*) override {}

 private:
  void within(std::string_view name, Body value) {
    const std::size_t length = at_.size();
    at_.append("/").append(name);
    value(*this);
    at_.resize(length);
  }

  std::string at_;  ///< JSON pointer of the value that is visited
};

}  // namespace

std::vector<FileReference> files_named_in(Scenario& scenario) {
  FileFinder finder;
  finder.object(scenario);
  return std::move(finder.found);
}

void NamedFile::read() {
  if (!hash_.empty()) return;
  bytes_ = read_named_file(path_);
  hash_ = hash_text(hash_of(bytes_));
}

const std::string& NamedFile::hash() {
  read();
  return hash_;
}

const NamedFile::Contents& NamedFile::contents() {
  if (!contents_) {
    contents_ = std::make_shared<const Contents>(parsed());
    bytes_ = {};
  }
  return *contents_;
}

NamedFile::Contents NamedFile::parsed() {
  // A file with another extension is refused unread.
  switch (content_.kind) {
    case FileContent::Kind::point_shell:
      shell_extension(path_);
      read();
      return {.points = point_shell_in(bytes_, path_)};
    case FileContent::Kind::mesh:
      mesh_extension(path_);
      read();
      return {.mesh = MeshFile(bytes_, path_, content_.sampling)};
    case FileContent::Kind::stroke:
      read();
      return {.stroke = stroke_in(bytes_, path_)};
  }
  return {};
}

std::vector<std::string> NamedFile::warnings() {
  return content_.kind == FileContent::Kind::mesh ? mesh().warnings() : std::vector<std::string>();
}

NamedFiles::NamedFiles(Scenario scenario) {
  for (const auto& [pointer, path, content] : files_named_in(scenario))
    files_.push_back(std::make_shared<NamedFile>(pointer, resolve_path(scenario, *path), content));
}

NamedFile* NamedFiles::find(std::string_view pointer) const {
  const auto found =
      std::find_if(files_.begin(), files_.end(), [pointer](const auto& file) { return file->pointer() == pointer; });
  return found == files_.end() ? nullptr : found->get();
}

}  // namespace hapbench
