#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "results/io/table_writer.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/results_folder.hpp"

namespace hapbench {

/// Collects an answer, and gives it at once: its files all together, then what is printed, or its JSON.
class Report {
 public:
  Report(const OutputOptions& output, std::filesystem::path folder, ProgramContext& context)
      : output_(output), folder_(std::move(folder)), context_(context) {}
  /// Into the folder of --out, or results/out/`name`. Throws InputError unless it can be written to.
  Report(const CommonOptions& options, const std::string& name, ProgramContext& context)
      : Report(options.output, results_directory(options.out, name), context) {
    require_writable_directory(context_, folder_);
  }

  const std::filesystem::path& folder() const { return folder_; }
  void say(std::string_view text) { text_ += text; }
  template <class Row>
  void write(const std::filesystem::path& file, const Columns<Row>& columns, const std::vector<Row>& rows) {
    columns.write(folder_ / file, rows, files_);
  }
  FileSet& files() { return files_; }
  Json& json() { return json_; }
  /// A row that failed, or whose answer is bad: the text is printed as an error, and becomes the exit status.
  void fault(const std::string& text, int status) {
    faults_.push_back(text);
    status_ = status;
  }
  /// The exit status. Throws IoError.
  int finish() {
    files_.commit();
    for (const std::string& fault : faults_) print_error(context_, fault);
    print(context_, output_, text_, json_);
    return status_;
  }

 private:
  const OutputOptions& output_;
  std::filesystem::path folder_;
  ProgramContext& context_;
  FileSet files_;
  std::string text_;
  Json json_;
  std::vector<std::string> faults_;
  int status_ = kSuccess;
};

}  // namespace hapbench
