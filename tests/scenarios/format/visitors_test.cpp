#include <gtest/gtest.h>

#include <variant>

#include "results/summary/summary.hpp"
#include "tests/scenarios/support/visitors.hpp"

/// Objects with named fields, and objects whose field "type" chooses the other fields, through all visitors. What
/// refusals say of a scenario is in tests/data/golden/refused_scenarios.txt; reader and schema agree in
/// schema_agreement_test.cpp.
namespace hapbench::visitors_test {
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

std::string refusal_of(const std::string& text) {
  return test::refusal_of(text, Outer{}, describe_outer);
}

TEST(Object, NamesAnUnknownFieldAndTheNearest) {
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "inner": {"widht_m": 1}})"),
            "/v/inner/widht_m: unknown field; nearest valid name: \"width_m\"; allowed here: \"width_m\"");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "a/b~c": 1})").substr(0, 11), "/v/a~1b~0c:");
  EXPECT_EQ(refusal_of(R"({"mass_kg": 3, "steps": 2, "colour": 1})").find("nearest"), std::string::npos);
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

TEST(Object, HasOnePairOfExclusiveFieldsAtMost) {
  const auto twice = [](Fields& f, Outer& outer) {
    f.fields([&outer](Fields& fields) {
      describe_fields(fields, outer);
      fields.exactly_one_of("name", "scale");
    });
  };
  EXPECT_THROW(test::schema_of(twice, Outer{}), std::logic_error);
}

/// The state of a visitor inside the fields of an object.
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

TEST(TaggedObject, IsChosenByType) {
  EXPECT_EQ(std::get<Box>(solid_of(R"({"type": "box"})", Box{7.0})).edge, 5.0) << "the default of the alternative";
  EXPECT_EQ(std::get<Ball>(solid_of(R"({"type": "ball", "radius_m": 3})")).radius, 3.0);
  EXPECT_EQ(std::get<Box>(solid_of(R"({"edge_m": 4, "type": "box"})")).edge, 4.0);
}

TEST(TaggedObject, IsNotWrittenWithoutAnAlternative) {
  const TypeName names[] = {"ball"};
  const auto describe = [&](Fields& f) {
    f.alternatives("solid", names, Untyped::refused, 1, [](Fields&, std::size_t) {});
  };
  EXPECT_THROW(json_of(describe), std::logic_error);
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
        v.plain_or_object(
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
}  // namespace hapbench::visitors_test
