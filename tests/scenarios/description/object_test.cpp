#include <gtest/gtest.h>

#include "tests/scenarios/support/visitors.hpp"

/// Objects with named fields.
namespace hapbench::object_test {
namespace {

struct Inner {
  double width = 2.0;
};
struct Outer {
  double mass = 0.0;
  std::string name = "unnamed";
  Inner inner;
  double scale = 0.25;
  std::optional<double> steps;
  std::optional<double> duration;
};

void describe_inner(Fields& f, Inner& inner) {
  f.number("width_m", inner.width, {0.0, 10.0, "m"}, "how wide");
}

void describe_fields(Fields& f, Outer& outer) {
  const auto number = [](Fields& n, double& value) { n.number(value, {0.0, 9.0}); };
  f.ignored("$schema", "for editors");
  f.number("mass_kg", outer.mass, {0.0, 10.0, "kg", true}, "how heavy", Presence::required);
  f.text("name", outer.name, 10, "what it is called");
  f.group("inner", "what is in it", [&outer](Fields& g) { describe_inner(g, outer.inner); });
  f.number("scale", outer.scale, {0.0, 1.0}, "depends on the rest", Presence::no_default);
  f.if_any("steps", outer.steps, "how many", number);
  f.if_any("duration_s", outer.duration, "or how long", number);
  f.exactly_one_of("steps", "duration_s");
}

void describe_outer(Fields& f, Outer& outer) {
  f.fields([&outer](Fields& fields) { describe_fields(fields, outer); });
}

Outer outer_of(const std::string& text) {
  Outer outer;
  test::read_json(Json::parse(text), "/v", outer, describe_outer);
  return outer;
}

std::string refusal_of(const std::string& text) {
  return test::refusal_of(text, Outer{}, describe_outer);
}

TEST(Object, LeavesAbsentFieldsAtTheirDefaults) {
  const Outer outer = outer_of(R"({"mass_kg": 3, "steps": 2})");
  EXPECT_EQ(outer.mass, 3.0);
  EXPECT_EQ(outer.name, "unnamed");
  EXPECT_EQ(outer.inner.width, 2.0);
  EXPECT_EQ(outer.scale, 0.25);
  EXPECT_EQ(outer.duration, std::nullopt);
}

TEST(Object, HasItsFieldsInAnyOrder) {
  const Outer outer =
      outer_of(R"({"duration_s": 1, "scale": 0.5, "inner": {"width_m": 7}, "name": "x", "mass_kg": 1, "$schema": 5})");
  EXPECT_EQ(outer.name, "x");
  EXPECT_EQ(outer.inner.width, 7.0);
  EXPECT_EQ(outer.scale, 0.5);
  EXPECT_EQ(outer.duration, 1.0);
  EXPECT_EQ(outer.steps, std::nullopt);
}

TEST(Object, NamesAnUnknownFieldAndTheNearest) {
  EXPECT_EQ(
      refusal_of(R"({"mas_kg": 3, "steps": 2})"),
      "/v/mas_kg: unknown field; allowed here: \"$schema\", \"mass_kg\", \"name\", \"inner\", \"scale\", \"steps\", "
      "\"duration_s\"; nearest valid name: \"mass_kg\"");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "inner": {"widht_m": 1}})"),
            "/v/inner/widht_m: unknown field; allowed here: \"width_m\"; nearest valid name: \"width_m\"");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "colour": 1})").find("nearest"), std::string::npos);
}

TEST(Object, NamesAnUnknownFieldBeforeAnyOtherFault) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": -3, "steps": 2, "nme": 1})").find("/v/nme: unknown field"), 0u);
}

TEST(Object, HasAllItsFaultsReportedAtOnce) {
  Outer outer;
  const auto error = test::input_error_of([&] {
    test::read_json(Json::parse(R"({"mas_kg": 3, "scale": 2, "inner": {"width_m": "x", "depth_m": 1}})"), "/v", outer,
                    describe_outer);
  });
  ASSERT_TRUE(error);
  std::vector<std::string> places;
  for (const InputError& fault : error->faults()) places.push_back(fault.place());
  EXPECT_EQ(places, (std::vector<std::string>{"/v/mas_kg", "/v/inner/depth_m", "/v/inner/width_m", "/v/scale", "/v"}))
      << "mass_kg is misspelt rather than missing; the last is that of steps and duration_s";
}

TEST(Object, HasNoMoreFaultsReportedThanAnybodyReads) {
  Json json = Json::object();
  for (std::size_t i = 0; i < 10 * kMostFaults; ++i) json["key" + std::to_string(i)] = 0;
  Outer outer;
  const auto error = test::input_error_of([&] { test::read_json(json, "/v", outer, describe_outer); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->faults().size(), kMostFaults);
}

TEST(Object, RefusesTheEmptyKeyAndKeysOfOtherCase) {
  EXPECT_NE(refusal_of(R"({"mass_kg": 3, "steps": 2, "": 1})"), "");
  EXPECT_NE(refusal_of(R"({"mass_kg": 3, "steps": 2, "Name": "x"})"), "");
  EXPECT_NE(refusal_of(R"({"mass_kg": 3, "steps": 2, "type": "x"})"), "");
}

TEST(Object, EscapesAnUnknownKeyInThePointer) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "a/b~c": 1})").substr(0, 11), "/v/a~1b~0c:");
}

