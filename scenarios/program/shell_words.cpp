#include "scenarios/program/shell_words.hpp"

#include <sys/wait.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "scenarios/plugins/load_plugin.hpp"

namespace hapbench {
namespace {

std::filesystem::path given_program;

std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

std::filesystem::path this_program() {
  std::error_code ignored;
  return given_program.empty() ? std::filesystem::read_symlink("/proc/self/exe", ignored) : given_program;
}

std::vector<std::string> plugin_words() {
  std::vector<std::string> words;
  for (const LoadedPlugin& plugin : loaded_plugins()) words.insert(words.end(), {"--plugin", plugin.file.string()});
  return words;
}

ProgramOutput output_of(const std::vector<std::string>& words) {
  ProgramOutput output;
  std::FILE* pipe = ::popen((shell_line(words) + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw IoError("run", words[0], std::error_code(errno, std::generic_category()));
  char piece[4096];
  for (std::size_t n; (n = std::fread(piece, 1, sizeof piece, pipe)) > 0;) output.text.append(piece, n);
  const int status = ::pclose(pipe);
  output.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return output;
}

void set_this_program(std::filesystem::path program) {
  given_program = std::move(program);
}

}  // namespace hapbench
