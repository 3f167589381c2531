#include "scenarios/program/table_format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "results/io/columns.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr std::string_view kErrorSign = " +- ", kMissing = "-";

/// A decimal number as it is written: 1.50e-3 has the mantissa 1.50, two decimals and the exponent -3.
struct Decimal {
  double value = 0.0;
  int decimals = 0, exponent = 0;
  std::size_t integer_digits = 1;  ///< digits before the point, and one more for a minus sign
  std::string mantissa;
};

/// Parses a finite decimal number. Returns empty for other texts.
std::optional<Decimal> decimal_of(std::string_view text) {
  const auto value = finite_number(text);
  if (!value || text.find_first_not_of("+-.0123456789e") != std::string_view::npos) return std::nullopt;
  const std::size_t e = std::min(text.find('e'), text.size());
  Decimal decimal{.value = *value, .mantissa = std::string(text.substr(0, e))};
  if (e < text.size()) decimal.exponent = static_cast<int>(*finite_number(text.substr(e + 1)));
  const std::size_t point = std::min(decimal.mantissa.find('.'), decimal.mantissa.size());
  decimal.integer_digits = point;
  if (point < decimal.mantissa.size()) decimal.decimals = static_cast<int>(decimal.mantissa.size() - point - 1);
  return decimal;
}

/// A cell of a column of numbers: a number, and its error if the cell has one.
struct Quantity {
  Decimal number;
  std::optional<Decimal> error = {};
};

std::optional<Quantity> quantity_of(const std::string& cell) {
  const std::size_t sign = std::min(cell.find(kErrorSign), cell.size());
  const auto number = decimal_of(std::string_view(cell).substr(0, sign));
  if (!number) return std::nullopt;
  if (sign == cell.size()) return Quantity{*number};
  const auto error = decimal_of(std::string_view(cell).substr(sign + kErrorSign.size()));
  return error ? std::optional(Quantity{*number, error}) : std::nullopt;
}

/// Returns the quantities in the cells of column c. Omits cells with other texts. Returns empty for a column of text.
std::vector<Quantity> quantities_of(const Table& table, std::size_t c) {
  std::vector<Quantity> quantities;
  if (!table.columns[c].number) return quantities;
  for (const auto& row : table.rows)
    if (auto quantity = quantity_of(row[c])) quantities.push_back(std::move(*quantity));
  return quantities;
}

bool has_errors(const std::vector<Quantity>& quantities) {
  return std::ranges::any_of(quantities, [](const Quantity& q) { return q.error.has_value(); });
}

/// Replaces each key of `by` in the text by its value. If several keys match at a position, replaces the first of them.
template <std::size_t N>
std::string replaced(std::string_view text, const std::array<std::pair<std::string_view, std::string_view>, N>& by) {
  std::string result;
  while (!text.empty()) {
    const auto found = std::ranges::find_if(by, [text](const auto& entry) { return text.starts_with(entry.first); });
    result += found == by.end() ? text.substr(0, 1) : found->second;
    text.remove_prefix(found == by.end() ? 1 : found->first.size());
  }
  return result;
}

/// Returns the text in one line. Line ends and tabs become spaces. Other control characters, which LaTeX refuses,
/// become "?".
std::string in_one_line(std::string_view text) {
  std::string line(text);
  std::ranges::replace_if(
      line, [](char c) { return c == '\n' || c == '\t'; }, ' ');
  return one_line(std::move(line));
}

// --- Markdown ---

/// Returns text with a backslash before each character that has a meaning in Markdown. An underscore within a word has
/// no meaning and gets no backslash.
std::string markdown_text(std::string_view given) {
  const std::string text = in_one_line(given);
  constexpr std::string_view kSpecial = "\\`*[]<>|&$~#";
  const auto is_word = [&text](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0);
  };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_outer = text[i] == '_' && !(i > 0 && is_word(i - 1) && is_word(i + 1));
    if (is_outer || kSpecial.find(text[i]) != std::string_view::npos) result += '\\';
    result += text[i];
  }
  return result;
}

/// Returns the text of a cell in Markdown. "+-" becomes ±, and "<=" becomes ≤.
std::string markdown_cell(const std::string& cell) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kSigns = {{{" +- ", " ± "}, {"\\<= ", "≤ "}}};
  return replaced(markdown_text(cell), kSigns);
}

