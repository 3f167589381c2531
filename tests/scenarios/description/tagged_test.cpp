#include <gtest/gtest.h>

#include <variant>

#include "tests/scenarios/support/visitors.hpp"

/// Objects whose field "type" chooses the other fields.
namespace hapbench::tagged_test {
namespace {

struct Ball {
  double radius = 1.0;
};
struct Box {
  double edge = 5.0;
};
using Solid = std::variant<Ball, Box>;

void describe_solid(Fields& f, Ball& ball) {
  f.number("radius_m", ball.radius, {0.0, 9.0, "m"}, "of the ball", Presence::required);
}
void describe_solid(Fields& f, Box& box) {
  f.number("edge_m", box.edge, {0.0, 9.0, "m"}, "of the box");
}

void describe_any(Fields& f, Solid& solid) {
  f.variant(solid, "solid", {"ball", "box"}, [](Fields& fields, auto& held) { describe_solid(fields, held); });
}

Solid solid_of(const std::string& text, Solid solid = {}) {
  test::read_json(Json::parse(text), "/v", solid, describe_any);
  return solid;
}

std::string refusal_of(const std::string& text) {
  return test::refusal_of(text, Solid{}, describe_any);
}

TEST(TaggedObject, IsChosenByType) {
  EXPECT_EQ(std::get<Ball>(solid_of(R"({"type": "ball", "radius_m": 3})")).radius, 3.0);
  EXPECT_EQ(std::get<Box>(solid_of(R"({"edge_m": 4, "type": "box"})")).edge, 4.0);
}

TEST(TaggedObject, StartsFromTheDefaultsOfTheAlternative) {
  EXPECT_EQ(std::get<Box>(solid_of(R"({"type": "box"})")).edge, 5.0);
  EXPECT_EQ(std::get<Box>(solid_of(R"({"type": "box"})", Box{7.0})).edge, 5.0);
}

TEST(TaggedObject, NamesAnUnknownTypeAndTheNearest) {
  EXPECT_EQ(refusal_of(R"({"type": "bal", "radius_m": 3})"),
            R"(/v/type: got "bal"; allowed: solid: one of "ball", "box"; nearest valid name: "ball")");
  EXPECT_EQ(refusal_of(R"({"type": "cone"})"), R"(/v/type: got "cone"; allowed: solid: one of "ball", "box")");
  EXPECT_EQ(refusal_of(R"({"type": 1})"), R"(/v/type: got 1; allowed: solid: one of "ball", "box")");
  EXPECT_EQ(refusal_of(R"({"type": null})"), R"(/v/type: got null; allowed: solid: one of "ball", "box")");
}

TEST(TaggedObject, WantsAType) {
  EXPECT_EQ(refusal_of(R"({"radius_m": 3})"), R"(/v: missing field "type"; allowed: solid: one of "ball", "box")");
  EXPECT_EQ(refusal_of("[]"), R"(/v: got []; allowed: an object whose "type" is one of "ball", "box")");
}

TEST(TaggedObject, RefusesFieldsOfTheOtherAlternative) {
  EXPECT_EQ(refusal_of(R"({"type": "ball", "radius_m": 3, "edge_m": 1})"),
            R"(/v/edge_m: unknown field; allowed here: "type", "radius_m")");
  EXPECT_EQ(refusal_of(R"({"type": "ball"})"), R"(/v: missing field "radius_m"; allowed: a number >= 0 and <= 9 [m])");
}

TEST(TaggedObject, SuggestsTypeForAMisspeltTag) {
  EXPECT_NE(refusal_of(R"({"type": "box", "typ": "ball"})").find(R"(nearest valid name: "type")"), std::string::npos);
}

TEST(TaggedObject, IsWrittenAsTypeAndFields) {
  EXPECT_EQ(test::written_by(describe_any, Solid(Ball{3.0})).dump(), R"({"type":"ball","radius_m":3.0})");
  EXPECT_EQ(test::written_by(describe_any, Solid(Box{4.0})).dump(), R"({"type":"box","edge_m":4.0})");
}

TEST(TaggedObject, IsNotWrittenWithoutAnAlternative) {
  Writer writer;
  const char* const names[] = {"ball"};
  EXPECT_THROW(writer.alternatives("solid", names, Untyped::refused, 1, [](Fields&, std::size_t) {}), std::logic_error);
}

TEST(TaggedObject, HasAnAlternativeForEachTagInItsSchema) {
  const Json choices = test::schema_of(describe_any, Solid{})["oneOf"];
  ASSERT_EQ(choices.size(), 2u);
  EXPECT_EQ(choices[0]["properties"]["type"]["const"], "ball");
  EXPECT_EQ(choices[0]["required"], Json::array({"type", "radius_m"}));
  EXPECT_EQ(choices[1]["required"], Json::array({"type"}));
}

/// A number or an object, one value or a list of them.
TEST(TwoForms, AreToldApartByTheirJson) {
  struct Parts {
    double number = 0.0;
    std::vector<double> list;
    Solid solid;
  };
  const auto describe = [](Fields& f, Parts& parts) {
    const auto number = [](Fields& n, double& value) { n.number(value, {0.0, 9.0}); };
    f.fields([&](Fields& fields) {
      fields.field("solid", "", Presence::required, [&](Fields& v) {
        v.number_or_object(
            true, [&](Fields& n) { number(n, parts.number); }, [&](Fields& o) { describe_any(o, parts.solid); });
      });
      fields.field("list", "", Presence::has_default, [&](Fields& v) {
        v.one_or_list(
            true, [&](Fields& n) { number(n, parts.number); },
            [&](Fields& l) {
              l.list(parts.list, {0, 2}, number);
            });
      });
    });
  };
  Parts parts;
  test::read_json(Json::parse(R"({"solid": {"type": "box", "edge_m": 2}, "list": [1]})"), "", parts, describe);
  EXPECT_EQ(std::get<Box>(parts.solid).edge, 2.0);
  EXPECT_EQ(parts.list, std::vector<double>{1.0});
  test::read_json(Json::parse(R"({"solid": 3})"), "", parts, describe);
  EXPECT_EQ(parts.number, 3.0);
  test::read_json(Json::parse(R"({"solid": 3, "list": 4})"), "", parts, describe);
  EXPECT_EQ(parts.number, 4.0);
  const std::string number = "a number >= 0 and <= 9";
  const std::string both = number + ", or an object whose \"type\" is one of \"ball\", \"box\"";
  EXPECT_EQ(test::refusal_of(R"({"solid": true})", Parts{}, describe), "/v/solid: got true; allowed: " + both);
  EXPECT_EQ(test::refusal_of("{}", Parts{}, describe), "/v: missing field \"solid\"; allowed: " + both);
  EXPECT_EQ(test::refusal_of(R"({"solid": 10})", Parts{}, describe), "/v/solid: got 10; allowed: " + number);
  EXPECT_EQ(test::refusal_of(R"({"solid": 1, "list": true})", Parts{}, describe),
            "/v/list: got true; allowed: " + number);
}

}  // namespace
}  // namespace hapbench::tagged_test
