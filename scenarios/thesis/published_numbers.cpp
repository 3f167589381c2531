#include "scenarios/thesis/published_numbers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

namespace fs = std::filesystem;

PublishedNumbers::PublishedNumbers(const fs::path& file) {
  try {
    const Json json = with_file(file, [&] { return read_json(file); });
    for (const Json& value : json.at("values")) {
      PublishedNumber& number = numbers_[value.at("id").get<std::string>()];
      for (const char* key : {"mean", "value"}) number.mean = value.value(key, number.mean);
      for (const char* key : {"std", "standard_error"}) number.spread = value.value(key, number.spread);
      number.at_least = value.value("at_least", number.at_least);
      number.at_most = value.value("at_most", number.at_most);
    }
  } catch (const Json::exception& problem) {
    throw InputError(fmt::format("{}: is no file of published numbers: {}", file.string(), problem.what()));
  }
}

const PublishedNumber& PublishedNumbers::operator[](const std::string& id) const {
  const auto found = numbers_.find(id);
  if (found == numbers_.end()) throw InputError("the published numbers hold no \"" + id + "\"");
  return found->second;
}

namespace {

/// Removes the exponent of a number whose text was written in the format g: "1e+01" becomes "10". Returns `text`
/// unchanged if the format is not g, if the text has no positive exponent, or if the number's magnitude is 100,000 or
/// more.
std::string without_exponent(const std::string& text, std::string_view format) {
  constexpr double kLargest = 1e5;
  if (!format.ends_with('g') || text.find("e+") == std::string::npos) return text;
  const auto number = finite_number(text);
  return number && std::abs(*number) < kLargest ? fmt::format("{:.0f}", *number) : text;
}

/// Returns the member of a number with this name; the mean for an unknown name.
double part_of(const PublishedNumber& number, std::string_view name) {
  if (name == "spread") return number.spread;
  if (name == "at_least") return number.at_least;
  if (name == "at_most") return number.at_most;
  return number.mean;
}

/// Returns the text of a number without a named member: "37.8 ± 17.7", or "37.8" without a spread.
std::string mean_and_spread(const PublishedNumber& number) {
  return plain(number.mean) + (number.spread > 0.0 ? " ± " + plain(number.spread) : "");
}

}  // namespace

std::string PublishedNumbers::fill(const std::string& text) const {
  // Groups of the expression: id, and optionally member, factor and format.
  static const std::regex kNumber(
      R"(<([^<>*:]+?)(?:\.(mean|spread|at_least|at_most)(?:\*([^<>:]+))?(?::([^<>]+))?)?>)");
  const auto text_of = [](const PublishedNumber& number, const std::smatch& match) -> std::string {
    if (!match[2].matched) return mean_and_spread(number);
    const double factor = match[3].matched ? finite_number(match[3].str()).value() : 1.0;
    const double scaled = part_of(number, match[2].str()) * factor;
    if (std::isnan(scaled)) return "none";
    if (!match[4].matched) return plain(scaled);
    return without_exponent(fmt::format(fmt::runtime("{:" + match[4].str() + "}"), scaled), match[4].str());
  };
  std::string filled;
  auto end = text.begin();
  for (std::sregex_iterator found(text.begin(), text.end(), kNumber), none; found != none; ++found) {
    const std::smatch& match = *found;
    filled.append(end, match[0].first);
    filled += text_of((*this)[match[1]], match);
    end = match[0].second;
  }
  return filled.append(end, text.end());
}

std::string plain(double number) {
  std::string text = fmt::format("{:g}", number);
  // Remove the leading zero of the exponent.
  if (const auto exponent = text.find("e-0"); exponent != std::string::npos) text.erase(exponent + 2, 1);
  return text;
}

double threshold(const PublishedNumbers& numbers, const std::string& name) {
  return numbers["rule." + name].mean;
}

}  // namespace hapbench