std::string markdown(const Table& table, bool captioned) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::vector<std::string> heads, rules;
  for (const Table::Column& column : table.columns) {
    heads.push_back(markdown_text(column.head()));
    rules.emplace_back(column.number ? "---:" : "---");
  }
  std::string text = captioned ? fmt::format("**{}**\n\n", markdown_text(table.caption)) : "";
  text += line(heads) + line(rules);
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    std::ranges::transform(row, std::back_inserter(cells), markdown_cell);
    text += line(cells);
  }
  return text;
}

// --- CSV ---

std::string csv(const Table& table, bool /*captioned*/) {
  std::vector<bool> errors;  // for each column: true if it becomes two columns
  for (std::size_t c = 0; c < table.columns.size(); ++c) errors.push_back(has_errors(quantities_of(table, c)));
  const auto line = [&errors](auto cells_of) {
    std::vector<std::string> cells;
    for (std::size_t c = 0; c < errors.size(); ++c) {
      const auto [number, error] = cells_of(c);
      cells.push_back(csv_cell(number));
      if (errors[c]) cells.push_back(csv_cell(error));
    }
    return fmt::format("{}\n", fmt::join(cells, ","));
  };
  using Pair = std::pair<std::string, std::string>;
  std::string text = line([&](std::size_t c) {
    const std::string head = table.columns[c].head();
    return Pair{head, head + " +-"};
  });
  for (const auto& row : table.rows) {
    text += line([&](std::size_t c) {
      if (row[c] == kMissing) return Pair{};
      const std::size_t sign = errors[c] ? row[c].find(kErrorSign) : std::string::npos;
      if (sign == std::string::npos) return Pair{row[c], ""};
      return Pair{row[c].substr(0, sign), row[c].substr(sign + kErrorSign.size())};
    });
  }
  return text;
}

// --- LaTeX ---

/// Returns text in which every character that has a meaning in LaTeX is escaped. Also replaces the symbols that
/// pdfLaTeX does not know, and pairs of characters that a font would join.
std::string latex_text(std::string_view text) {
  constexpr auto kEscapes = std::to_array<std::pair<std::string_view, std::string_view>>(
      {{" +- ", R"( $\pm$ )"},  {"<= ", R"($\leq$ )"},
       {">= ", R"($\geq$ )"},   {"\\", R"(\textbackslash{})"},
       {"{", R"(\{)"},          {"}", R"(\})"},
       {"_", R"(\_)"},          {"%", R"(\%)"},
       {"&", R"(\&)"},          {"#", R"(\#)"},
       {"$", R"(\$)"},          {"~", R"(\textasciitilde{})"},
       {"<", R"(\textless{})"}, {">", R"(\textgreater{})"},
       {"|", R"(\textbar{})"},  {"^", R"(\textasciicircum{})"},
       {"\"", R"({''})"},       {"--", R"(-{}-)"},
       {"≤", R"($\leq$)"},      {"≥", R"($\geq$)"},
       {"≈", R"($\approx$)"},   {"≠", R"($\neq$)"},
       {"−", R"($-$)"},         {"∞", R"($\infty$)"},
       {"√", R"($\surd$)"},     {"α", R"($\alpha$)"},
       {"β", R"($\beta$)"},     {"δ", R"($\delta$)"},
       {"Δ", R"($\Delta$)"},    {"ζ", R"($\zeta$)"},
       {"λ", R"($\lambda$)"},   {"π", R"($\pi$)"},
       {"ρ", R"($\rho$)"},      {"τ", R"($\tau$)"},
       {"ω", R"($\omega$)"},    {"→", R"($\to$)"},
       {"µ", R"(\textmu{})"},   {"μ", R"(\textmu{})"}});
  return replaced(in_one_line(text), kEscapes);
}

/// Returns the number of decimals with which a number and its error are written.
int decimals_of(const Quantity& quantity) {
  const int of_error =
      quantity.error ? quantity.error->decimals - quantity.error->exponent + quantity.number.exponent : 0;
  return std::max({0, quantity.number.decimals, of_error});
}

