#include "scenarios/program/describe/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/describe/folders.hpp"
#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/text.hpp"

namespace hapbench {
namespace {

/// The kinds of names that `describe` lists, in the order in which it prints them.
constexpr const char* kListed[] = {"algorithm", "depth model", "stage",  "integrator", "environment",
                                   "tool",      "hand",        "device", "preset",     "scenario",
                                   "study",     "metric",      "claim",  "assumption", "term"};

std::string group_of(const IndexEntry& item) {
  return item.more.value("group", "");
}

constexpr std::size_t kColumn = 34;  // column of the summaries [characters]

/// Returns the first sentence. A semicolon, or a colon after character 20, also ends the sentence. Truncates the
/// sentence to the width that is left in the line.
std::string short_summary(const std::string& text, const Layout& layout) {
  std::size_t end = std::min(text.find("; "), text.find(": ", 20));
  for (std::size_t dot = text.find('.'); dot < end; dot = text.find('.', dot + 1)) {
    const bool is_last = dot + 1 == text.size();
    if (is_last || (text[dot + 1] == ' ' && !text.substr(0, dot).ends_with("Fig"))) end = dot;
  }
  std::string sentence = text.substr(0, end);
  const std::size_t room = std::max<std::size_t>(layout.width(), kColumn + 10) - kColumn;
  if (sentence.size() <= room) return sentence;
  return sentence.substr(0, sentence.rfind(' ', room - 4)) + " ...";
}

std::string list_text(const Index& all, bool only_names, const Layout& layout) {
  std::vector<std::pair<std::string, std::string>> lists;  // title and entries of each list
  for (const IndexEntry& item : all) {
    const std::string group = group_of(item), title = list_name(item.kind) + (group.empty() ? "" : " of " + group);
    // Begin a new list if the kind or group changes.
    if (lists.empty() || lists.back().first != title) lists.emplace_back(title, "");
    std::string& entries = lists.back().second;
    // Only a claim has a verdict. The statement of a claim is listed in full.
    const std::string verdict = item.more.value("verdict", "");
    if (only_names)
      entries += (entries.empty() ? "" : ", ") + item.name;
    else if (verdict.empty())
      entries += entry(item.name, short_summary(item.summary, layout), 2, kColumn, layout.width());
    else
      entries += entry(fmt::format("{:<5}{}", item.name, verdict), item.summary, 2, kColumn, layout.width());
  }
  // Join the lists below their titles.
  std::string text;
  for (const auto& [title, entries] : lists)
    text += (text.empty() ? "" : "\n") + bold(stdout, title) + "\n" + (only_names ? layout.wrapped(entries) : entries);
  return text;
}

/// Returns the list as a table: kind (if there are several), name, summary, and the further members of the JSON.
Table list_table(const Index& all) {
  const bool is_one_kind = std::ranges::all_of(all, [&all](const IndexEntry& i) { return i.kind == all.front().kind; });
  std::vector<std::string> members;
  for (const IndexEntry& item : all)
    for (const auto& member : item.more.items()) append_new(members, {member.key()});
  Table table{.caption = is_one_kind ? list_name(all.front().kind) : "names"};
  if (!is_one_kind) table.columns.push_back({"kind", false});
  table.columns.push_back({is_one_kind ? all.front().kind : "name", false});
  table.columns.push_back({"summary", false});
  for (const std::string& member : members) table.columns.push_back({member, false});
  for (const IndexEntry& item : all) {
    auto& row = table.rows.emplace_back();
    if (!is_one_kind) row.push_back(item.kind);
    row.insert(row.end(), {item.name, item.summary});
    for (const std::string& member : members) {
      const Json value = item.more.value(member, Json(""));
      row.push_back(value.is_string() ? value.get<std::string>() : value.dump());
    }
  }
  return table;
}

}  // namespace

std::span<const char* const> listed_kinds() {
  return kListed;
}

std::string list_name(const std::string& kind) {
  std::string name = kind == "study" ? "studies" : kind + "s";
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

bool is_kind(const std::string& name) {
  return name != "metrics" && std::ranges::find(kListed, name, list_name) != std::end(kListed);
}

int list(const DescribeOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  const bool of_everything = options.name.empty() && options.grep.empty();
  const std::string pattern = lower_case(options.grep);
  const auto is_requested = [&](const IndexEntry& item) {
    if (of_everything)
      return item.kind != "metric" && item.kind != "claim" && item.kind != "assumption" && item.kind != "term";
    const std::string text = item.name + " " + item.summary + " " + item.more.value("source", "");
    return (options.name.empty() || list_name(item.kind) == options.name || group_of(item) == options.name) &&
           lower_case(text).find(pattern) != std::string::npos;
  };
  // Collect the requested entries in the order of the kinds.
  Index index = program_index(layout), all;
  std::ranges::move(folder_index(layout), std::back_inserter(index));
  for (const std::string_view kind : kListed)
    for (const IndexEntry& item : index)
      if (item.kind == kind && is_requested(item)) all.push_back(item);
  if (all.empty()) throw InputError(fmt::format("--grep: no name or text contains \"{}\"", options.grep));
  if (!options.output.table.empty()) {
    print_tables(context, options.output, std::vector{list_table(all)});
    return kSuccess;
  }
  Json json = Json::array();
  for (const IndexEntry& item : all) {
    Json& entry = json.emplace_back(Json{{"kind", item.kind}, {"name", item.name}, {"summary", item.summary}});
    entry.update(item.more);
  }
  const char* more =
      of_everything ? ", \"hapbench describe KIND\" lists one kind with summaries; further kinds: metrics, claims, "
                      "assumptions, terms"
                    : "";
  print(context, options.output,
        list_text(all, of_everything, layout) + "\n" +
            layout.wrapped(fmt::format("\"hapbench describe NAME\" explains each{}.", more), 0),
        json);
  return kSuccess;
}

}  // namespace hapbench