TEST(Object, NamesAMissingFieldAndWhatIsAllowed) {
  EXPECT_EQ(refusal_of(R"({"steps": 2})"), "/v: missing field \"mass_kg\"; allowed: a number > 0 and <= 10 [kg]");
}

TEST(Object, IsNoOtherType) {
  for (const char* text : {"[]", "null", "1", "\"x\"", "true"}) {
    EXPECT_EQ(refusal_of(text),
              std::string("/v: got ") + text +
                  "; allowed: an object with the fields \"$schema\", \"mass_kg\", \"name\", \"inner\", "
                  "\"scale\", \"steps\", \"duration_s\"");
  }
}

TEST(Object, RefusesNullForFieldsWithoutADefault) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "scale": null})"),
            "/v/scale: got null; allowed: a number >= 0 and <= 1");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": null})"), "/v/steps: got null; allowed: a number >= 0 and <= 9");
}

TEST(Object, WantsExactlyOneOfTwoFields) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3})"), "/v: missing field; allowed: exactly one of \"steps\" and \"duration_s\"");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 1, "duration_s": 1})"),
            "/v: got both \"steps\" and \"duration_s\", which contradict; allowed: exactly one of them");
}

TEST(Object, HasOnePairOfExclusiveFieldsAtMost) {
  const auto twice = [](Fields& f, Outer& outer) {
    f.fields([&outer](Fields& fields) {
      describe_fields(fields, outer);
      fields.exactly_one_of("name", "scale");
    });
  };
  EXPECT_THROW(test::schema_of(twice, Outer{}), std::logic_error);
}

/// What a visitor says of itself inside the fields of an object.
struct Seen {
  bool reads = false, gives_name = false, gives_scale = false;
  double mass = -1.0;
  std::string at;
};

TEST(Object, IsReadWhenItsDescriptionIsToldSo) {
  Seen seen;
  const auto describe = [&seen](Fields& f, Outer& outer) {
    f.fields([&](Fields& fields) {
      describe_fields(fields, outer);
      if (fields.reads()) seen = {true, fields.given("name"), fields.given("scale"), outer.mass, fields.at()};
    });
  };
  test::schema_of(describe, Outer{});
  test::written_by(describe, Outer{});
  EXPECT_FALSE(seen.reads);
  Outer outer;
  test::read_json(Json::parse(R"({"steps": 1, "name": "x", "mass_kg": 4})"), "/a/0", outer, describe);
  EXPECT_TRUE(seen.reads);
  EXPECT_TRUE(seen.gives_name);
  EXPECT_FALSE(seen.gives_scale);
  EXPECT_EQ(seen.mass, 4.0);
  EXPECT_EQ(seen.at, "/a/0");
}

TEST(Object, KeepsWarningsForWhoeverAsks) {
  const Json json = Json::object();
  std::vector<std::string> warnings;
  Reader listening(json, "", &warnings), deaf(json, "");
  for (Reader* reader : {&listening, &deaf}) reader->warn("odd");
  EXPECT_EQ(warnings, std::vector<std::string>{"odd"});
}

TEST(Object, IsWrittenWithAllFieldsThatHaveAValue) {
  const Outer outer = outer_of(R"({"steps": 2, "mass_kg": 3})");
  EXPECT_EQ(
      test::written_by(describe_outer, outer),
      Json::parse(R"({"mass_kg": 3.0, "name": "unnamed", "inner": {"width_m": 2.0}, "scale": 0.25, "steps": 2.0})"));
}

TEST(Object, HasDefaultsAndRequirementsInItsSchema) {
  const Json schema = test::schema_of(describe_outer, Outer{});
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(schema["required"], Json::array({"mass_kg"}));
  EXPECT_EQ(schema["oneOf"], Json::parse(R"([{"required": ["steps"]}, {"required": ["duration_s"]}])"));
  EXPECT_EQ(
      schema["properties"]["name"],
      Json::parse(R"({"type": "string", "maxLength": 10, "description": "what it is called", "default": "unnamed"})"));
  for (const char* field : {"mass_kg", "scale", "steps", "duration_s"}) {
    EXPECT_FALSE(schema["properties"][field].contains("default")) << field;
  }
  EXPECT_EQ(schema["properties"]["inner"]["default"], Json::parse(R"({"width_m": 2.0})"));
}

TEST(Object, LeavesFieldsWithoutADefaultOutOfTheDefaultsOfOthers) {
  const auto describe = [](Fields& f, Outer& outer) {
    f.fields([&outer](Fields& fields) {
      fields.group("part", "", [&outer](Fields& g) {
        g.number("scale", outer.scale, {0.0, 1.0}, "", Presence::no_default);
        g.number("mass_kg", outer.mass, {0.0, 1.0}, "");
      });
    });
  };
  EXPECT_EQ(test::schema_of(describe, Outer{})["properties"]["part"]["default"], Json::parse(R"({"mass_kg": 0.0})"));
  EXPECT_EQ(test::written_by(describe, Outer{}), Json::parse(R"({"part": {"scale": 0.25, "mass_kg": 0.0}})"));
}

}  // namespace
}  // namespace hapbench::object_test
