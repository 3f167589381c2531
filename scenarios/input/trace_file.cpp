#include "scenarios/input/trace_file.hpp"

#include <fmt/format.h>

#include <cmath>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMostContacts = 20'000'000, kMostAtOnce = 100'000;
constexpr double kLargestLengthError = 1e-3;  ///< of a gradient: three decimals suffice
constexpr double kRounding = 1e-12;           ///< of the length of a gradient in double precision
constexpr std::string_view kTraceHeader = "time_s,x_m,y_m,z_m,ux,uy,uz,depth_m";

}  // namespace

ContactTrace trace_in(std::string_view text, const std::filesystem::path& file) {
  const NumberTable table = number_table_in(text, file, kTraceHeader, kMostContacts);
  ContactTrace trace;
  trace.contacts.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    const auto fail = [&](const std::string& problem) {
      throw InputError(InputError::Kind::relation, fmt::format("{}, contact {}", file.string(), i + 1), problem);
    };
    if (trace.times.empty() || trace.times.back().time < row[0])
      trace.times.push_back({row[0], i});
    else if (row[0] < trace.times.back().time)
      fail(fmt::format("got time {} after {}; allowed: ascending times", row[0], trace.times.back().time));
    if (i - trace.times.back().first >= kMostAtOnce)
      fail(fmt::format("got more contacts at time {}; allowed: at most {}", row[0], kMostAtOnce));
    ContactTrace::Contact contact{{row[1], row[2], row[3]}, {row[4], row[5], row[6]}, row[7]};
    const double length = contact.gradient.norm();
    if (!(std::abs(length - 1.0) <= kLargestLengthError))
      fail(fmt::format("got a gradient ux,uy,uz of length {}; allowed: 1 within {}", length, kLargestLengthError));
    if (std::abs(length - 1.0) > kRounding) contact.gradient /= length;
    if (contact.depth < 0.0)
      fail(fmt::format("got depth {}; allowed: >= 0, how deep the point is in the tool", contact.depth));
    trace.contacts.push_back(contact);
  }
  return trace;
}

}  // namespace hapbench