/// Returns a number as siunitx reads it. A number and its error share the exponent of the number.
std::string latex_number(const Quantity& quantity) {
  const Decimal& number = quantity.number;
  const std::string exponent = number.exponent == 0 ? "" : fmt::format("e{}", number.exponent);
  if (!quantity.error) return number.mantissa + exponent;
  const int decimals = decimals_of(quantity);
  const double unit = math::pow(10.0, number.exponent);
  return fmt::format("{:.{}f} +- {:.{}f}{}", number.value / unit, decimals, quantity.error->value / unit, decimals,
                     exponent);
}

/// Returns the type of a column of numbers: S with the largest number of digits before and after the point, so that
/// the points are below each other, and with the largest number of digits of an error.
std::string latex_number_column(const std::vector<Quantity>& quantities) {
  std::size_t integer_digits = 1;
  int decimals = 0, error_digits = 1;
  bool has_exponent = false;
  for (const Quantity& quantity : quantities) {
    integer_digits = std::max(integer_digits, quantity.number.integer_digits);
    decimals = std::max(decimals, decimals_of(quantity));
    has_exponent |= quantity.number.exponent != 0;
    if (!quantity.error || quantity.error->value <= 0.0) continue;
    const double units = quantity.error->value * math::pow(10.0, decimals_of(quantity) - quantity.number.exponent);
    error_digits = std::max(error_digits, 1 + static_cast<int>(std::floor(math::log10(units) + 1e-9)));
  }
  const char* exponent = has_exponent ? "e-2" : "";
  if (!has_errors(quantities)) return fmt::format("S[table-format={}.{}{}]", integer_digits, decimals, exponent);
  return fmt::format(
      "S[separate-uncertainty=true,retain-zero-uncertainty=true,table-align-uncertainty=false,"
      "table-format={}.{}({}){}]",
      integer_digits, decimals, error_digits, exponent);
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the parts of the table, from top to bottom.
std::string latex(const Table& table, bool /*captioned*/) {
  constexpr std::size_t kMaxTextWidth = 40;  // a wider column of text is wrapped [characters]
  std::vector<std::string> types, upper, lower;
  std::vector<bool> of_numbers;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const Table::Column& column = table.columns[c];
    const std::vector<Quantity> quantities = quantities_of(table, c);
    of_numbers.push_back(!quantities.empty());
    const bool is_wide =
        std::ranges::any_of(table.rows, [c](const auto& row) { return row[c].size() > kMaxTextWidth; });
    types.push_back(of_numbers[c] ? latex_number_column(quantities)
                    : is_wide     ? R"(>{\raggedright\arraybackslash}p{0.4\linewidth})"
                                  : (column.number ? "r" : "l"));
    const auto [first, second] = column.head_lines();
    upper.push_back(fmt::format("{{{}}}", latex_text(first)));
    lower.push_back(fmt::format("{{{}}}", latex_text(second)));
  }
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("  {} \\\\\n", fmt::join(cells, " & "));
  };
  const bool has_upper = std::ranges::any_of(upper, [](const std::string& head) { return head != "{}"; });
  std::string text =
      fmt::format("% {}\n\\begin{{tabular}}{{{}}}\n  \\toprule\n{}{}  \\midrule\n", in_one_line(table.caption),
                  fmt::join(types, " "), has_upper ? line(upper) : "", line(lower));
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const auto quantity = of_numbers[c] ? quantity_of(row[c]) : std::nullopt;
      // Put texts in braces. Otherwise siunitx reads a text as a number, and LaTeX reads "[" or "*" at the start of a
      // row as an argument of the "\\" before it.
      cells.push_back(quantity             ? latex_number(*quantity)
                      : row[c] == kMissing ? "{--}"
                                           : fmt::format("{{{}}}", latex_text(row[c])));
    }
    text += line(cells);
  }
  return text + "  \\bottomrule\n\\end{tabular}\n";
}

struct TableFormat {
  const char* name;
  std::string (*text)(const Table& table, bool captioned);
};
constexpr TableFormat kFormats[] = {{"markdown", markdown}, {"latex", latex}, {"csv", csv}};

}  // namespace

std::vector<std::string> table_format_names() {
  return names_of(kFormats, &TableFormat::name);
}

std::string formatted_tables(std::span<const Table> tables, std::string_view format) {
  const auto& [name, text_of] = *std::ranges::find(kFormats, format, &TableFormat::name);
  std::vector<std::string> texts;
  for (const Table& table : tables) texts.push_back(text_of(table, tables.size() > 1));
  return fmt::format("{}", fmt::join(texts, "\n"));
}

}  // namespace hapbench
