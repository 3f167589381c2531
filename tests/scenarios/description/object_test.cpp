#include "scenarios/description/object.hpp"

#include <gtest/gtest.h>

#include "scenarios/description/values.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench {
namespace {

struct Inner {
  double width = 2.0;
};
struct Outer {
  double mass = 0.0;
  std::string name = "unnamed";
  Inner inner;
  std::optional<double> later;
  std::optional<std::int64_t> steps;
  std::optional<double> duration;
};

std::shared_ptr<ObjectCodec<Outer>> outer_codec() {
  auto inner = object<Inner>();
  inner->optional(
      "width_m", [](auto& i) -> double& { return i.width; }, number({0.0, 10.0, "m"}), "how wide");
  auto outer = object<Outer>();
  outer->ignored("$schema", "for editors");
  outer->required(
      "mass_kg", [](auto& o) -> double& { return o.mass; }, number({0.0, 10.0, "kg", true}), "how heavy");
  outer->optional(
      "name", [](auto& o) -> std::string& { return o.name; }, text(10), "what it is called");
  outer->optional(
      "inner", [](auto& o) -> Inner& { return o.inner; }, CodecPtr<Inner>(inner), "what is in it");
  outer->deferred(
      "later", [](auto& o) -> auto& { return o.later; }, number({0.0, 1.0}), "depends on the rest");
  outer->deferred(
      "steps", [](auto& o) -> auto& { return o.steps; }, integer(1, 9), "how many");
  outer->deferred(
      "duration_s", [](auto& o) -> auto& { return o.duration; }, number({0.0, 9.0, "s"}), "or how long");
  outer->exactly_one_of("steps", "duration_s");
  return outer;
}

Outer outer_of(const std::string& text) {
  Outer outer;
  outer_codec()->read(Json::parse(text), "/o", outer);
  return outer;
}

std::string refusal_of(const std::string& text) {
  SCOPED_TRACE(text);
  const auto error = test::input_error_of([&] { outer_of(text); });
  if (!error) return "";
  EXPECT_EQ(error->kind(), InputError::Kind::shape);
  return error->what();
}

TEST(ObjectCodec, LeavesAbsentFieldsAtTheirDefaults) {
  const Outer outer = outer_of(R"({"mass_kg": 3, "steps": 2})");
  EXPECT_EQ(outer.mass, 3.0);
  EXPECT_EQ(outer.name, "unnamed");
  EXPECT_EQ(outer.inner.width, 2.0);
  EXPECT_EQ(outer.later, std::nullopt);
}

TEST(ObjectCodec, ReadsGivenFieldsInAnyOrder) {
  const Outer outer =
      outer_of(R"({"duration_s": 1, "later": 0.5, "inner": {"width_m": 7}, "name": "x", "mass_kg": 1, "$schema": 5})");
  EXPECT_EQ(outer.name, "x");
  EXPECT_EQ(outer.inner.width, 7.0);
  EXPECT_EQ(outer.later, 0.5);
  EXPECT_EQ(outer.duration, 1.0);
  EXPECT_EQ(outer.steps, std::nullopt);
}

TEST(ObjectCodec, NamesAnUnknownFieldAndTheNearest) {
  EXPECT_EQ(
      refusal_of(R"({"mas_kg": 3, "steps": 2})"),
      "/o/mas_kg: unknown field; allowed here: \"$schema\", \"mass_kg\", \"name\", \"inner\", \"later\", \"steps\", "
      "\"duration_s\"; nearest valid name: \"mass_kg\"");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "inner": {"widht_m": 1}})"),
            "/o/inner/widht_m: unknown field; allowed here: \"width_m\"; nearest valid name: \"width_m\"");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "colour": 1})").find("nearest"), std::string::npos);
}

TEST(ObjectCodec, RefusesTheEmptyKeyAndKeysOfOtherCase) {
  EXPECT_NE(refusal_of(R"({"mass_kg": 3, "steps": 2, "": 1})"), "");
  EXPECT_NE(refusal_of(R"({"mass_kg": 3, "steps": 2, "Name": "x"})"), "");
  EXPECT_NE(refusal_of(R"({"mass_kg": 3, "steps": 2, "type": "x"})"), "");
}

TEST(ObjectCodec, EscapesAnUnknownKeyInThePointer) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "a/b~c": 1})").substr(0, 11), "/o/a~1b~0c:");
}

TEST(ObjectCodec, NamesAMissingFieldAndWhatIsAllowed) {
  EXPECT_EQ(refusal_of(R"({"steps": 2})"), "/o: missing field \"mass_kg\"; allowed: a number > 0 and <= 10 [kg]");
}

TEST(ObjectCodec, RefusesWhatIsNoObject) {
  for (const char* text : {"[]", "null", "1", "\"x\"", "true"}) {
    EXPECT_EQ(refusal_of(text),
              std::string("/o: got ") + text +
                  "; allowed: an object with the fields \"$schema\", \"mass_kg\", \"name\", \"inner\", "
                  "\"later\", \"steps\", \"duration_s\"");
  }
}

TEST(ObjectCodec, RefusesNullForADeferredField) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "later": null})"),
            "/o/later: got null; allowed: a number >= 0 and <= 1");
}

TEST(ObjectCodec, WantsExactlyOneOfTwoFields) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3})"), "/o: missing field; allowed: exactly one of \"steps\" and \"duration_s\"");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 1, "duration_s": 1})"),
            "/o: got both \"steps\" and \"duration_s\", which contradict; allowed: exactly one of them");
}

TEST(ObjectCodec, ChecksRelationsOnceAllFieldsAreRead) {
  auto codec = outer_codec();
  codec->relation([](const Outer& o, const std::string& at) {
    if (o.inner.width > o.mass) throw InputError(InputError::Kind::relation, at, "wider than heavy");
  });
  Outer outer;
  EXPECT_NO_THROW(codec->read(Json::parse(R"({"steps": 1, "inner": {"width_m": 3}, "mass_kg": 4})"), "", outer));
  const auto error = test::input_error_of(
      [&] { codec->read(Json::parse(R"({"steps": 1, "inner": {"width_m": 5}, "mass_kg": 4})"), "", outer); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind(), InputError::Kind::relation);
}

TEST(ObjectCodec, WritesEveryFieldButEmptyDeferredOnes) {
  const Outer outer = outer_of(R"({"steps": 2, "mass_kg": 3})");
  EXPECT_EQ(outer_codec()->write(outer),
            Json::parse(R"({"mass_kg": 3.0, "name": "unnamed", "inner": {"width_m": 2.0}, "steps": 2})"));
}

TEST(ObjectCodec, DescribesFieldsDefaultsAndRequirementsAsASchema) {
  const Json schema = outer_codec()->schema();
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(schema["required"], Json::array({"mass_kg"}));
  EXPECT_EQ(schema["oneOf"], Json::parse(R"([{"required": ["steps"]}, {"required": ["duration_s"]}])"));
  EXPECT_EQ(
      schema["properties"]["name"],
      Json::parse(R"({"type": "string", "maxLength": 10, "description": "what it is called", "default": "unnamed"})"));
  EXPECT_FALSE(schema["properties"]["later"].contains("default"));
  EXPECT_EQ(schema["properties"]["inner"]["default"], Json::parse(R"({"width_m": 2.0})"));
}

}  // namespace
}  // namespace hapbench
