#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
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

/// Collects the results of a command. finish() publishes them together: it writes all files, then prints the
/// text or the JSON.
class Report {
 public:
  /// Creates a report whose folder is locked by the caller.
  Report(const OutputOptions& output, std::filesystem::path folder, ProgramContext& context)
      : output_(output), folder_(std::move(folder)), context_(context) {}
  /// Creates a report of a command whose files go to the folder of --out, or to results/out/`name` without --out, and
  /// locks the files of this command there. Throws InputError if the folder cannot be written to, and IoError if
  /// another process has locked them.
  Report(const CommonOptions& options, const std::string& command, const std::string& name, ProgramContext& context)
      : Report(options.output, results_directory(options.out, name), context) {
    lock_.emplace(locked_results(context_, folder_, command, command));
  }

  const std::filesystem::path& folder() const { return folder_; }
  /// Appends printed text. It is not printed with --table.
  void add_text(std::string_view text) { text_ += text; }
  /// Appends a table to the printed text and to the tables of --table. In the text, the table is at most as wide as the
  /// output and at most `max_width` characters wide.
  void show(Table table, std::size_t max_width = std::string::npos) {
    text_ += table.text(std::min(max_width, context_.layout().width()));
    tables_.push_back(std::move(table));
  }
  /// Appends a table that is printed only with --table, because the text has its numbers in another form.
  void show_only_as_table(Table table) { tables_.push_back(std::move(table)); }
  /// True if --table is given.
  bool prints_tables() const { return !output_.table.empty(); }
  template <class Row>
  void write(const std::filesystem::path& file, const Columns<Row>& columns, const std::vector<Row>& rows) {
    columns.write(folder_ / file, rows, files_);
  }
  FileSet& files() { return files_; }
  Json& json() { return json_; }
  /// Records a failure. finish() prints the text of each failure as an error, and returns the `status` of the last
  /// failure.
  void fault(const std::string& text, int status) {
    faults_.push_back(text);
    status_ = status;
  }
  /// Commits the files, prints errors and results, and returns the exit status. Throws IoError if a file cannot be
  /// written.
  int finish() {
    files_.commit();
    for (const std::string& fault : faults_) print_error(context_, fault);
    if (prints_tables()) {
      print_tables(context_, output_, tables_);
    } else {
      print(context_, output_, text_, json_);
    }
    return status_;
  }

 private:
  const OutputOptions& output_;
  std::filesystem::path folder_;
  ProgramContext& context_;
  std::optional<FolderLock> lock_;
  FileSet files_;
  std::string text_;
  std::vector<Table> tables_;
  Json json_;
  std::vector<std::string> faults_;
  int status_ = kSuccess;
};

}  // namespace hapbench
