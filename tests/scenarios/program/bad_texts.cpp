#include <ostream>

#include "tests/scenarios/program/bad_inputs.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::test {

void PrintTo(const BadInput& input, std::ostream* out) {
  *out << input.name;
}

std::string with_value(const std::string& environment, const std::string& pointer, const std::string& value) {
  Json json = minimal_scenario(environment);
  json[Json::json_pointer(pointer)] = "@@";
  std::string text = json.dump();
  return text.replace(text.find("\"@@\""), 4, value);
}

std::string with_patch(const std::string& environment, const std::string& patch) {
  Json json = minimal_scenario(environment);
  json.merge_patch(Json::parse(patch));
  return json.dump();
}

std::vector<BadInput> malformed_texts() {
  const std::string good = minimal_scenario("plane").dump();
  const std::string syntax = "is not JSON: syntax error at line ";
  const auto with = [](const std::string& value) { return with_value("plane", "/time/step_s", value); };
  std::vector<BadInput> inputs = {
      {"Empty", "", "", "is not JSON: syntax error at line 1, column 1"},
      {"Blank", " \n\n ", "", syntax},
      {"TrailingComma", good.substr(0, good.size() - 1) + ",}", "", syntax},
      {"TrailingGarbage", good + "x", "", syntax},
      {"TwoDocuments", good + "\n" + good, "", "is not JSON: syntax error at line 2, column 1"},
      {"ZeroByteAtTheEnd", good + std::string(1, '\0'), "", syntax},
      {"ZeroByteInside", with(std::string("1\0", 2)), "", syntax},
      {"CutShort", good.substr(0, good.size() / 2), "", syntax},
      {"MissingBrace", good.substr(1), "", syntax},
      {"Comment", "// a plane\n" + good, "", syntax},
      {"SingleQuotes", "{'time': 1}", "", syntax},
      {"UnquotedKey", "{time: 1}", "", syntax},
      {"MissingColon", "{\"time\" 1}", "", syntax},
      {"MissingComma", "{\"time\": 1 \"environment\": 2}", "", syntax},
      {"Utf16", std::string("\xff\xfe{\0}\0", 6), "", syntax},
      {"BrokenByteOrderMark", "\xef\xbb" + good, "", syntax},
      {"InvalidUtf8", with("\"\xff\""), "", syntax},
      {"OverlongUtf8", with("\"\xc0\xaf\""), "", syntax},
      {"InvalidUtf8InAKey", "{\"ti\xffme\": 1}", "", syntax},
      {"LoneSurrogate", with("\"\\ud800\""), "", syntax},
      {"BadEscape", with("\"\\q\""), "", syntax},
      {"LineBreakInAText", with("\"a\nb\""), "", syntax},
      {"LiteralNaN", with("NaN"), "", syntax},
      {"LiteralInfinity", with("Infinity"), "", syntax},
      {"LiteralMinusInfinity", with("-Infinity"), "", syntax},
      {"Hexadecimal", with("0x10"), "", syntax},
      {"LeadingZero", with("01"), "", syntax},
      {"LeadingPlus", with("+1"), "", syntax},
      {"LeadingPoint", with(".5"), "", syntax},
      {"TrailingPoint", with("5."), "", syntax},
      {"BareExponent", with("1e"), "", syntax},
      {"PythonTrue", with("True"), "", syntax},
      {"NumberBeyondDouble", with("1e999"), "/time/step_s", "got 1e999; allowed: finite numbers"},
      {"NegativeNumberBeyondDouble", with("-1e999"), "/time/step_s", "got -1e999; allowed: finite numbers"},
      {"DuplicateKey",
       "{\"time\": {\"step_s\": 1e-3, \"steps\": 1}, \"time\": {}, \"environment\": {\"type\": \"plane\"}}", "/time",
       "the key stands twice in one object; allowed: once"},
      {"DuplicateNestedKey", with("1, \"step_s\": 1"), "/time/step_s",
       "the key stands twice in one object; allowed: once"},
      {"DuplicateKeySpeltWithAnEscape", with("1, \"step\\u005fs\": 1"), "/time/step_s", "the key stands twice"},
  };
  inputs.push_back({"NestedLists", "", "/0/0", "nested too deeply; allowed: 64 levels", {}, [] {
                      return std::string(200'000, '[');
                    }});
  inputs.push_back({"NestedAndClosedLists", "", "/0/0", "nested too deeply; allowed: 64 levels", {}, [] {
                      return std::string(200'000, '[') + std::string(200'000, ']');
                    }});
  inputs.push_back({"NestedObjects", "", "/a/a", "nested too deeply; allowed: 64 levels", {}, [] {
                      std::string text;
                      for (int i = 0; i < 200'000; ++i) text += "{\"a\":";
                      return text;
                    }});
  inputs.push_back({"NestedValue", "", "/time/step_s/0", "nested too deeply; allowed: 64 levels", {}, [] {
                      return with_value("plane", "/time/step_s", std::string(200'000, '[') + std::string(200'000, ']'));
                    }});
  return inputs;
}

std::vector<BadInput> absurd_sizes() {
  const std::string points = "shell points", steps = "allowed: an integer 1 ... 1000000000";
  return {
      {"TooManySteps", with_value("plane", "/time/steps", "1000000001"), "/time/steps", "got 1000000001; " + steps},
      {"StepsOf30Digits", with_value("plane", "/time/steps", "1" + std::string(30, '0')), "/time/steps",
       "got 1e+30; " + steps},
      {"StepsInExponentForm", with_value("plane", "/time/steps", "1e30"), "/time/steps", "got 1e+30; " + steps},
      {"TooManyRecordedRows", with_value("plane", "/time/steps", "30000000"), "/record/every",
       "recorded rows; allowed: at most"},
      {"DurationOfTooManySteps", with_value("plane", "/time", R"({"step_s": 1e-9, "duration_s": 1e9})"),
       "/time/duration_s", "got 1e+18 steps (duration_s / step_s); allowed: 1 ... 1e+09"},
      {"DurationOfNoStep", with_value("plane", "/time", R"({"step_s": 0.5, "duration_s": 1e-9})"), "/time/duration_s",
       "got 0 steps (duration_s / step_s); allowed: 1 ... 1e+09"},
      {"PlaneOfTooManyPoints", with_value("plane", "/environment/spacing_m", "1e-8"), "/environment", points},
      {"PlaneOfTinySpacing", with_value("plane", "/environment/spacing_m", "5e-324"), "/environment",
       "got inf shell points"},
      {"HoleOfTooManyPoints", with_value("hole_2d", "/environment/spacing_m", "1e-14"), "/environment", points},
      {"SlotOfTooManyPoints", with_value("slot", "/environment/spacing_m", "1e-7"), "/environment", points},
      {"BlockOfTooManyPoints", with_value("block_with_hole", "/environment/grid_m", "1e-6"), "/environment", points},
      {"BlockOfTinyGrid", with_value("block_with_hole", "/environment/grid_m", "1e-300"), "/environment/grid_m",
       "got 1e-300; allowed: at least"},
      {"TooManySpringsInAGroup",
       with_value("springs", "/environment/groups", R"([{"direction": [1,0,0], "count": 1000000000000}])"),
       "/environment/groups/0/count", "got 1000000000000; allowed: an integer 0 ... 20000000"},
      {"TooManySpringsInAll",
       with_value("springs", "/environment/groups",
                  R"([{"direction": [1,0,0], "count": 20000000}, {"direction": [1,0,0], "count": 1}])"),
       "/environment", "got 2e+07 springs; allowed: at most 2e+07"},
      {"TooManyRandomSprings", with_value("springs", "/environment/random", R"({"count": 1e12})"),
       "/environment/random/count", "allowed: an integer 0 ... 20000000"},
      {"TooManyIterations", with_value("plane", "/rendering", R"({"iterations": 1000000000})"), "/rendering/iterations",
       "allowed: an integer 0 ... 100000"},
      {"HugeNumberOfDigits", with_value("plane", "/time/step_s", "1" + std::string(5000, '0')), "/time/step_s",
       "allowed: finite numbers"},
      {"HugeKey",
       "",
       "/kkkkkkkkkk",
       "unknown field",
       {},
       [] {
         return with_value("plane", "/time",
                           "{\"step_s\": 1, \"steps\": 1}, \"" + std::string(10'000'000, 'k') + "\": 1");
       }},
      {"HugeText",
       "",
       "/description",
       "got \"xxxxx",
       {},
       [] { return with_value("plane", "/description", "\"" + std::string(10'000'000, 'x') + "\""); }},
      {"HugeList",
       "",
       "/time",
       "got a list of 5000000 entries; allowed: an object",
       {},
       [] {
         std::string list = "[0";
         for (int i = 1; i < 5'000'000; ++i) list += ",0";
         return with_value("plane", "/time", list + "]");
       }},
      {"TooManyWaypoints",
       "",
       "/hand/x_N/points",
       "got a list of 1000001 entries; allowed: a list of 1 ... 1000000",
       {},
       [] {
         std::string points_text = "[[0,0]";
         for (int i = 1; i <= 1'000'000; ++i) points_text += ",[" + std::to_string(i) + ",0]";
         return with_value("plane", "/hand",
                           R"({"type": "force", "x_N": {"type": "waypoints", "points": )" + points_text + "]}}");
       }},
      {"TooManyKeys",
       "",
       "/k10000",
       "more than 10000 keys in one object",
       {},
       [] {
         std::string text = "{\"k0\": 0";
         for (int i = 1; i < 100'000; ++i) text += ",\"k" + std::to_string(i) + "\": 0";
         return text + "}";
       }},
      {"FileTooLarge", "", "", "is larger than 64 MiB", {}, [] { return std::string((64 << 20) + 1, ' '); }},
  };
}

}  // namespace hapbench::test
