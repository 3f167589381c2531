#include <gtest/gtest.h>

#include <variant>

#include "scenarios/description/object.hpp"
#include "scenarios/description/values.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench {
namespace {

struct Ball {
  double radius = 1.0;
};
struct Box {
  double edge = 2.0;
};
using Solid = std::variant<Ball, Box>;

CodecPtr<Solid> solid_codec() {
  auto ball = object<Ball>();
  ball->required(
      "radius_m", [](auto& b) -> double& { return b.radius; }, number({0.0, 9.0, "m"}), "of the ball");
  auto box = object<Box>();
  box->optional(
      "edge_m", [](auto& b) -> double& { return b.edge; }, number({0.0, 9.0, "m"}), "of the box");
  auto solid = tagged<Solid>("solid");
  solid->alternative("ball", ball).alternative("box", box, Box{5.0});
  return solid;
}

Solid solid_of(const std::string& text) {
  Solid solid;
  solid_codec()->read(Json::parse(text), "/s", solid);
  return solid;
}

std::string refusal_of(const std::string& text) {
  SCOPED_TRACE(text);
  const auto error = test::input_error_of([&] { solid_of(text); });
  if (!error) return "";
  EXPECT_EQ(error->kind(), InputError::Kind::shape);
  return error->what();
}

TEST(TaggedCodec, ChoosesByType) {
  EXPECT_EQ(std::get<Ball>(solid_of(R"({"type": "ball", "radius_m": 3})")).radius, 3.0);
  EXPECT_EQ(std::get<Box>(solid_of(R"({"edge_m": 4, "type": "box"})")).edge, 4.0);
}

TEST(TaggedCodec, StartsFromTheInitialValueOfTheAlternative) {
  EXPECT_EQ(std::get<Box>(solid_of(R"({"type": "box"})")).edge, 5.0);
}

TEST(TaggedCodec, NamesAnUnknownTypeAndTheNearest) {
  EXPECT_EQ(refusal_of(R"({"type": "bal", "radius_m": 3})"),
            R"(/s/type: got "bal"; allowed: solid: one of "ball", "box"; nearest valid name: "ball")");
  EXPECT_EQ(refusal_of(R"({"type": "cone"})"), R"(/s/type: got "cone"; allowed: solid: one of "ball", "box")");
  EXPECT_EQ(refusal_of(R"({"type": 1})"), R"(/s/type: got 1; allowed: solid: one of "ball", "box")");
  EXPECT_EQ(refusal_of(R"({"type": null})"), R"(/s/type: got null; allowed: solid: one of "ball", "box")");
}

TEST(TaggedCodec, WantsAType) {
  EXPECT_EQ(refusal_of(R"({"radius_m": 3})"), R"(/s: missing field "type"; allowed: solid: one of "ball", "box")");
  EXPECT_EQ(refusal_of("[]"), R"(/s: got []; allowed: an object whose "type" is solid: one of "ball", "box")");
}

TEST(TaggedCodec, RefusesFieldsOfTheOtherAlternative) {
  EXPECT_EQ(refusal_of(R"({"type": "ball", "radius_m": 3, "edge_m": 1})"),
            R"(/s/edge_m: unknown field; allowed here: "type", "radius_m")");
  EXPECT_EQ(refusal_of(R"({"type": "ball"})"), R"(/s: missing field "radius_m"; allowed: a number >= 0 and <= 9 [m])");
}

TEST(TaggedCodec, SuggestsTypeForAMisspeltTag) {
  EXPECT_NE(refusal_of(R"({"type": "box", "typ": "ball"})").find(R"(nearest valid name: "type")"), std::string::npos);
}

TEST(TaggedCodec, WritesTypeAndFields) {
  EXPECT_EQ(solid_codec()->write(Ball{3.0}).dump(), R"({"type":"ball","radius_m":3.0})");
  EXPECT_EQ(solid_codec()->write(Box{4.0}).dump(), R"({"type":"box","edge_m":4.0})");
}

TEST(TaggedCodec, DescribesEachAlternativeWithItsTag) {
  const Json choices = solid_codec()->schema()["oneOf"];
  ASSERT_EQ(choices.size(), 2u);
  EXPECT_EQ(choices[0]["properties"]["type"]["const"], "ball");
  EXPECT_EQ(choices[0]["required"], Json::array({"type", "radius_m"}));
  EXPECT_EQ(choices[1]["required"], Json::array({"type"}));
}

}  // namespace
}  // namespace hapbench
